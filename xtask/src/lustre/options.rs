//! Command line of `lustre-corpus`.

use crate::task_error::TaskError;
use std::path::PathBuf;

/// Expected result of the Lustre programs of a corpus.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Expectation {
    /// The outputs of the programs must be those in this file of traces (JSON).
    Match(PathBuf),
    /// The compiler must reject all programs.
    Reject,
    /// The compiler must reject the programs with the codes that this table (JSON) lists for each; it must accept a
    /// program with an empty list.
    Codes(PathBuf),
    /// All programs must run without an error.
    Run,
    /// The compiler must accept the programs, and they must satisfy their contracts. The programs in this file (JSON)
    /// are excluded, each with a reason.
    Contracts(PathBuf),
}

/// Options of `cargo xtask lustre-corpus`.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// Directory that contains the programs (`.lus`).
    pub(crate) programs: PathBuf,
    /// Expected result of the programs.
    pub(crate) expectation: Expectation,
    /// File with groups of programs that the report counts separately: a JSON object that maps the name of a group to a
    /// list of program names. `None` for no groups.
    pub(crate) groups: Option<PathBuf>,
    /// True if the report lists all programs, not only those that fail.
    pub(crate) list: bool,
    /// Text that the names of the selected programs must contain; `None` for all programs.
    pub(crate) filter: Option<String>,
    /// C compiler with its options, if the programs also run in C; every value must have the same bits.
    pub(crate) compiler: Option<String>,
}

const USAGE: &str =
    "usage: cargo xtask lustre-corpus --programs DIR [--traces FILE.json | --reject | --kinds FILE.json | --excluded FILE.json]
    [--groups FILE.json] [--only TEXT] [--list] [--cc COMMAND]";

impl Options {
    pub(crate) fn parse(args: &[String]) -> Result<Options, TaskError> {
        let mut programs = None;
        let mut options = Options {
            programs: PathBuf::new(),
            expectation: Expectation::Run,
            groups: None,
            list: false,
            filter: None,
            compiler: None,
        };
        let mut args = args.iter();
        while let Some(arg) = args.next() {
            let mut value = || args.next().ok_or(USAGE);
            match arg.as_str() {
                "--programs" => programs = Some(value()?),
                "--traces" => options.expectation = Expectation::Match(value()?.into()),
                "--reject" => options.expectation = Expectation::Reject,
                "--kinds" => options.expectation = Expectation::Codes(value()?.into()),
                "--excluded" => options.expectation = Expectation::Contracts(value()?.into()),
                "--groups" => options.groups = Some(value()?.into()),
                "--only" => options.filter = Some(value()?.clone()),
                "--cc" => options.compiler = Some(value()?.clone()),
                "--list" => options.list = true,
                _ => return Err(USAGE.into()),
            }
        }
        options.programs = programs.ok_or(USAGE)?.into();
        Ok(options)
    }
}
