//! Made-up inputs that keep what a node assumes of them: `assume` of its contract, and assertions.
//!
//! An assumption may be about earlier outputs, so inputs can only be tried: where a row breaks an assumption the run begins
//! anew, goes on to this cycle with the rows before, and tries another one.

use rpi_host::node::{NodeRun, Row};
use rpi_image::Image;
use rpi_net::{Claim, ClaimKind, Column};

use crate::random::Random;

/// The most rows that are tried for one cycle.
const MOST_TRIES: u32 = 200;

/// What is needed to try inputs.
pub(crate) struct Trial {
    image: Image,
    inputs: Vec<Column>,
    assumed: Vec<Claim>,
}

impl Trial {
    /// Claims that are watched and do not end the run; those that inputs must keep are picked out.
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

    /// Rows for so many cycles; fewer if the node has a fault before.
    ///
    /// # Errors
    /// If no row that was tried keeps the assumptions in some cycle.
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
                    "no inputs that were made up keep what the node assumes in cycle {cycle}; give them by --inputs FILE"
                ));
            }
            run = self.run_after(&rows)?;
        }
        Ok(rows)
    }

    /// A row; of a second try many values are those of the cycle before.
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

/// Whether a claim is one of the node that runs: of its contract, or of one that this imports.
fn is_own(path: &str) -> bool {
    path.split('.').all(|part| matches!(part, "" | "_"))
}
