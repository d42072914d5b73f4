//! Keys of the terminal, one by one and without echo; or those of a file or pipe.

use std::io::{self, IsTerminal as _, Read as _};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rustix::termios::{
    LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcsetattr,
};

/// Standard input that returns single keys. A terminal gets its settings back at the end.
pub(super) struct Terminal {
    /// Settings of the terminal at the start; `None` if the input is a file or a pipe.
    before: Option<Termios>,
    /// Flag that a signal sets to end the program.
    interrupted: Arc<AtomicBool>,
}

/// Result of waiting for a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Input {
    Key(u8),
    /// No key was pressed for a tenth of a second.
    Nothing,
    /// The input has ended.
    End,
}

impl Terminal {
    /// Sets the terminal to single keys, if the input is one.
    ///
    /// # Errors
    /// Returns the error of the system.
    pub(super) fn open(interrupted: Arc<AtomicBool>) -> io::Result<Terminal> {
        let before = match io::stdin().is_terminal() {
            true => Some(tcgetattr(io::stdin())?),
            false => None,
        };
        let terminal = Terminal {
            before,
            interrupted,
        };
        terminal.set_single_keys()?;
        Ok(terminal)
    }

    /// True if the input is a terminal, at which a person presses the keys.
    pub(super) fn is_interactive(&self) -> bool {
        self.before.is_some()
    }

    /// Waits a tenth of a second for the next key.
    ///
    /// # Errors
    /// Returns the error of the system.
    pub(super) fn read(&self) -> io::Result<Input> {
        let mut byte = [0];
        match io::stdin().lock().read(&mut byte) {
            Ok(0) if self.is_interactive() => Ok(Input::Nothing),
            Ok(0) => Ok(Input::End),
            Ok(_) => Ok(Input::Key(byte[0])),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(Input::Nothing),
            Err(error) => Err(error),
        }
    }

    /// Prints `prompt` and reads a line, which is shown while it is typed. Returns `None` if a signal ends the program.
    ///
    /// # Errors
    /// Returns the error of the system.
    pub(super) fn line(&self, prompt: &str) -> io::Result<Option<String>> {
        rpi_diag::print_stderr!("{prompt}");
        let mut line = Vec::new();
        while !self.interrupted.load(Ordering::Relaxed) {
            match self.read()? {
                Input::Nothing => continue,
                Input::End | Input::Key(b'\n' | b'\r') => {
                    rpi_diag::print_stderr!("\n");
                    return Ok(Some(String::from_utf8_lossy(&line).into_owned()));
                }
                // Backspace, as terminals send it.
                Input::Key(8 | 127) => drop(line.pop()),
                Input::Key(byte) => line.push(byte),
            }
            if self.is_interactive() {
                rpi_diag::print_stderr!("\r\x1b[K{prompt}{}", String::from_utf8_lossy(&line));
            }
        }
        Ok(None)
    }

    fn set_single_keys(&self) -> io::Result<()> {
        let Some(before) = &self.before else {
            return Ok(());
        };
        let mut single = before.clone();
        single.local_modes -= LocalModes::ICANON | LocalModes::ECHO;
        single.special_codes[SpecialCodeIndex::VMIN] = 0;
        single.special_codes[SpecialCodeIndex::VTIME] = 1;
        Ok(tcsetattr(io::stdin(), OptionalActions::Now, &single)?)
    }

    fn restore(&self) {
        if let Some(before) = &self.before {
            // A terminal that is gone needs no settings.
            let _ = tcsetattr(io::stdin(), OptionalActions::Now, before);
        }
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.restore();
    }
}
