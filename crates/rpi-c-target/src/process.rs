//! Running program of a translated image.

use super::compiler::{CBinary, CCompiler, CTargetError};
use super::cortex_m4::instructions;
use rpi_codegen::{Emitted, Options, driver, emit};
use rpi_image::Image;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::sync::Arc;

/// Function that computes a device function during a cycle: number of the function and arguments. `None` means that
/// there is no result.
pub type DeviceCall<'a> = &'a mut dyn FnMut(usize, &[u64]) -> Option<Vec<u64>>;

/// Result of a cycle in C.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CCycle {
    /// Fault code; 0 without a fault.
    pub fault: i32,
    /// Line of the fault in the source; 0 if it is not known.
    pub line: u32,
    /// Words of the output struct, element by element.
    pub outputs: Vec<u64>,
}

/// Translated and compiled image.
#[derive(Debug)]
pub struct CProgram {
    /// Translated image: the fields of its structs give the order of the words.
    pub emitted: Emitted,
    binary: CBinary,
}

impl CProgram {
    /// Translates an image and compiles the text.
    ///
    /// # Errors
    /// Returns the messages of the compiler.
    pub fn compile(image: &Image, compiler: &CCompiler) -> Result<CProgram, CTargetError> {
        let name = rpi_codegen::program_name(&image.name);
        let emitted = emit(image, &plain_options(&name));
        let text = emitted.source.clone() + &driver(image, &name, &emitted.interface);
        let binary = compiler.compile(&text)?;
        Ok(CProgram { emitted, binary })
    }
}

/// Returns the options for the text of a program that only runs.
pub(crate) fn plain_options(name: &str) -> Options<'_> {
    Options {
        name,
        header: None,
        locate: &|_| None,
        line_directives: false,
        origin: "",
    }
}

/// Translated image as a process that runs a cycle on request.
#[derive(Debug)]
pub struct CProcess {
    child: Child,
    requests: Option<ChildStdin>,
    replies: BufReader<ChildStdout>,
    /// Program of the process. Its file must not be removed while the process runs.
    pub program: Arc<CProgram>,
}

impl CProcess {
    /// Starts a program.
    ///
    /// # Errors
    /// Returns the reason why the program does not start.
    pub fn start(program: Arc<CProgram>) -> Result<CProcess, CTargetError> {
        let mut command = program.binary.command();
        let child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = child.map_err(error)?;
        let (requests, replies) = (child.stdin.take(), child.stdout.take());
        let replies = replies.ok_or_else(|| error("no pipe"))?;
        Ok(CProcess {
            child,
            requests,
            replies: BufReader::new(replies),
            program,
        })
    }

    /// Restores the initial state.
    ///
    /// # Errors
    /// If the process has ended.
    pub fn reset(&mut self) -> Result<(), CTargetError> {
        self.send("r\n")
    }

    /// Returns whether the compiler kept the order and the rounding of operations on reals.
    ///
    /// # Errors
    /// If the process has ended.
    pub fn self_test(&mut self) -> Result<bool, CTargetError> {
        self.send("t\n")?;
        Ok(self.reply()?.trim() == "1")
    }

    /// Returns the number of instructions that a microcontroller has executed in all cycles so far; 0 on other targets.
    ///
    /// # Errors
    /// If the process has ended.
    pub fn instructions(&mut self) -> Result<u64, CTargetError> {
        self.send("i\n")?;
        Ok(instructions(word(self.reply()?.trim())?))
    }

    /// Runs one cycle. `inputs` holds one word for each element of the input struct.
    ///
    /// # Errors
    /// If the process has ended or its reply is not understood.
    pub fn step(&mut self, inputs: &[u64], call: DeviceCall<'_>) -> Result<CCycle, CTargetError> {
        self.send(&line("s", inputs))?;
        loop {
            let reply = self.reply()?;
            let Some(request) = reply.strip_prefix("c ") else {
                return cycle(&reply);
            };
            let mut words = request.split_whitespace();
            let number = words.next().and_then(|w| w.parse().ok());
            let number = number.ok_or_else(|| error("unexpected reply"))?;
            let arguments: Vec<u64> = words.map(word).collect::<Result<_, _>>()?;
            let answer = match call(number, &arguments) {
                Some(results) => line("1", &results),
                None => "0\n".to_owned(),
            };
            self.send(&answer)?;
        }
    }

    fn send(&mut self, text: &str) -> Result<(), CTargetError> {
        let pipe = self.requests.as_mut().ok_or_else(|| error("no pipe"))?;
        pipe.write_all(text.as_bytes())
            .and_then(|()| pipe.flush())
            .map_err(error)
    }

    fn reply(&mut self) -> Result<String, CTargetError> {
        let mut reply = String::new();
        match self.replies.read_line(&mut reply).map_err(error)? {
            0 => Err(error("the program has ended")),
            _ => Ok(reply),
        }
    }
}

impl Drop for CProcess {
    fn drop(&mut self) {
        // The program ends at the end of its input.
        drop(self.requests.take());
        let _ = self.child.wait();
    }
}

pub(crate) fn error(cause: impl ToString) -> CTargetError {
    CTargetError(cause.to_string())
}

pub(crate) fn word(text: &str) -> Result<u64, CTargetError> {
    u64::from_str_radix(text, 16).map_err(error)
}

pub(crate) fn line(head: &str, words: &[u64]) -> String {
    let words = words.iter().map(|w| format!(" {w:x}"));
    format!("{head}{}\n", words.collect::<String>())
}

fn cycle(reply: &str) -> Result<CCycle, CTargetError> {
    let mut words = reply.split_whitespace();
    let fault = words.next().and_then(|w| w.parse().ok());
    let line = words.next().and_then(|w| w.parse().ok());
    let (Some(fault), Some(line)) = (fault, line) else {
        return Err(CTargetError(format!("unexpected reply: {reply}")));
    };
    let outputs = words.map(word).collect::<Result<_, _>>()?;
    Ok(CCycle {
        fault,
        line,
        outputs,
    })
}
