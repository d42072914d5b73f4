//! What can be asked for on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use rpi_diag::Format;
use rpi_driver::Claims;

/// Version of the tool and of the image format that it writes.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (image format 2)");

/// The compiler: proves what can be proved of a program before a robot runs it.
#[derive(Debug, Parser)]
#[command(name = "rpic", version = VERSION, arg_required_else_help = true)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) task: Task,
}

/// The tasks.
#[derive(Debug, Subcommand)]
pub(crate) enum Task {
    /// Look for faults.
    Check(CheckArgs),
    /// Compile a command to an image, or show a form that it takes on the way.
    Compile(CompileArgs),
    /// Write a net of the reference system as a program.
    Import(ImportArgs),
    /// Format programs in place.
    Fmt(FmtArgs),
    /// Run the tests that stand in programs.
    Test(TestArgs),
    /// Write the reference of a project in HTML.
    Doc(DocArgs),
    /// Create a project: a program, its cell and a test.
    New {
        /// Folder of the project; its last part is the project's name.
        path: PathBuf,
    },
    /// Explain a code: what it means, a wrong and a right program. Without a code: list all codes with their titles.
    Explain {
        /// The code, RPI4001 or 4001.
        code: Option<String>,
        /// List all codes with their titles.
        #[arg(long, conflicts_with = "code")]
        list: bool,
    },
    /// Measure how long an elementary operation takes here, for the budgets of programs.
    Machine(MachineArgs),
    /// Draw a net.
    Graph(GraphArgs),
    /// Serve an editor (Language Server Protocol, over standard input and output).
    Lsp,
    /// Print the completions of a shell.
    #[command(hide = true)]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Write the manual pages into a folder.
    #[command(hide = true)]
    Man {
        /// The folder.
        folder: PathBuf,
    },
}

/// Options of `rpic check`.
#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    /// Programs (.rpi, .lus) or nets (.rpinet), plain or .gz; folders with programs.
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Form of the findings: human, short, json, sarif or github.
    #[arg(long, default_value = "human", value_name = "FORM")]
    pub(crate) format: Format,
    /// Apply the fixes that are sure.
    #[arg(long)]
    pub(crate) fix: bool,
    /// Tell what each analysis found out.
    #[arg(long)]
    pub(crate) explain_analysis: bool,
}

/// Options of `rpic test`.
#[derive(Args, Debug)]
pub(crate) struct TestArgs {
    /// Programs (.rpi), or folders with programs.
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Only tests whose title contains this.
    #[arg(long, value_name = "TEXT")]
    pub(crate) filter: Option<String>,
    /// A test ends after so many cycles, and fails if it has a `finish` that did not come; 1000 unless given, 100000 where
    /// there is a `finish`.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) cycles: Option<u64>,
    /// Period of the cycle.
    #[arg(long, default_value = "1ms", value_parser = rpi_driver::parse_period, value_name = "TIME")]
    pub(crate) period: u64,
    /// Tell which fragments, branches and transitions no test has seen.
    #[arg(long)]
    pub(crate) coverage: bool,
    /// Form of the findings: human, short, json, sarif or github.
    #[arg(long, default_value = "human", value_name = "FORM")]
    pub(crate) format: Format,
}

/// Options of `rpic doc`.
#[derive(Args, Debug)]
pub(crate) struct DocArgs {
    /// A folder with programs, its rpi.toml, or a single program.
    #[arg(default_value = ".", conflicts_with = "std")]
    pub(crate) path: PathBuf,
    /// Where to write the pages.
    #[arg(long, default_value = "target/doc", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Of the standard library instead of a project.
    #[arg(long)]
    pub(crate) std: bool,
    /// Open the first page.
    #[arg(long)]
    pub(crate) open: bool,
}

/// Options of `rpic compile`.
#[derive(Args, Debug)]
pub(crate) struct CompileArgs {
    /// A program (.rpi, .lus) or net (.rpinet), plain or .gz.
    pub(crate) file: PathBuf,
    /// Where to write; without it the file beside the source that ends in .rpib, or standard output for a form.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Show a form instead of writing an image.
    #[arg(long, value_name = "FORM")]
    pub(crate) emit: Option<Form>,
    /// The command, if there are several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// The node that becomes a Lustre node; in a Lustre program the one that `rpi run` would run.
    #[arg(long, value_name = "NAME")]
    pub(crate) node: Option<String>,
    /// Assertions and contracts in the image: left out, published for whoever watches, or a fault that ends the command.
    #[arg(long, value_name = "HOW", default_value = "off")]
    pub(crate) contracts: Contracts,
    /// Period of the cycle for which the image is made.
    #[arg(long, default_value = "1ms", value_parser = rpi_driver::parse_period, value_name = "TIME")]
    pub(crate) period: u64,
}

/// What becomes of assertions and contracts.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Contracts {
    /// They are left out and cost nothing.
    Off,
    /// Whether they hold is published, with the flows that they read.
    Report,
    /// One that does not hold ends the command by a fault.
    Fault,
}

impl From<Contracts> for Claims {
    fn from(contracts: Contracts) -> Claims {
        match contracts {
            Contracts::Off => Claims::Off,
            Contracts::Report => Claims::Report,
            Contracts::Fault => Claims::Fault,
        }
    }
}

/// The forms of a program on its way.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Form {
    /// Tokens as the parser sees them.
    Tokens,
    /// Syntax tree.
    Ast,
    /// Typed units.
    Typed,
    /// Net as the compiler sees it, without results and exports.
    Net,
    /// Net that the reference system can take: results and exports as ports and primitives.
    Rpinet,
    /// Order of evaluation.
    Schedule,
    /// Flat image, one line per step.
    Image,
    /// Net drawn for Graphviz.
    Dot,
    /// Net drawn for Mermaid.
    Mermaid,
    /// C99 text with one function per cycle.
    C,
    /// Lustre text for model checkers: a command, or the node that `--node` names.
    Lustre,
}

/// Options of `rpic import`.
#[derive(Args, Debug)]
pub(crate) struct ImportArgs {
    /// The net (.rpinet), plain or .gz.
    pub(crate) file: PathBuf,
    /// Where to write; standard output without it.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `rpic fmt`.
#[derive(Args, Debug)]
pub(crate) struct FmtArgs {
    /// Programs (.rpi, .lus), or folders with programs.
    #[arg(required_unless_present = "stdin")]
    pub(crate) files: Vec<PathBuf>,
    /// Change nothing; show what would change, and exit with 1 if something would.
    #[arg(long)]
    pub(crate) check: bool,
    /// Read a program from standard input and write it to standard output.
    #[arg(long, conflicts_with_all = ["files", "check"])]
    pub(crate) stdin: bool,
    /// What the text on standard input is called: one that ends with .lus is Lustre.
    #[arg(
        long,
        value_name = "FILE",
        requires = "stdin",
        default_value = "stdin.rpi"
    )]
    pub(crate) stdin_name: String,
}

/// Options of `rpic machine`.
#[derive(Args, Debug)]
pub(crate) struct MachineArgs {
    /// Where to write; programs look for `machine.toml` beside them. Standard output without it.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `rpic graph`.
#[derive(Args, Debug)]
pub(crate) struct GraphArgs {
    /// A program (.rpi, .lus) or net (.rpinet), plain or .gz.
    pub(crate) file: PathBuf,
    /// Language of the drawing.
    #[arg(long, default_value = "mermaid", value_name = "FORM")]
    pub(crate) format: Drawing,
    /// The command, if there are several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Where to write; standard output without it.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Languages of drawings.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Drawing {
    /// Graphviz.
    Dot,
    /// Mermaid.
    Mermaid,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_options_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_version_names_the_image_format() {
        let format = format!("(image format {})", rpi_image::rpib::VERSION);
        assert!(VERSION.ends_with(&format));
    }
}
