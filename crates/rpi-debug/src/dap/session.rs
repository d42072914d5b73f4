//! The requests of a client, and what each does.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use rpi_core::CommandId;
use rpi_diag::Span;
use rpi_files::framing::read_message;
use rpi_record::mcap::Recording;
use serde_json::{Value, json};

use super::Launch;
use super::breakpoints::Breakpoints;
use super::frames::Frame;
use super::messages::{Answer, Client, capabilities};
use super::variables::Variables;
use crate::debugger::Debugger;
use crate::program::RecordedProgram;

/// State of a client that debugs a recording.
pub(crate) struct Session<'a, W> {
    client: Client<W>,
    launch: Launch<'a>,
    interrupt: Arc<AtomicUsize>,
    stops_on_entry: bool,
    /// What is debugged, from the request `launch` on.
    debugged: Option<Debugged>,
}

/// A recording that is debugged, and what the client knows of it.
pub(super) struct Debugged {
    pub(super) debugger: Debugger,
    /// File of the program, if the client can open it.
    pub(super) program_file: Option<PathBuf>,
    pub(super) breakpoints: Breakpoints,
    /// Numbers of the commands that the client has seen as threads, from 1.
    pub(super) threads: BTreeMap<u64, i64>,
    /// Frames of the present stop; the id of a frame is its index plus 1.
    pub(super) frames: Vec<Frame>,
    /// Groups of flows of the present stop; the reference of a group is its index plus 1.
    pub(super) groups: Vec<Variables>,
    /// What the present stop is about: a fragment of a command, and a place in it.
    pub(super) focus: Option<Focus>,
    /// When equations are stepped through: a command, and the index of the equation among those that it evaluates in this cycle.
    pub(super) equation: Option<(CommandId, usize)>,
}

/// What a stop is about.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Focus {
    pub(super) command: CommandId,
    /// Index of the fragment in the table of the command.
    pub(super) fragment: usize,
    pub(super) place: Span,
    /// Line of the program, from 1, if it is not that of the place.
    pub(super) line: Option<u32>,
}

/// Why the debugger has stopped, for the event `stopped`.
pub(super) struct Stopped {
    pub(super) reason: &'static str,
    pub(super) text: String,
    pub(super) hits: Vec<u32>,
}

impl Stopped {
    pub(super) fn new(reason: &'static str, text: impl Into<String>) -> Stopped {
        Stopped {
            reason,
            text: text.into(),
            hits: Vec::new(),
        }
    }
}

/// What follows the response to a request.
enum After {
    Nothing,
    /// The debugger is ready for breakpoints.
    Initialized,
    Stopped(Stopped),
    End,
}

impl<'a, W: Write> Session<'a, W> {
    pub(crate) fn new(output: W, launch: Launch<'a>, interrupt: Arc<AtomicUsize>) -> Self {
        Session {
            client: Client::new(output),
            launch,
            interrupt,
            stops_on_entry: true,
            debugged: None,
        }
    }

    /// Handles a request. Returns false if the client is gone.
    pub(crate) fn handle(&mut self, request: &Value) -> io::Result<bool> {
        let command = request["command"].as_str().unwrap_or_default();
        if command == "pause" {
            self.interrupt.fetch_sub(1, Ordering::Relaxed);
        }
        let (answer, after) = match self.dispatch(command, &request["arguments"]) {
            Ok((body, after)) => (Ok(body), after),
            Err(message) => (Err(message), After::Nothing),
        };
        self.client.respond(request, answer)?;
        match after {
            After::Nothing => {}
            After::Initialized => self.client.event("initialized", json!({}))?,
            After::Stopped(stopped) => self.report(&stopped)?,
            After::End => {
                self.client.event("terminated", json!({}))?;
                return Ok(command != "disconnect");
            }
        }
        Ok(true)
    }

    fn dispatch(&mut self, command: &str, arguments: &Value) -> Result<(Value, After), String> {
        match command {
            "initialize" => return Ok((capabilities(), After::Nothing)),
            "launch" | "attach" => {
                self.open(arguments)?;
                return Ok((Value::Null, After::Initialized));
            }
            "disconnect" | "terminate" => return Ok((Value::Null, After::End)),
            "configurationDone" if !self.stops_on_entry => {
                let stopped = self.debugged()?.run(true)?;
                return Ok((Value::Null, After::Stopped(stopped)));
            }
            "configurationDone" => {
                let entry = Stopped::new("entry", "the first cycle of a command");
                return Ok((Value::Null, After::Stopped(entry)));
            }
            // A search that was interrupted has reported its stop.
            "pause" => return Ok((Value::Null, After::Nothing)),
            _ => {}
        }
        let debugged = self.debugged()?;
        if let Some(stopped) = debugged.movement(command, arguments) {
            return stopped.map(|stopped| (moved(command), After::Stopped(stopped)));
        }
        debugged
            .question(command, arguments)
            .map(|body| (body, After::Nothing))
    }

    fn debugged(&mut self) -> Result<&mut Debugged, String> {
        self.debugged
            .as_mut()
            .ok_or_else(|| "nothing is debugged: the request `launch` comes first".to_owned())
    }

    /// Opens the recording that the arguments of `launch` name, or makes one.
    fn open(&mut self, arguments: &Value) -> Result<(), String> {
        let path = match arguments["recording"].as_str() {
            Some(path) => PathBuf::from(path),
            None => (self.launch)(arguments)?,
        };
        let named = arguments["program"].as_str().map(PathBuf::from);
        let recording = Recording::open(&path);
        let recording = recording.map_err(|e| format!("{}: {e}", path.display()))?;
        let program = RecordedProgram::new(&recording, named.as_deref());
        let program = program.map_err(|e| e.to_string())?;
        let program_file = named.or_else(|| file_of(&program));
        let mut debugger = Debugger::new(recording, program).map_err(|e| e.to_string())?;
        debugger.interrupt_by(Arc::clone(&self.interrupt));
        self.stops_on_entry = arguments["stopOnEntry"].as_bool().unwrap_or(true);
        self.debugged = Some(Debugged {
            debugger,
            program_file,
            breakpoints: Breakpoints::default(),
            threads: BTreeMap::new(),
            frames: Vec::new(),
            groups: Vec::new(),
            focus: None,
            equation: None,
        });
        Ok(())
    }

    fn report(&mut self, stopped: &Stopped) -> io::Result<()> {
        let Some(debugged) = &mut self.debugged else {
            return Ok(());
        };
        debugged.frames.clear();
        debugged.groups.clear();
        let body = json!({
            "reason": stopped.reason,
            "description": stopped.text,
            "text": stopped.text,
            "threadId": debugged.first_thread(),
            "allThreadsStopped": true,
            "hitBreakpointIds": stopped.hits,
        });
        self.client.event("stopped", body)
    }
}

impl Session<'_, Vec<u8>> {
    /// Returns the messages to a client in the same process, which are then forgotten.
    pub(crate) fn take_messages(&mut self) -> Vec<Value> {
        let bytes = std::mem::take(self.client.output());
        let mut input = &bytes[..];
        let bodies = std::iter::from_fn(|| read_message(&mut input).ok().flatten());
        bodies
            .filter_map(|body| serde_json::from_slice(&body).ok())
            .collect()
    }
}

impl Debugged {
    /// Answers a request that moves nothing.
    fn question(&mut self, command: &str, arguments: &Value) -> Answer {
        match command {
            "setBreakpoints" => self.set_line_breakpoints(arguments),
            "setFunctionBreakpoints" => Ok(self.set_flow_breakpoints(arguments)),
            "setDataBreakpoints" => Ok(self.set_data_breakpoints(arguments)),
            "dataBreakpointInfo" => Ok(self.data_breakpoint_info(arguments)),
            "setExceptionBreakpoints" => Ok(Value::Null),
            "threads" => Ok(self.threads()),
            "stackTrace" => self.stack_trace(arguments),
            "scopes" => self.scopes(arguments),
            "variables" => self.variables(arguments),
            "evaluate" => self.evaluate(arguments),
            "source" => self.sources().text(arguments),
            "loadedSources" => Ok(self.sources().all()),
            "rpi/program" => Ok(self.sources().program()),
            _ => Err(format!("the request `{command}` is not supported")),
        }
    }
}

/// Returns the body of the response to a request that moves.
fn moved(command: &str) -> Value {
    match command {
        "continue" => json!({ "allThreadsContinued": true }),
        _ => Value::Null,
    }
}

/// Returns the file of a recorded program if it is where it was when it was recorded, with the same text.
fn file_of(program: &RecordedProgram) -> Option<PathBuf> {
    let path: &Path = program.path();
    let now = rpi_driver::read(path).ok()?;
    let is_same = now.text().ok() == program.text().ok();
    is_same.then(|| path.canonicalize().ok()).flatten()
}
