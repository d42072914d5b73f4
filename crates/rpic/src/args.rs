//! Command line arguments.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use rpi_cli::{CompilerArgs, Shell, TargetArgs, VERSION};
use rpi_diag::Format;
use rpi_driver::ClaimPolicy;

/// The RPI compiler: checks, compiles, tests and documents programs.
#[derive(Debug, Parser)]
#[command(name = "rpic", version = VERSION, arg_required_else_help = true)]
pub(crate) struct Cli {
    /// Subcommand of `rpic` with its options.
    #[command(subcommand)]
    pub(crate) task: CliCommand,
}

/// Subcommands of `rpic`.
#[derive(Debug, Subcommand)]
pub(crate) enum CliCommand {
    /// Check programs, and report errors and warnings.
    Check(CheckArgs),
    /// Compile a command of a program to an image, or print an intermediate form of it.
    Compile(CompileArgs),
    /// Convert a net of the reference system (.rpinet) to a program.
    Import(ImportArgs),
    /// Format programs in place.
    Fmt(FmtArgs),
    /// Run the tests contained in programs.
    Test(TestArgs),
    /// Generate the HTML reference of a project or of the standard library.
    Doc(DocArgs),
    /// Create a project: a folder with a program, its cell description and a test.
    New {
        /// Folder of the project, which must not exist or be empty. Its last part is the name of the project.
        path: PathBuf,
    },
    /// Explain a diagnostic code: what it means, a wrong and a right program. Without a code: list all codes with their
    /// titles.
    Explain {
        /// Diagnostic code, written RPI4001 or 4001.
        code: Option<String>,
        /// List all diagnostic codes with their titles.
        #[arg(long, conflicts_with = "code")]
        list: bool,
    },
    /// Measure the time of an elementary operation on this machine, for the budgets of programs.
    Machine(MachineArgs),
    /// Draw the net of a command for Mermaid or Graphviz.
    Graph(GraphArgs),
    /// Run the language server (LSP over standard input and output).
    Lsp,
    /// Print the completion script of a shell.
    #[command(hide = true)]
    Completions {
        /// Shell for which completions are printed.
        shell: Shell,
    },
    /// Write the manual pages of all subcommands to a folder.
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
    #[arg(default_value = ".")]
    pub(crate) files: Vec<PathBuf>,
    /// Format of the diagnostics: human, short, json, sarif or github.
    #[arg(long, default_value = "human", value_name = "FORMAT")]
    pub(crate) format: Format,
    /// Apply the fixes that are certain, and write the changed files.
    #[arg(long)]
    pub(crate) fix: bool,
    /// Print a summary of the results of each analysis.
    #[arg(long)]
    pub(crate) explain_analysis: bool,
}

/// Options of `rpic test`.
#[derive(Args, Debug)]
pub(crate) struct TestArgs {
    /// Programs (.rpi), or folders with programs.
    #[arg(default_value = ".")]
    pub(crate) files: Vec<PathBuf>,
    /// Run only tests whose title contains this text.
    #[arg(long, value_name = "TEXT")]
    pub(crate) filter: Option<String>,
    /// Maximum number of cycles of a test; a test whose `finish` does not become true by then fails. Default: 100000
    /// for a test with a `finish`, else 1000.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) cycles: Option<u64>,
    /// Period of the cycle, such as 1ms.
    #[arg(long, default_value = "1ms", value_parser = rpi_driver::parse_duration, value_name = "TIME")]
    pub(crate) period: u64,
    #[command(flatten)]
    pub(crate) execution: TargetArgs,
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
    /// Folder to which the pages are written.
    #[arg(long, default_value = "target/doc", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Document the standard library instead of a project.
    #[arg(long)]
    pub(crate) std: bool,
    /// Open the start page in a browser afterwards.
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
    #[command(flatten)]
    pub(crate) compiler: CompilerArgs,
    /// Print this intermediate form instead of writing an image.
    #[arg(long, value_name = "FORM")]
    pub(crate) emit: Option<Form>,
    /// Command to compile, if the program has several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Node or function to write with `--emit lustre` or `--emit c`. Default in a Lustre program: the node that `rpi run`
    /// would run.
    #[arg(long, visible_alias = "function", value_name = "NAME")]
    pub(crate) node: Option<String>,
    /// Write the declarations of `--emit c` to the source file instead of a header beside it.
    #[arg(long)]
    pub(crate) single_file: bool,
    /// Write `#line` directives with `--emit c`, so that C compilers and debuggers show the places of the program.
    #[arg(long)]
    pub(crate) line_directives: bool,
    /// Treatment of assertions and contracts in the image: omitted, published for monitoring, or a fault that ends the
    /// command.
    #[arg(long, value_name = "MODE", default_value = "off")]
    pub(crate) contracts: Contracts,
    /// Period of the cycle for which the image is compiled, such as 1ms.
    #[arg(long, default_value = "1ms", value_parser = rpi_driver::parse_duration, value_name = "TIME")]
    pub(crate) period: u64,
}

/// Treatment of assertions and contracts in an image.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Contracts {
    /// Assertions and contracts are omitted, without any cost at run time.
    Off,
    /// The results of assertions and contracts are published, together with the flows that they read.
    Report,
    /// A violated assertion or contract is a fault that ends the command.
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

/// Forms of a program that `rpic compile --emit` prints.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Form {
    /// Tokens of the source text, as the lexer finds them.
    Tokens,
    /// Syntax tree of the source text.
    Ast,
    /// Nodes and commands after type checking, with the types of their flows.
    Typed,
    /// Net as used by the compiler, without results and exports.
    Net,
    /// Net for the reference system (.rpinet), with results and exports as ports and primitives.
    Rpinet,
    /// Order in which the primitives of the net are evaluated.
    Schedule,
    /// Text of the compiled image, one line per step.
    Image,
    /// Drawing of the net in the language of Graphviz.
    Dot,
    /// Drawing of the net in the language of Mermaid.
    Mermaid,
    /// C99 source with a function that evaluates one cycle, of a command or of the node given by `--node`.
    C,
    /// Functional Mock-up Unit (FMI 3.0, co-simulation) with the C source and its library for this machine, of a command or
    /// of the node given by `--node`.
    Fmu,
    /// Lustre source for model checkers, of a command or of the node given by `--node`.
    Lustre,
}

/// Options of `rpic import`.
#[derive(Args, Debug)]
pub(crate) struct ImportArgs {
    /// Net to convert (.rpinet), plain or .gz.
    pub(crate) file: PathBuf,
    /// Output file. Default: standard output.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `rpic fmt`.
#[derive(Args, Debug)]
pub(crate) struct FmtArgs {
    /// Programs (.rpi, .lus), or folders with programs.
    #[arg(default_value = ".")]
    pub(crate) files: Vec<PathBuf>,
    /// Change nothing; print the differences and exit with status 1 if there are any.
    #[arg(long)]
    pub(crate) check: bool,
    /// Read a program from standard input and write it to standard output.
    #[arg(long, conflicts_with_all = ["files", "check"])]
    pub(crate) stdin: bool,
    /// File name that diagnostics show for the text on standard input; a name that ends in .lus means Lustre.
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
    /// Output file. Programs in a folder use the file `machine.toml` of that folder. Default: standard output.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `rpic graph`.
#[derive(Args, Debug)]
pub(crate) struct GraphArgs {
    /// Program (.rpi, .lus) or net (.rpinet), plain or .gz.
    pub(crate) file: PathBuf,
    /// Language of the drawing: dot (Graphviz) or mermaid.
    #[arg(long, default_value = "mermaid", value_name = "FORMAT")]
    pub(crate) format: Drawing,
    /// Command to draw, if the program has several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Output file. Default: standard output.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Languages of the drawings of `rpic graph`.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Drawing {
    /// Graph in the language dot of Graphviz.
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
