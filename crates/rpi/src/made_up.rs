//! Random inputs of a node that satisfy its assumptions: `assume` of its contract, and assertions.
//!
//! An assumption may depend on earlier outputs, so rows are found by trial: if a row violates an assumption, the run is
//! restarted, repeated up to this cycle with the rows found so far, and continued with another row.

use rpi_image::Image;
use rpi_net::{Claim, ClaimKind, Column};
use rpi_replay::node::{NodeRun, Row};

use crate::random::Random;

/// Maximum number of rows tried for one cycle.
const MOST_TRIES: u32 = 200;

/// Search for rows of inputs that satisfy the assumptions.
pub(crate) struct Trial {
    image: Image,
    inputs: Vec<Column>,
    assumed: Vec<Claim>,
}

impl Trial {
    /// Creates the search. Of `claims`, it keeps those that constrain the inputs; they are only observed and do not end
    /// the run.
    pub(crate) fn new(image: Image, inputs: &[Column], claims: &[Claim]) -> Trial {
        let is_assumed = |claim: &&Claim| match claim.kind {
            ClaimKind::Assert => true,
            ClaimKind::Assume | ClaimKind::Modes => is_own(&claim.path),
            ClaimKind::Check | ClaimKind::Guarantee => false,
        };
        Trial {
            image,
            inputs: inputs.to_vec(),
            assumed: claims.iter().filter(is_assumed).cloned().collect(),
        }
    }

    /// Returns rows for `cycles` cycles; fewer if the node has a fault earlier.
    ///
    /// # Errors
    /// If no tried row satisfies the assumptions in some cycle.
    pub(crate) fn rows(&self, random: &mut Random, cycles: u64) -> Result<Vec<Row>, String> {
        let mut rows: Vec<Row> = Vec::new();
        let (mut run, mut tries) = (self.run_after(&rows)?, 0);
        while (rows.len() as u64) < cycles {
            let row = self.drawn(random, rows.last().filter(|_| tries % 2 == 1));
            let cycle = run.cycle(&row);
            if cycle.row.is_none() || cycle.findings.is_empty() || self.assumed.is_empty() {
                rows.push(row);
                tries = 0;
                if cycle.row.is_none() {
                    break;
                }
                continue;
            }
            tries += 1;
            if tries > MOST_TRIES {
                let cycle = rows.len();
                return Err(format!(
                    "no random inputs satisfy the assumptions of the node in cycle {cycle}; use --inputs FILE"
                ));
            }
            run = self.run_after(&rows)?;
        }
        Ok(rows)
    }

    /// Draws a row. With `last`, used for every second try, most values are those of the previous cycle.
    fn drawn(&self, random: &mut Random, last: Option<&Row>) -> Row {
        let mut row = Row::with_capacity(self.inputs.len());
        for (k, column) in self.inputs.iter().enumerate() {
            row.push(match last {
                Some(last) if random.keeps() => last[k].clone(),
                _ => random.given(column),
            });
        }
        row
    }

    fn run_after(&self, rows: &[Row]) -> Result<NodeRun, String> {
        let mut run = NodeRun::load(self.image.clone(), &self.inputs, &[], &self.assumed)?;
        for row in rows {
            run.cycle(row);
        }
        Ok(run)
    }
}

/// Returns whether a claim belongs to the node itself: to its contract or to one that this imports.
fn is_own(path: &str) -> bool {
    path.split('.').all(|part| matches!(part, "" | "_"))
}
