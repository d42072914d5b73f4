//! C compiler, called as a command.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering};

use super::cortex_m4;

/// Error of the compilation or execution of C.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CTargetError(pub String);

impl fmt::Display for CTargetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for CTargetError {}

/// Command of a C compiler with its options, such as `gcc -O2`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CCompiler {
    pub(crate) program: String,
    pub(crate) options: Vec<String>,
    /// Ending of the source file, by which compilers recognise the language: `c` or `cpp`.
    pub(crate) ending: &'static str,
    /// Command that runs a program, before the path of the program; empty if the system runs it itself.
    pub(crate) runner: &'static [&'static str],
    /// Files of the target, with their texts, in the folder in which the compiler runs. Its options name them.
    pub(crate) files: &'static [(&'static str, &'static str)],
}

impl CCompiler {
    /// Creates the compiler from a command, split at spaces. `cortex-m4` stands for the compiler and the emulator of a
    /// microcontroller. A command without a program means `cc -O2`.
    #[must_use]
    pub fn new(command: &str) -> CCompiler {
        let mut words = command.split_whitespace().map(str::to_owned);
        let program = words.next().unwrap_or_else(|| "cc".to_owned());
        let options: Vec<String> = words.collect();
        if program == cortex_m4::NAME {
            return cortex_m4::compiler(options);
        }
        let is_cpp = program.ends_with("++") || options.iter().any(|o| o.contains("c++"));
        CCompiler {
            program,
            options,
            ending: if is_cpp { "cpp" } else { "c" },
            runner: &[],
            files: &[],
        }
    }

    /// Returns whether the compiler, and the emulator if there is one, can be started.
    #[must_use]
    pub fn is_installed(&self) -> bool {
        let answers = |program: &str| {
            let version = Command::new(program).arg("--version").output();
            version.is_ok_and(|output| output.status.success())
        };
        answers(&self.program) && self.runner.first().is_none_or(|runner| answers(runner))
    }

    /// Returns whether the programs run on a microcontroller in an emulator.
    #[must_use]
    pub fn is_microcontroller(&self) -> bool {
        !self.runner.is_empty()
    }

    /// Compiles a C text to a program in a new folder for temporary files.
    ///
    /// # Errors
    /// Returns the messages of the compiler, warnings included if `-Werror` is among its options.
    pub fn compile(&self, text: &str) -> Result<CBinary, CTargetError> {
        self.build(text, &[])
    }

    /// Compiles a C text together with sources, object files and libraries, given by absolute paths. The folders of the
    /// libraries are where the program finds them.
    pub(crate) fn link(&self, text: &str, files: &[PathBuf]) -> Result<CBinary, CTargetError> {
        let folders = files.iter().filter_map(|file| file.parent());
        let folders = folders.map(|folder| format!("-Wl,-rpath,{}", folder.display()));
        let named = files.iter().map(|file| file.display().to_string());
        let last: Vec<String> = folders.chain(named).chain(["-lm".to_owned()]).collect();
        self.build_with(text, &[], &last)
    }

    /// Compiles a C text with additional options.
    pub(crate) fn build(&self, text: &str, options: &[&str]) -> Result<CBinary, CTargetError> {
        self.build_with(text, options, &[])
    }

    fn build_with(
        &self,
        text: &str,
        options: &[&str],
        last: &[String],
    ) -> Result<CBinary, CTargetError> {
        let binary = CBinary::new(self.runner)?;
        let source = format!("program.{}", self.ending);
        binary.write(&source, text)?;
        for (name, content) in self.files {
            binary.write(name, content)?;
        }
        let mut command = Command::new(&self.program);
        command.current_dir(&binary.folder);
        command.args(&self.options).args(options);
        command.args(["-o", PROGRAM, &source]).args(last);
        let output = command.output();
        let output = output.map_err(|e| CTargetError(format!("{}: {e}", self.program)))?;
        match output.status.success() {
            true => Ok(binary),
            false => Err(CTargetError(
                String::from_utf8_lossy(&output.stderr).into_owned(),
            )),
        }
    }
}

impl fmt::Display for CCompiler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.runner.is_empty() {
            return f.write_str(cortex_m4::NAME);
        }
        f.write_str(&self.program)?;
        self.options
            .iter()
            .try_for_each(|option| write!(f, " {option}"))
    }
}

/// Name of the compiled file in its folder.
const PROGRAM: &str = "program";

/// Compiled program in a folder of its own, which is removed with this value.
#[derive(Debug)]
pub struct CBinary {
    folder: PathBuf,
    runner: &'static [&'static str],
}

impl CBinary {
    fn new(runner: &'static [&'static str]) -> Result<CBinary, CTargetError> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("rpi-c-{}-{number}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        // An existing folder is an error: its content could belong to another user.
        std::fs::create_dir(&folder)
            .map_err(|e| CTargetError(format!("{}: {e}", folder.display())))?;
        Ok(CBinary { folder, runner })
    }

    fn write(&self, name: &str, text: &str) -> Result<(), CTargetError> {
        let path = self.folder.join(name);
        std::fs::write(&path, text).map_err(|e| CTargetError(format!("{}: {e}", path.display())))
    }

    /// Returns the path of the program.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        Path::new(&self.folder).join(PROGRAM)
    }

    /// Returns the command that runs the program, on the emulator of the target if there is one.
    #[must_use]
    pub fn command(&self) -> Command {
        match self.runner {
            [] => Command::new(self.path()),
            [program, options @ ..] => {
                let mut command = Command::new(program);
                command.args(options).arg(self.path());
                command
            }
        }
    }
}

impl Drop for CBinary {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
