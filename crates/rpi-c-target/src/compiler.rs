//! C compiler, called as a command.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering};

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
    program: String,
    options: Vec<String>,
    /// Ending of the source file, by which compilers recognise the language: `c` or `cpp`.
    ending: &'static str,
}

impl CCompiler {
    /// Creates the compiler from a command, split at spaces. A command without a program means `cc -O2`.
    #[must_use]
    pub fn new(command: &str) -> CCompiler {
        let mut words = command.split_whitespace().map(str::to_owned);
        let program = words.next().unwrap_or_else(|| "cc".to_owned());
        let options: Vec<String> = words.collect();
        let is_cpp = program.ends_with("++") || options.iter().any(|o| o.contains("c++"));
        CCompiler {
            program,
            options,
            ending: if is_cpp { "cpp" } else { "c" },
        }
    }

    /// Returns whether the compiler can be started.
    #[must_use]
    pub fn is_installed(&self) -> bool {
        let version = Command::new(&self.program).arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    }

    /// Compiles a C text to a program in a new folder for temporary files.
    ///
    /// # Errors
    /// Returns the messages of the compiler, warnings included if `-Werror` is among its options.
    pub fn compile(&self, text: &str) -> Result<CBinary, CTargetError> {
        let binary = CBinary::new()?;
        let source = binary.folder.join(format!("program.{}", self.ending));
        std::fs::write(&source, text)
            .map_err(|e| CTargetError(format!("{}: {e}", source.display())))?;
        let mut command = Command::new(&self.program);
        command
            .args(&self.options)
            .arg("-o")
            .arg(binary.path())
            .arg(&source);
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

/// Compiled program in a folder of its own, which is removed with this value.
#[derive(Debug)]
pub struct CBinary {
    folder: PathBuf,
}

impl CBinary {
    fn new() -> Result<CBinary, CTargetError> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("rpi-c-{}-{number}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        // An existing folder is an error: its content could belong to another user.
        std::fs::create_dir(&folder)
            .map_err(|e| CTargetError(format!("{}: {e}", folder.display())))?;
        Ok(CBinary { folder })
    }

    /// Returns the path of the program.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        Path::new(&self.folder).join("program")
    }
}

impl Drop for CBinary {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
