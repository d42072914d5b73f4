//! Commands as threads, and active fragments as stack frames.

use rpi_core::CommandId;
use serde_json::{Value, json};

use super::messages::Answer;
use super::session::{Debugged, Focus};
use crate::flow_table::FlowTable;

/// Number of the thread that stands for a tick without commands.
const IDLE: i64 = 1 << 40;

/// Source and line, from 1, at which a frame is shown; `None` if it has none.
type SourceLine = Option<(Value, u32)>;

/// Stack frame: a command, or one of its active fragments.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Frame {
    /// Index of the command in the present stop.
    pub(super) command: usize,
    /// Index of the fragment in the table of the command.
    pub(super) fragment: usize,
}

impl Debugged {
    /// Returns the number of the thread that the client is to show first.
    pub(super) fn first_thread(&mut self) -> i64 {
        let stop = self.debugger.stop();
        let stepped = self.equation.map(|(id, _)| id);
        let stepped = stepped.or(self.focus.map(|focus| focus.command));
        let first = stop.commands.first().map(|command| command.id);
        stepped.or(first).map_or(IDLE, |id| self.thread_of(id))
    }

    fn thread_of(&mut self, id: CommandId) -> i64 {
        let next = i64::try_from(self.threads.len()).unwrap_or(0) + 1;
        *self.threads.entry(id.to_number()).or_insert(next)
    }

    /// Returns the command of a thread if it runs in the present cycle; the first command if there is no such thread.
    pub(super) fn command_of(&self, thread: i64) -> Option<CommandId> {
        let commands = &self.debugger.stop().commands;
        let is_it = |id: CommandId| self.threads.get(&id.to_number()) == Some(&thread);
        let found = commands.iter().find(|command| is_it(command.id));
        found.or(commands.first()).map(|command| command.id)
    }

    pub(super) fn threads(&mut self) -> Value {
        let commands = self.debugger.stop().commands.iter();
        let named: Vec<(CommandId, String)> = commands
            .map(|command| {
                let name = &self.debugger.tables()[command.table].command;
                (command.id, format!("{name}, cycle {}", command.cycle))
            })
            .collect();
        let mut threads = Vec::new();
        for (id, name) in named {
            threads.push(json!({ "id": self.thread_of(id), "name": name }));
        }
        if threads.is_empty() {
            threads.push(json!({ "id": IDLE, "name": format!("no command, {}", self.place()) }));
        }
        json!({ "threads": threads })
    }

    pub(super) fn stack_trace(&mut self, arguments: &Value) -> Answer {
        let thread = arguments["threadId"].as_i64().unwrap_or(0);
        let Some(id) = self.command_of(thread).filter(|_| thread != IDLE) else {
            let frame = json!({ "id": 0, "name": self.place(), "line": 0, "column": 0 });
            return Ok(json!({ "stackFrames": [frame], "totalFrames": 1 }));
        };
        let frames = self.frames_of(id);
        let mut shown = Vec::new();
        for (frame, place) in frames {
            self.frames.push(frame);
            shown.push(self.frame_json(frame, place, self.frames.len()));
        }
        let total = shown.len();
        Ok(json!({ "stackFrames": shown, "totalFrames": total }))
    }

    /// Returns the frames of a command, the innermost first, each with its place: the one with the present equation, then the active
    /// fragments by their depth.
    fn frames_of(&self, id: CommandId) -> Vec<(Frame, SourceLine)> {
        let commands = self.debugger.stop().commands.iter().enumerate();
        let mut frames = Vec::new();
        for (index, command) in commands.filter(|(_, command)| command.id == id) {
            let table = &self.debugger.tables()[command.table];
            let fragments = table.fragments.iter().enumerate();
            let active = fragments.filter(|(k, _)| *k == 0 || command.active[*k]);
            let mut active: Vec<(usize, usize)> = active.map(|(k, f)| (f.depth, k)).collect();
            active.sort_by_key(|(depth, k)| (std::cmp::Reverse(*depth), *k));
            let focus = self.focus_in(id, table);
            if let Some(focus) = focus {
                // The chain of fragments around what the stop is about comes first.
                let inner = &table.fragments[focus.fragment].path;
                let around = |k: usize| {
                    let rest = inner.strip_prefix(&table.fragments[k].path);
                    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
                };
                active.sort_by_key(|(depth, k)| (!around(*k), std::cmp::Reverse(*depth), *k));
            }
            for (_, fragment) in active {
                let frame = Frame {
                    command: index,
                    fragment,
                };
                let place = match focus.filter(|focus| focus.fragment == fragment) {
                    Some(Focus {
                        line: Some(line), ..
                    }) => Some((self.sources().program(), line)),
                    Some(focus) => self.sources().place(focus.place),
                    None => self.sources().place(table.fragments[fragment].span),
                };
                frames.push((frame, place));
            }
        }
        frames
    }

    /// Returns the flow of the present equation of a command; `None` if its equations are not stepped through.
    pub(super) fn present_equation(&self, id: CommandId) -> Option<usize> {
        let (_, at) = self.equation.filter(|(of, _)| *of == id)?;
        self.debugger.equations(id).get(at).copied()
    }

    /// Returns what the present stop is about in a command: the present equation, or what has stopped the run.
    fn focus_in(&self, id: CommandId, table: &FlowTable) -> Option<Focus> {
        let of_equation = self.present_equation(id).map(|flow| Focus {
            command: id,
            fragment: table.flows[flow].fragment,
            place: table.flows[flow].span,
            line: None,
        });
        of_equation.or(self.focus.filter(|focus| focus.command == id))
    }

    fn frame_json(&self, frame: Frame, place: SourceLine, id: usize) -> Value {
        let command = &self.debugger.stop().commands[frame.command];
        let table = &self.debugger.tables()[command.table];
        let mut json = json!({
            "id": id,
            "name": table.fragments[frame.fragment].path,
            "line": 0,
            "column": 0,
        });
        if let Some((source, line)) = place {
            (json["source"], json["line"], json["column"]) = (source, json!(line), json!(1));
        }
        json
    }

    /// Returns the frame with this id.
    pub(super) fn frame(&self, id: &Value) -> Option<Frame> {
        let index = usize::try_from(id.as_u64()?).ok()?.checked_sub(1)?;
        self.frames.get(index).copied()
    }
}
