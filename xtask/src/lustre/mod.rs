//! `cargo xtask lustre-corpus`: runs Lustre programs of other projects with our tools.
//!
//! The programs are not part of the repository. With traces, each program must give the traced outputs. With
//! `--reject`, each must be rejected; with a table after `--kinds`, each with the listed error codes. With a list after
//! `--excluded`, each must be accepted and satisfy its contracts, or be in the list with the reason why it does not.
//! Without any of these options, each must run. The tools run as users run them, one process per program. With `--cc`, each
//! program that runs also runs in C, and every value must have the same bits.
//!
//! | file | content |
//! |---|---|
//! | `options.rs` | command line |
//! | `trace.rs` | recorded inputs and outputs, in two formats |
//! | `tool.rs` | our tools as processes |
//! | `cases.rs` | verdict on one program |
//! | `report.rs` | summary of all programs |

mod cases;
mod options;
mod report;
mod tool;
mod trace;

use crate::task_error::TaskError;
use std::collections::VecDeque;
use std::sync::Mutex;

use cases::{Case, Verdict};
use options::Options;
use report::Report;
use tool::Tools;

/// Carries out `cargo xtask lustre-corpus`: runs the Lustre programs of a corpus with the tools and prints the report.
pub(crate) fn corpus(args: &[String]) -> Result<(), TaskError> {
    let options = Options::parse(args)?;
    let cases = cases::cases(&options)?;
    let tools = Tools::build(options.compiler.as_deref())?;
    let report = Report::new(judge_all(cases, &tools), &options)?;
    print!("{}", report.print(options.list));
    match report.is_good() {
        true => Ok(()),
        false => Err(TaskError::default()),
    }
}

/// Tests all programs on several threads. Returns name and verdict of each, in the order of `cases`.
fn judge_all(cases: Vec<Case>, tools: &Tools) -> Vec<(String, Verdict)> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let open: Mutex<VecDeque<(usize, Case)>> = Mutex::new(cases.into_iter().enumerate().collect());
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((place, case)) = open.lock().ok().and_then(|mut q| q.pop_front()) {
                    let fate = case.judge(tools);
                    if let Ok(mut done) = done.lock() {
                        done.push((place, (case.name, fate)));
                    }
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_default();
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, judged)| judged).collect()
}
