//! What is asked for on the command line.

use std::path::PathBuf;

/// What the programs are to do.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Wanted {
    /// Give what the traces say.
    Match(PathBuf),
    /// Be refused.
    Reject,
    /// Be refused for the reason that a table gives, or not at all.
    Kinds(PathBuf),
    /// Run.
    Run,
    /// Be accepted and keep their claims, but for those that a list excludes, each with its reason.
    Keep(PathBuf),
}

/// The options of the chore.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// Where the programs are.
    pub(crate) programs: PathBuf,
    /// What they are to do.
    pub(crate) wanted: Wanted,
    /// Groups of programs, a JSON object of lists of names, to be counted by themselves.
    pub(crate) groups: Option<PathBuf>,
    /// Show all programs, not only those that fail.
    pub(crate) list: bool,
    /// Only programs in whose name this occurs.
    pub(crate) only: Option<String>,
}

const USAGE: &str =
    "usage: cargo xtask lustre-corpus --programs DIR [--traces FILE.json | --reject | --kinds FILE.json | --excluded FILE.json]
    [--groups FILE.json] [--only TEXT] [--list]";

impl Options {
    pub(crate) fn parse(args: &[String]) -> Result<Options, String> {
        let mut programs = None;
        let mut options = Options {
            programs: PathBuf::new(),
            wanted: Wanted::Run,
            groups: None,
            list: false,
            only: None,
        };
        let mut args = args.iter();
        while let Some(arg) = args.next() {
            let mut value = || args.next().ok_or(USAGE);
            match arg.as_str() {
                "--programs" => programs = Some(value()?),
                "--traces" => options.wanted = Wanted::Match(value()?.into()),
                "--reject" => options.wanted = Wanted::Reject,
                "--kinds" => options.wanted = Wanted::Kinds(value()?.into()),
                "--excluded" => options.wanted = Wanted::Keep(value()?.into()),
                "--groups" => options.groups = Some(value()?.into()),
                "--only" => options.only = Some(value()?.clone()),
                "--list" => options.list = true,
                _ => return Err(USAGE.to_owned()),
            }
        }
        options.programs = programs.ok_or(USAGE)?.into();
        Ok(options)
    }
}
