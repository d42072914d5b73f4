//! Command line of `lustre-corpus`.

use std::path::PathBuf;

/// Expected result of the programs of a corpus.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Expectation {
    /// The outputs must be those in this file of traces.
    Match(PathBuf),
    /// The programs must be rejected.
    Reject,
    /// The programs must be rejected with the codes listed in this table, or accepted for an empty list.
    Codes(PathBuf),
    /// The programs must run successfully.
    Run,
    /// The programs must be accepted and satisfy their contracts, except for those in this list of exclusions with
    /// reasons.
    Contracts(PathBuf),
}

/// Options of `cargo xtask lustre-corpus`.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// Directory of the programs.
    pub(crate) programs: PathBuf,
    /// Expected result of the programs.
    pub(crate) expectation: Expectation,
    /// Groups of programs that are counted separately: a JSON object of lists of names.
    pub(crate) groups: Option<PathBuf>,
    /// Print all programs, not only those that fail.
    pub(crate) list: bool,
    /// Select only programs whose name contains this text.
    pub(crate) filter: Option<String>,
}

const USAGE: &str =
    "usage: cargo xtask lustre-corpus --programs DIR [--traces FILE.json | --reject | --kinds FILE.json | --excluded FILE.json]
    [--groups FILE.json] [--only TEXT] [--list]";

impl Options {
    pub(crate) fn parse(args: &[String]) -> Result<Options, String> {
        let mut programs = None;
        let mut options = Options {
            programs: PathBuf::new(),
            expectation: Expectation::Run,
            groups: None,
            list: false,
            filter: None,
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
                "--list" => options.list = true,
                _ => return Err(USAGE.to_owned()),
            }
        }
        options.programs = programs.ok_or(USAGE)?.into();
        Ok(options)
    }
}
