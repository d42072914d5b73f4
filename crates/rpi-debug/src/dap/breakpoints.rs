//! Breakpoints of the client as triggers of the debugger.

use rpi_diag::{FileId, Span};
use rpi_image::{Scalar, Type};
use rpi_syntax::Dialect;
use serde_json::{Value, json};

use super::messages::Answer;
use super::session::Debugged;
use super::sources::Sources;
use crate::breakpoint::{Breakpoint, Trigger};
use crate::debugger::{Debugger, ExpressionId};
use crate::flow_table::FlowTable;
use crate::insertion::insertion_point;

/// Type of conditions.
const BOOL: Type = Type::Scalar(Scalar::Bool);

/// Breakpoints by the request that has set them. A later request of the same kind replaces them.
#[derive(Default)]
pub(super) struct Breakpoints {
    lines: Vec<LineBreakpoint>,
    flows: Vec<PathBreakpoint>,
    data: Vec<PathBreakpoint>,
    /// The triggers of all of them in the present tables.
    triggers: Vec<Breakpoint>,
    last_id: u32,
}

/// Breakpoint on a line of the program.
struct LineBreakpoint {
    id: u32,
    line: u32,
    condition: Option<ExpressionId>,
}

/// Breakpoint on a flow, by its path from the command.
struct PathBreakpoint {
    id: u32,
    path: String,
}

impl Breakpoints {
    /// Returns the triggers of all breakpoints.
    pub(super) fn all(&self) -> Vec<Breakpoint> {
        self.triggers.clone()
    }

    /// Drops the breakpoints with conditions.
    pub(super) fn drop_conditions(&mut self) {
        self.lines
            .retain(|breakpoint| breakpoint.condition.is_none());
    }

    /// Says in the answer about a breakpoint whether it can be reached.
    fn verify(&self, answer: &mut Value) {
        let Some(id) = answer["id"].as_u64() else {
            return;
        };
        let mut triggers = self.triggers.iter();
        let is_there = triggers.any(|breakpoint| u64::from(breakpoint.id) == id);
        answer["verified"] = json!(is_there);
        if !is_there {
            answer["message"] = json!("no command of the recording has a flow here");
        }
    }

    fn new_id(&mut self) -> u32 {
        self.last_id += 1;
        self.last_id
    }
}

impl Debugged {
    /// Sets the breakpoints on lines of a source. With a condition, a run stops where it becomes true; without one, where the equation
    /// of the line begins to be evaluated.
    pub(super) fn set_line_breakpoints(&mut self, arguments: &Value) -> Answer {
        let requested = arguments["breakpoints"].as_array().map_or(&[][..], |b| b);
        if !self.sources().is_program(&arguments["source"]) {
            let refused = json!({
                "verified": false,
                "message": "breakpoints can be set in the program, not in the library or other files",
            });
            return Ok(json!({ "breakpoints": vec![refused; requested.len()] }));
        }
        self.breakpoints.lines.clear();
        let mut answers = Vec::new();
        for breakpoint in requested {
            answers.push(self.add_line_breakpoint(breakpoint)?);
        }
        self.resolve_breakpoints();
        for answer in &mut answers {
            self.breakpoints.verify(answer);
        }
        Ok(json!({ "breakpoints": answers }))
    }

    fn add_line_breakpoint(&mut self, requested: &Value) -> Answer {
        let line = requested["line"]
            .as_u64()
            .and_then(|line| u32::try_from(line).ok());
        let line = line.ok_or_else(|| "a breakpoint has no line".to_owned())?;
        let condition = requested["condition"].as_str().map(str::trim);
        let condition = match condition.filter(|condition| !condition.is_empty()) {
            None => None,
            Some(text) => match self.add_condition(line, text) {
                Ok(id) => Some(id),
                Err(message) => {
                    return Ok(json!({ "verified": false, "line": line, "message": message }));
                }
            },
        };
        let id = self.breakpoints.new_id();
        let breakpoint = LineBreakpoint {
            id,
            line,
            condition,
        };
        self.breakpoints.lines.push(breakpoint);
        Ok(json!({ "id": id, "line": line }))
    }

    /// Adds the condition of a breakpoint to the program. The error is that of the condition.
    fn add_condition(&mut self, line: u32, text: &str) -> Result<ExpressionId, String> {
        let id = match self.debugger.add_expression(line, text) {
            Ok(id) => id,
            Err(error) => return Err(error.to_string()),
        };
        let tables = self.debugger.tables().iter().enumerate();
        let mut types = tables.flat_map(|(k, table)| {
            let flows = self.debugger.flows_of(id, k);
            flows.map(|flow| table.flows[flow].ty)
        });
        match types.next() {
            Some(ty) if ty != BOOL => Err(format!(
                "a condition must be of type bool, this one is of type {ty}"
            )),
            _ => Ok(id),
        }
    }

    /// Sets breakpoints on flows by their names: a run stops where a Boolean flow becomes true, or another one present.
    pub(super) fn set_flow_breakpoints(&mut self, arguments: &Value) -> Value {
        self.breakpoints.flows.clear();
        let names = arguments["breakpoints"].as_array().into_iter().flatten();
        let mut answers = Vec::new();
        for name in names.filter_map(|breakpoint| breakpoint["name"].as_str()) {
            let id = self.breakpoints.new_id();
            let path = name.trim().to_owned();
            self.breakpoints.flows.push(PathBreakpoint { id, path });
            answers.push(json!({ "id": id }));
        }
        self.resolved(answers)
    }

    /// Sets breakpoints on flows: a run stops where the value changes.
    pub(super) fn set_data_breakpoints(&mut self, arguments: &Value) -> Value {
        self.breakpoints.data.clear();
        let names = arguments["breakpoints"].as_array().into_iter().flatten();
        let mut answers = Vec::new();
        for path in names.filter_map(|breakpoint| breakpoint["dataId"].as_str()) {
            let id = self.breakpoints.new_id();
            let path = path.to_owned();
            self.breakpoints.data.push(PathBreakpoint { id, path });
            answers.push(json!({ "id": id }));
        }
        self.resolved(answers)
    }

    fn resolved(&mut self, mut answers: Vec<Value>) -> Value {
        self.resolve_breakpoints();
        for answer in &mut answers {
            self.breakpoints.verify(answer);
        }
        json!({ "breakpoints": answers })
    }

    /// Answers which flow a variable is, for a breakpoint on its changes.
    pub(super) fn data_breakpoint_info(&self, arguments: &Value) -> Value {
        let name = arguments["name"].as_str().unwrap_or_default();
        let group = self.group(&arguments["variablesReference"]);
        let in_group = group.and_then(|group| {
            let table = &self.debugger.tables()[self.debugger.stop().commands[group.command].table];
            let path = group.path_of(table, name);
            table
                .flows
                .iter()
                .position(|flow| flow.path == path)
                .map(|_| path)
        });
        let path = in_group.or_else(|| flow_path(self.debugger.tables(), name));
        match path {
            Some(path) => json!({
                "dataId": path,
                "description": format!("changes of {path}"),
                "accessTypes": ["write"],
                "canPersist": true,
            }),
            None => {
                json!({ "dataId": null, "description": format!("`{name}` is not a single flow") })
            }
        }
    }

    /// Finds the triggers of all breakpoints in the present tables, which change when expressions are added.
    pub(super) fn resolve_breakpoints(&mut self) {
        let triggers = self.breakpoints.resolve(&self.debugger, &self.sources());
        self.breakpoints.triggers = triggers;
    }
}

impl Breakpoints {
    /// Returns the triggers of all breakpoints.
    fn resolve(&self, debugger: &Debugger, sources: &Sources<'_>) -> Vec<Breakpoint> {
        let mut triggers = Vec::new();
        for (index, table) in debugger.tables().iter().enumerate() {
            let mut add = |id: u32, line: Option<u32>, trigger: Trigger| {
                triggers.push(Breakpoint {
                    id,
                    table: index,
                    trigger,
                    line,
                });
            };
            for breakpoint in &self.lines {
                for trigger in line_triggers(debugger, sources, breakpoint, (index, table)) {
                    add(breakpoint.id, Some(breakpoint.line), trigger);
                }
            }
            let find = |path: &str| table.flows.iter().position(|flow| flow.path == path);
            for breakpoint in &self.flows {
                if let Some(flow) = find(&breakpoint.path) {
                    let is_bool = table.flows[flow].ty == BOOL;
                    let trigger = if is_bool {
                        Trigger::BecomesTrue
                    } else {
                        Trigger::Appears
                    };
                    add(breakpoint.id, None, trigger(flow));
                }
            }
            for breakpoint in &self.data {
                if let Some(flow) = find(&breakpoint.path) {
                    add(breakpoint.id, None, Trigger::Changes(flow));
                }
            }
        }
        triggers
    }
}

/// Returns the triggers of a breakpoint on a line in the table of a command.
fn line_triggers(
    debugger: &Debugger,
    sources: &Sources<'_>,
    breakpoint: &LineBreakpoint,
    (index, table): (usize, &FlowTable),
) -> Vec<Trigger> {
    if let Some(id) = breakpoint.condition {
        let flows = debugger.flows_of(id, index);
        return flows.map(Trigger::BecomesTrue).collect();
    }
    let Some(file) = sources.program_id() else {
        return Vec::new();
    };
    let texts = &debugger.compiled().sources;
    let flows = table.flows.iter().enumerate();
    let on_line = flows.filter(|(_, flow)| {
        let is_here = !flow.span.is_none() && flow.span.file == file;
        is_here
            && !Debugger::is_added(&flow.path)
            && texts.line_col(flow.span).line == breakpoint.line
    });
    let triggers: Vec<Trigger> = on_line.map(|(k, _)| Trigger::Appears(k)).collect();
    if !triggers.is_empty() {
        return triggers;
    }
    let fragment = body_at(debugger, file, breakpoint.line, table);
    fragment.map(Trigger::Activated).into_iter().collect()
}

/// Returns the fragment whose body is around a line.
fn body_at(debugger: &Debugger, file: FileId, line: u32, table: &FlowTable) -> Option<usize> {
    let text = debugger.compiled().sources.text(file);
    let dialect = Dialect::from_path(&debugger.program().path().to_string_lossy());
    let at = u32::try_from(insertion_point(text, dialect, line)?).ok()?;
    table.fragment_at(Span {
        file,
        start: at,
        end: at,
    })
}

/// Returns the path of a flow of some command if there is one.
fn flow_path(tables: &[FlowTable], path: &str) -> Option<String> {
    let mut flows = tables.iter().flat_map(|table| &table.flows);
    let is_there = flows.any(|flow| flow.path == path);
    is_there.then(|| path.to_owned())
}
