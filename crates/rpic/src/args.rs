//! Command line arguments.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use rpi_cli::{Shell, VERSION};
use rpi_diag::Format;
use rpi_driver::ClaimPolicy;

/// The RPI compiler: checks, compiles, tests and documents programs.
#[derive(Debug, Parser)]
#[command(name = "rpic", version = VERSION, arg_required_else_help = true)]
pub(crate) struct Cli {
    /// Subcommand.
    #[command(subcommand)]
    pub(crate) task: CliCommand,
}

/// Subcommands of `rpic`.
#[derive(Debug, Subcommand)]
pub(crate) enum CliCommand {
    /// Check programs and report errors and warnings.
    Check(CheckArgs),
    /// Compile a command to an image, or print an intermediate form.
    Compile(CompileArgs),
    /// Convert a net of the reference system to a program.
    Import(ImportArgs),
    /// Format programs in place.
    Fmt(FmtArgs),
    /// Run the tests contained in programs.
    Test(TestArgs),
    /// Generate the HTML reference of a project.
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
    /// Measure the time of an elementary operation on this machine, for the budgets of programs.
    Machine(MachineArgs),
    /// Draw a net.
    Graph(GraphArgs),
    /// Run the language server (LSP over standard input and output).
    Lsp,
    /// Print the completion script of a shell.
    #[command(hide = true)]
    Completions {
        /// Shell for which completions are printed.
        shell: Shell,
    },
    /// Write the manual pages to a folder.
    #[command(hide = true)]
    Man {
        /// Folder into which the manual pages are written.
        folder: PathBuf,
    },
}

/// Options of `rpic check`.
#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    /// Programs (.rpi, .lus) or nets (.rpinet), plain or .gz; or folders with programs.
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Format of the diagnostics: human, short, json, sarif or github.
    #[arg(long, default_value = "human", value_name = "FORMAT")]
    pub(crate) format: Format,
    /// Apply the fixes that are certain.
    #[arg(long)]
    pub(crate) fix: bool,
    /// Print the results of each analysis.
    #[arg(long)]
    pub(crate) explain_analysis: bool,
}

/// Options of `rpic test`.
#[derive(Args, Debug)]
pub(crate) struct TestArgs {
    /// Programs (.rpi), or folders with programs.
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Run only tests whose title contains this text.
    #[arg(long, value_name = "TEXT")]
    pub(crate) filter: Option<String>,
    /// Largest number of cycles of a test; a test whose `finish` does not come by then fails. Default: 100000 for a
    /// test with a `finish`, otherwise 1000.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) cycles: Option<u64>,
    /// Period of the cycle.
    #[arg(long, default_value = "1ms", value_parser = rpi_driver::parse_duration, value_name = "TIME")]
    pub(crate) period: u64,
    /// Report fragments, branches and transitions that no test has covered.
    #[arg(long)]
    pub(crate) coverage: bool,
    /// Format of the diagnostics: human, short, json, sarif or github.
    #[arg(long, default_value = "human", value_name = "FORMAT")]
    pub(crate) format: Format,
}

/// Options of `rpic doc`.
#[derive(Args, Debug)]
pub(crate) struct DocArgs {
    /// Folder with programs, its rpi.toml, or a single program.
    #[arg(default_value = ".", conflicts_with = "std")]
    pub(crate) path: PathBuf,
    /// Output folder.
    #[arg(long, default_value = "target/doc", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Document the standard library instead of a project.
    #[arg(long)]
    pub(crate) std: bool,
    /// Open the start page in a browser.
    #[arg(long)]
    pub(crate) open: bool,
}

/// Options of `rpic compile`.
#[derive(Args, Debug)]
pub(crate) struct CompileArgs {
    /// Program (.rpi, .lus) or net (.rpinet), plain or .gz.
    pub(crate) file: PathBuf,
    /// Output file. Default: the source file with the extension .rpib, or standard output with `--emit`.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Print an intermediate form instead of writing an image.
    #[arg(long, value_name = "FORM")]
    pub(crate) emit: Option<Form>,
    /// Command to compile, if there are several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Node to write as a Lustre node. Default in a Lustre program: the node that `rpi run` would run.
    #[arg(long, value_name = "NAME")]
    pub(crate) node: Option<String>,
    /// Assertions and contracts in the image: omitted, published for monitoring, or a fault that ends the command.
    #[arg(long, value_name = "MODE", default_value = "off")]
    pub(crate) contracts: Contracts,
    /// Period of the cycle for which the image is compiled.
    #[arg(long, default_value = "1ms", value_parser = rpi_driver::parse_duration, value_name = "TIME")]
    pub(crate) period: u64,
}

/// Treatment of assertions and contracts.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Contracts {
    /// Omitted, without any cost.
    Off,
    /// Results are published, together with the flows that they read.
    Report,
    /// A violation is a fault that ends the command.
    Fault,
}

impl From<Contracts> for ClaimPolicy {
    fn from(contracts: Contracts) -> ClaimPolicy {
        match contracts {
            Contracts::Off => ClaimPolicy::Off,
            Contracts::Report => ClaimPolicy::Report,
            Contracts::Fault => ClaimPolicy::Fault,
        }
    }
}

/// Intermediate and output forms of a program.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Form {
    /// Tokens of the parser.
    Tokens,
    /// Syntax tree.
    Ast,
    /// Typed units.
    Typed,
    /// Net as used by the compiler, without results and exports.
    Net,
    /// Net for the reference system, with results and exports as ports and primitives.
    Rpinet,
    /// Order of evaluation.
    Schedule,
    /// Image, one line per step.
    Image,
    /// Drawing of the net for Graphviz.
    Dot,
    /// Drawing of the net for Mermaid.
    Mermaid,
    /// C99 source with one function per cycle.
    C,
    /// Lustre source for model checkers: a command, or the node given by `--node`.
    Lustre,
}

/// Options of `rpic import`.
#[derive(Args, Debug)]
pub(crate) struct ImportArgs {
    /// Net (.rpinet), plain or .gz.
    pub(crate) file: PathBuf,
    /// Output file. Default: standard output.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `rpic fmt`.
#[derive(Args, Debug)]
pub(crate) struct FmtArgs {
    /// Programs (.rpi, .lus), or folders with programs.
    #[arg(required_unless_present = "stdin")]
    pub(crate) files: Vec<PathBuf>,
    /// Change nothing; print the differences and exit with status 1 if there are any.
    #[arg(long)]
    pub(crate) check: bool,
    /// Read a program from standard input and write it to standard output.
    #[arg(long, conflicts_with_all = ["files", "check"])]
    pub(crate) stdin: bool,
    /// File name of the text on standard input; a name that ends in .lus means Lustre.
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
    /// Output file; programs use `machine.toml` in their own folder. Default: standard output.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `rpic graph`.
#[derive(Args, Debug)]
pub(crate) struct GraphArgs {
    /// Program (.rpi, .lus) or net (.rpinet), plain or .gz.
    pub(crate) file: PathBuf,
    /// Language of the drawing.
    #[arg(long, default_value = "mermaid", value_name = "FORMAT")]
    pub(crate) format: Drawing,
    /// Command to draw, if there are several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Output file. Default: standard output.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Languages of drawings.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Drawing {
    /// Graphviz.
    Dot,
    /// Diagram in the text form of Mermaid, which web pages draw.
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
}
