//! The debugger in a terminal: lines of commands, which are requests of the Debug Adapter Protocol.

use std::collections::VecDeque;
use std::io::{BufRead, Write};
use std::sync::{Arc, atomic::AtomicUsize};

use serde_json::{Value, json};

use crate::dap::{Launch, Session};

/// Commands, for `help`.
const HELP: &str = "\
n, next [N]            next cycle, or N cycles
b, back [N]            previous cycle, or N cycles
s, step                next equation of the cycle
c, continue            to the next breakpoint
r, reverse             back to the previous breakpoint
o, out                 to the end of the command
break LINE [if COND]   stop where the equation of a line begins to be evaluated, or where the condition becomes true
watch FLOW             stop where the value of a flow changes; FLOW begins with the command
on FLOW                stop where a Boolean flow becomes true
delete                 delete all breakpoints
p, print EXPRESSION    value of an expression in the innermost fragment
f, flows [GROUP]       values of all flows of the active fragments, or of a group of flows
w, where               commands and active fragments
q, quit                end
An empty line repeats the last command.
";

/// What is written before each line of the user.
const PROMPT: &str = "(rpi) ";

/// A line that is no command, or a request that failed.
type LineError = String;

/// Debugs a recording by lines of commands. `launch` runs a program, and has the arguments of the request `launch`.
///
/// # Errors
/// Returns an error if the recording cannot be debugged, or the output cannot be written.
pub fn terminal(
    input: impl BufRead,
    output: &mut impl Write,
    (launch, arguments): (Launch<'_>, Value),
    is_terminal: bool,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut terminal = Terminal {
        session: Session::new(Vec::new(), launch, Arc::new(AtomicUsize::new(0))),
        events: VecDeque::new(),
        lines: Vec::new(),
        flows: Vec::new(),
        data: Vec::new(),
        thread: 0,
    };
    terminal.request("launch", arguments)?;
    terminal.request("configurationDone", json!({}))?;
    terminal.show_stop(output)?;
    let mut last = String::new();
    let mut lines = input.lines();
    loop {
        if is_terminal {
            write!(output, "{PROMPT}")?;
            output.flush()?;
        }
        let Some(line) = lines.next().transpose()? else {
            return Ok(());
        };
        if !is_terminal {
            // What comes from a file is shown, so that the output can be read.
            writeln!(output, "{PROMPT}{line}")?;
        }
        if !line.trim().is_empty() {
            last = line;
        }
        match terminal.line(last.trim(), output) {
            Ok(true) => {}
            Ok(false) => return Ok(()),
            Err(error) => writeln!(output, "{error}")?,
        }
    }
}

/// Client of a session in the same process.
struct Terminal<'a> {
    session: Session<'a, Vec<u8>>,
    events: VecDeque<Value>,
    /// Breakpoints as they are set: all of a kind are sent again when one is added.
    lines: Vec<Value>,
    flows: Vec<Value>,
    data: Vec<Value>,
    thread: i64,
}

impl Terminal<'_> {
    /// Carries out a line. Returns false at the end.
    fn line(&mut self, line: &str, output: &mut impl Write) -> Result<bool, LineError> {
        let (command, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        let text = match command {
            "" => String::new(),
            "q" | "quit" => return Ok(false),
            "h" | "help" => HELP.to_owned(),
            "p" | "print" => self.print(rest)?,
            "f" | "flows" => self.show_flows(rest)?,
            "w" | "where" => self.stack()?,
            "break" | "watch" | "on" | "delete" => self.change_breakpoints(command, rest)?,
            _ => {
                self.movement(command, rest)?;
                return self.show_stop(output).map(|()| true);
            }
        };
        write!(output, "{text}").map_err(|error| error.to_string())?;
        Ok(true)
    }

    fn movement(&mut self, command: &str, rest: &str) -> Result<(), LineError> {
        let request = match command {
            "n" | "next" | "b" | "back" => "rpi/move",
            "s" | "step" => "stepIn",
            "c" | "continue" => "continue",
            "r" | "reverse" => "reverseContinue",
            "o" | "out" => "stepOut",
            _ => return Err(format!("`{command}` is not a command; `help` lists them")),
        };
        let times: u32 = match rest {
            "" => 1,
            _ => rest
                .parse()
                .map_err(|_| format!("`{rest}` is not a number"))?,
        };
        if request == "rpi/move" {
            let forwards = matches!(command, "n" | "next");
            let ticks = if forwards {
                i64::from(times)
            } else {
                -i64::from(times)
            };
            self.request(request, json!({ "ticks": ticks }))?;
            return Ok(());
        }
        for _ in 0..times {
            self.request(request, json!({ "threadId": self.thread }))?;
        }
        Ok(())
    }

    fn change_breakpoints(&mut self, command: &str, rest: &str) -> Result<String, LineError> {
        match command {
            "break" => {
                let usage = "write `break LINE`, or `break LINE if CONDITION`";
                let (line, condition) = rest.split_once(" if ").unwrap_or((rest, ""));
                let line: u32 = line.trim().parse().map_err(|_| usage)?;
                let breakpoint = json!({ "line": line, "condition": condition });
                self.lines.push(breakpoint);
            }
            "watch" => {
                let info = self.request("dataBreakpointInfo", json!({ "name": rest }))?;
                let id = info["dataId"].as_str();
                let reason = || info["description"].as_str().unwrap_or_default().to_owned();
                let id = id.ok_or_else(reason)?;
                self.data.push(json!({ "dataId": id }));
            }
            "on" => self.flows.push(json!({ "name": rest })),
            _ => {
                self.lines.clear();
                self.flows.clear();
                self.data.clear();
            }
        }
        self.send_breakpoints()
    }

    /// Sets all breakpoints again. Those that are refused are dropped, and their messages returned as an error.
    fn send_breakpoints(&mut self) -> Result<String, LineError> {
        let source = self.request("rpi/program", json!({}))?;
        let mut refused = Vec::new();
        for kind in [
            "setBreakpoints",
            "setFunctionBreakpoints",
            "setDataBreakpoints",
        ] {
            let list = std::mem::take(self.breakpoints(kind));
            let answer = self.request(kind, json!({ "source": source, "breakpoints": list }))?;
            let answers = answer["breakpoints"]
                .as_array()
                .cloned()
                .unwrap_or_default();
            for (breakpoint, answer) in list.into_iter().zip(answers) {
                match answer["verified"] == true {
                    true => self.breakpoints(kind).push(breakpoint),
                    false => refused.extend(answer["message"].as_str().map(str::to_owned)),
                }
            }
        }
        match refused.is_empty() {
            true => Ok(String::new()),
            false => Err(refused.join("\n")),
        }
    }

    /// Returns the breakpoints that a request sets.
    fn breakpoints(&mut self, request: &str) -> &mut Vec<Value> {
        match request {
            "setBreakpoints" => &mut self.lines,
            "setFunctionBreakpoints" => &mut self.flows,
            _ => &mut self.data,
        }
    }

    /// Evaluates an expression in the innermost frame in which it has a value.
    fn print(&mut self, expression: &str) -> Result<String, LineError> {
        let frames = self.frames()?;
        let mut answer = Err("no command runs in this tick".to_owned());
        for frame in frames.as_array().into_iter().flatten() {
            let id = &frame["id"];
            let arguments = json!({ "expression": expression, "frameId": id, "context": "repl" });
            answer = self.request("evaluate", arguments);
            if answer.is_ok() {
                break;
            }
        }
        let answer = answer?;
        match answer["variablesReference"].as_u64() {
            Some(group) if group > 0 => self.group(group),
            _ => {
                let value = answer["result"].as_str();
                Ok(format!("{}\n", value.unwrap_or_default()))
            }
        }
    }

    fn show_flows(&mut self, group: &str) -> Result<String, LineError> {
        if !group.is_empty() {
            return self.print(group);
        }
        let mut text = String::new();
        for frame in self.frames()?.as_array().into_iter().flatten() {
            let scopes = self.request("scopes", json!({ "frameId": frame["id"] }))?;
            if let Some(reference) = scopes["scopes"][0]["variablesReference"].as_u64() {
                let name = frame["name"].as_str().unwrap_or_default();
                text.push_str(&format!("{name}\n{}", self.group(reference)?));
            }
        }
        Ok(text)
    }

    /// Returns the values of a group of flows, a line each.
    fn group(&mut self, reference: u64) -> Result<String, LineError> {
        let answer = self.request("variables", json!({ "variablesReference": reference }))?;
        let variables = answer["variables"].as_array().cloned().unwrap_or_default();
        let line = |variable: &Value| {
            let text = |key: &str| variable[key].as_str().unwrap_or_default().to_owned();
            format!("  {} = {}\n", text("name"), text("value"))
        };
        Ok(variables.iter().map(line).collect())
    }

    fn frames(&mut self) -> Result<Value, LineError> {
        let answer = self.request("stackTrace", json!({ "threadId": self.thread }))?;
        Ok(answer["stackFrames"].clone())
    }

    /// Returns the commands that run and the frames of the present one, a line each.
    fn stack(&mut self) -> Result<String, LineError> {
        let threads = self.request("threads", json!({}))?;
        let threads = threads["threads"].as_array().cloned().unwrap_or_default();
        let mut text = String::new();
        for thread in threads {
            let mark = if thread["id"] == self.thread {
                '*'
            } else {
                ' '
            };
            text.push_str(&format!(
                "{mark} {}\n",
                thread["name"].as_str().unwrap_or_default()
            ));
            if thread["id"] != self.thread {
                continue;
            }
            for frame in self.frames()?.as_array().into_iter().flatten() {
                let name = frame["name"].as_str().unwrap_or_default();
                let file = frame["source"]["name"].as_str().unwrap_or_default();
                text.push_str(&format!("    {name}  {file}:{}\n", frame["line"]));
            }
        }
        Ok(text)
    }

    /// Shows where the debugger has stopped, with the line of the program.
    fn show_stop(&mut self, output: &mut impl Write) -> Result<(), LineError> {
        let mut stopped = None;
        while let Some(event) = self.events.pop_front() {
            if event["event"] == "stopped" {
                stopped = Some(event["body"].clone());
            }
        }
        let Some(stopped) = stopped else {
            return Ok(());
        };
        self.thread = stopped["threadId"].as_i64().unwrap_or(0);
        let text = stopped["text"].as_str().unwrap_or_default();
        let frames = self.frames()?;
        let frame = &frames[0];
        let name = frame["name"].as_str().unwrap_or_default();
        let line = self.source_line(frame)?;
        writeln!(output, "{text}: {name}\n{line}").map_err(|error| error.to_string())
    }

    /// Returns the line of the program at which a frame is, with its number.
    fn source_line(&mut self, frame: &Value) -> Result<String, LineError> {
        let source = &frame["source"];
        let text = match (source["path"].as_str(), source["sourceReference"].as_u64()) {
            (Some(path), _) => rpi_driver::read(path.as_ref())
                .ok()
                .and_then(|input| input.text().ok().map(str::to_owned)),
            (None, Some(reference)) => {
                let answer = self.request("source", json!({ "sourceReference": reference }))?;
                answer["content"].as_str().map(str::to_owned)
            }
            (None, None) => None,
        };
        let number = frame["line"]
            .as_u64()
            .and_then(|line| usize::try_from(line).ok());
        let line = number.and_then(|number| {
            let text = text.as_deref()?;
            text.lines().nth(number.checked_sub(1)?)
        });
        Ok(match (number, line) {
            (Some(number), Some(line)) => format!("{number:>5} | {line}"),
            _ => String::new(),
        })
    }

    /// Makes a request of the session and returns the body of its response.
    fn request(&mut self, command: &str, arguments: Value) -> Result<Value, LineError> {
        let request = json!({ "type": "request", "command": command, "arguments": arguments });
        self.session
            .handle(&request)
            .map_err(|error| error.to_string())?;
        let mut response = Value::Null;
        for message in self.session.take_messages() {
            match message["type"] == "response" {
                true => response = message,
                false => self.events.push_back(message),
            }
        }
        match response["success"] == true {
            true => Ok(response["body"].take()),
            false => Err(response["message"].as_str().unwrap_or_default().to_owned()),
        }
    }
}
