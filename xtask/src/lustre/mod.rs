//! `cargo xtask lustre-corpus`: Lustre programs written elsewhere, run by our tools.
//!
//! The programs stay outside of the repository. With traces each program must give what the trace says; with `--reject`
//! each must be refused, with a table after `--kinds` for the reason that it gives; with a list after `--excluded` each
//! must be accepted and keep its claims, or stand in the list with the reason why it does not; with none of them each must run. The tools are run as their users run them, one process per program.
//!
//! | file | idea |
//! |---|---|
//! | `options.rs` | what is asked for |
//! | `trace.rs` | recorded inputs and outputs, in the two forms in which they come |
//! | `tool.rs` | our tools as processes |
//! | `judge.rs` | what became of one program |
//! | `report.rs` | what became of all |

mod judge;
mod options;
mod report;
mod tool;
mod trace;

use std::collections::VecDeque;
use std::sync::Mutex;

use judge::{Case, Fate};
use options::Options;
use report::Report;
use tool::Tools;

/// Runs a corpus and prints what became of it.
pub(crate) fn corpus(args: &[String]) -> Result<(), String> {
    let options = Options::parse(args)?;
    let cases = judge::cases(&options)?;
    let tools = Tools::build()?;
    let report = Report::new(judge_all(cases, &tools), &options)?;
    print!("{}", report.print(options.list));
    match report.is_good() {
        true => Ok(()),
        false => Err(String::new()),
    }
}

/// In the order of the cases, whatever thread was first.
fn judge_all(cases: Vec<Case>, tools: &Tools) -> Vec<(String, Fate)> {
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
