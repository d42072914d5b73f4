//! Shared parts of the command-line tools `rpic` and `rpi`: version, shell completions and manual pages, common options,
//! output to files and pipes, and the end of the process. It is independent of the commands of the tools.

mod c_target;
mod output;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use clap::CommandFactory;
pub use clap_complete::Shell;

pub use c_target::{CompilerArgs, ExecutionTarget, TargetArgs};
pub use output::{ignore_broken_pipe, is_same_file, print};

/// Version that `--version` prints: that of the tools, and that of the image format that they read and write.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (image format 5)");

/// Result of a subcommand: the exit status of the tool, or an error that is printed for the user.
pub type CommandResult<E> = Result<E, Box<dyn Error>>;

/// Prints the script that lets a shell complete the options of a tool to standard output. `C` is the command line of
/// the tool.
pub fn print_completions<C: CommandFactory>(shell: Shell) {
    let mut command = C::command();
    let name = command.get_name().to_owned();
    clap_complete::generate(shell, &mut command, name, &mut std::io::stdout());
}

/// Writes the manual pages of a tool to a folder, which is created if necessary. `C` is the command line of the tool.
///
/// # Errors
/// Returns an error if the folder or a page cannot be written.
pub fn write_man_pages<C: CommandFactory>(folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    clap_mangen::generate_to(C::command(), folder)
}

/// Returns the exit code of a tool after a subcommand. If the subcommand returned an error, prints the error to
/// standard error and returns the code of `bad_input`.
pub fn exit_code<E: Into<ExitCode>>(result: CommandResult<E>, bad_input: E) -> ExitCode {
    let status = result.unwrap_or_else(|error| {
        rpi_diag::println_stderr!("error: {error}");
        bad_input
    });
    status.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_names_the_image_format() {
        let format = format!("(image format {})", rpi_image::rpib::VERSION);
        assert!(VERSION.ends_with(&format));
    }
}
