//! Random inputs of a node that satisfy its assumptions: `assume` of its contract, and assertions.
//!
//! An assumption may depend on earlier outputs, so rows are found by trial: if a row violates an assumption, the run is
//! restarted, repeated up to this cycle with the rows found so far, and continued with another row.

use std::fmt;

use rpi_image::Image;
use rpi_net::{Claim, ClaimKind, Column};
use rpi_replay::node_runner::{ColumnValues, NodeLoadError, NodeRun};

use crate::random::InputGenerator;

/// Maximum number of random rows of inputs that are tried for one cycle.
const MAX_TRIES: u32 = 200;

/// Reason why no random inputs can be found.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum InputSearchError {
    /// The node cannot be loaded for the trial runs.
    Load(NodeLoadError),
    /// None of the inputs tried for a cycle satisfies the assumptions of the node.
    Exhausted {
        /// Number of the cycle for which no inputs were found, from 0.
        cycle: usize,
    },
}

impl fmt::Display for InputSearchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InputSearchError::Load(error) => write!(f, "{error}"),
            InputSearchError::Exhausted { cycle } => write!(
                f,
                "no random inputs satisfy the assumptions of the node in cycle {cycle}; use --inputs FILE"
            ),
        }
    }
}

impl std::error::Error for InputSearchError {}

/// Search for random inputs that satisfy the assumptions of a node.
pub(crate) struct InputSearch {
    image: Image,
    inputs: Vec<Column>,
    assumptions: Vec<Claim>,
}

impl InputSearch {
    /// Creates the search. Only the assertions and assumptions in `claims` constrain the inputs. A violated one does
    /// not end the trial run, so that other inputs can be tried.
    pub(crate) fn new(image: Image, inputs: &[Column], claims: &[Claim]) -> InputSearch {
        let is_assumed = |claim: &&Claim| match claim.kind {
            ClaimKind::Assert => true,
            ClaimKind::Assume | ClaimKind::ModeCompleteness => is_own_claim(&claim.path),
            ClaimKind::Check | ClaimKind::Guarantee => false,
        };
        InputSearch {
            image,
            inputs: inputs.to_vec(),
            assumptions: claims.iter().filter(is_assumed).cloned().collect(),
        }
    }

    /// Returns the inputs for each of `cycles` cycles, or for fewer cycles if the node has a fault earlier.
    ///
    /// # Errors
    /// Returns an error if none of the tried inputs satisfies the assumptions in some cycle.
    pub(crate) fn rows(
        &self,
        random: &mut InputGenerator,
        cycles: u64,
    ) -> Result<Vec<ColumnValues>, InputSearchError> {
        let mut rows: Vec<ColumnValues> = Vec::new();
        let (mut run, mut tries) = (self.run_after(&rows).map_err(InputSearchError::Load)?, 0);
        while (rows.len() as u64) < cycles {
            let row = self.draw_row(random, rows.last().filter(|_| tries % 2 == 1));
            let cycle = run.cycle(&row);
            if cycle.row.is_none() || cycle.diagnostics.is_empty() || self.assumptions.is_empty() {
                rows.push(row);
                tries = 0;
                if cycle.row.is_none() {
                    break;
                }
                continue;
            }
            tries += 1;
            if tries > MAX_TRIES {
                return Err(InputSearchError::Exhausted { cycle: rows.len() });
            }
            run = self.run_after(&rows).map_err(InputSearchError::Load)?;
        }
        Ok(rows)
    }

    /// Returns random inputs for one cycle. If `last` (the inputs of the previous cycle) is given, most values are
    /// taken from it; the search does so in every second try.
    fn draw_row(&self, random: &mut InputGenerator, last: Option<&ColumnValues>) -> ColumnValues {
        let mut row = ColumnValues::with_capacity(self.inputs.len());
        for (k, column) in self.inputs.iter().enumerate() {
            row.push(match last {
                Some(last) if random.keeps_previous() => last[k].clone(),
                _ => random.value(column),
            });
        }
        row
    }

    fn run_after(&self, rows: &[ColumnValues]) -> Result<NodeRun, NodeLoadError> {
        let mut run = NodeRun::load(self.image.clone(), &self.inputs, &[], &self.assumptions)?;
        for row in rows {
            run.cycle(row);
        }
        Ok(run)
    }
}

/// Returns whether a claim belongs to the node itself: to its contract, or to a contract that it imports. `path` is the
/// path of the calls that lead to the claim.
fn is_own_claim(path: &str) -> bool {
    path.split('.').all(|part| matches!(part, "" | "_"))
}
