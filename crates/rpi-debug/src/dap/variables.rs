//! Flows as variables, and expressions.

use serde_json::{Value, json};

use super::frames::Frame;
use super::messages::Answer;
use super::session::Debugged;
use crate::flow_table::FlowTable;
use crate::stop::RunningCommand;

/// Maximum number of variables in one answer. Further ones are left out.
const MAX_VARIABLES: usize = 5_000;

/// Maximum length in bytes of the text of a group of values. Further values are left out.
const MAX_TEXT: usize = 160;

/// Flows whose names begin alike: all of a fragment, or the parts of a value or call.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Variables {
    /// Index of the command in the present stop.
    pub(super) command: usize,
    /// Index of the fragment in the table of the command.
    fragment: usize,
    /// First part of the names of the flows in the fragment; empty for all.
    prefix: String,
}

impl Variables {
    /// Returns the path of the flow that the group shows under a name.
    pub(super) fn path_of(&self, table: &FlowTable, name: &str) -> String {
        let fragment = &table.fragments[self.fragment].path;
        match (self.prefix.as_str(), name.starts_with('[')) {
            ("", _) => format!("{fragment}.{name}"),
            (prefix, true) => format!("{fragment}.{prefix}{name}"),
            (prefix, false) => format!("{fragment}.{prefix}.{name}"),
        }
    }
}

impl Debugged {
    /// Returns the group with this reference.
    pub(super) fn group(&self, reference: &Value) -> Option<&Variables> {
        let index = usize::try_from(reference.as_u64()?).ok()?.checked_sub(1)?;
        self.groups.get(index)
    }

    fn add_group(&mut self, group: Variables) -> usize {
        let known = self.groups.iter().position(|known| *known == group);
        let index = known.unwrap_or_else(|| {
            self.groups.push(group);
            self.groups.len() - 1
        });
        index + 1
    }

    pub(super) fn scopes(&mut self, arguments: &Value) -> Answer {
        let Some(frame) = self.frame(&arguments["frameId"]) else {
            return Ok(json!({ "scopes": [] }));
        };
        let reference = self.add_group(Variables {
            command: frame.command,
            fragment: frame.fragment,
            prefix: String::new(),
        });
        let scope = json!({
            "name": "Flows",
            "presentationHint": "locals",
            "variablesReference": reference,
            "expensive": false,
        });
        Ok(json!({ "scopes": [scope] }))
    }

    pub(super) fn variables(&mut self, arguments: &Value) -> Answer {
        let group = self.group(&arguments["variablesReference"]).cloned();
        let group =
            group.ok_or_else(|| "these variables are those of an earlier stop".to_owned())?;
        let last = self.present_equation(self.debugger.stop().commands[group.command].id);
        let mut variables = Vec::new();
        for (name, flows) in self.members(&group).into_iter().take(MAX_VARIABLES) {
            variables.push(self.variable(&group, &name, (&flows, last)));
        }
        Ok(json!({ "variables": variables }))
    }

    /// Returns the members of a group in the order of the program: each with its name, and the flows that it consists of.
    fn members(&self, group: &Variables) -> Vec<(String, Vec<usize>)> {
        let command = &self.debugger.stop().commands[group.command];
        let table = &self.debugger.tables()[command.table];
        let mut flows: Vec<usize> = (0..table.flows.len()).collect();
        flows.sort_by_key(|k| (table.flows[*k].span.start, *k));
        let mut members: Vec<(String, Vec<usize>)> = Vec::new();
        for k in flows {
            let flow = &table.flows[k];
            if flow.fragment != group.fragment || crate::Debugger::is_added(&flow.path) {
                continue;
            }
            let Some(name) = member_name(table.short_name(flow), &group.prefix) else {
                continue;
            };
            match members.iter_mut().find(|(known, _)| known == name) {
                Some((_, flows)) => flows.push(k),
                None => members.push((name.to_owned(), vec![k])),
            }
        }
        members
    }

    /// Returns a member of a group, which consists of `flows`. `last` is the flow of the present equation.
    fn variable(
        &mut self,
        group: &Variables,
        name: &str,
        (flows, last): (&[usize], Option<usize>),
    ) -> Value {
        let command = &self.debugger.stop().commands[group.command];
        let table = &self.debugger.tables()[command.table];
        let path = group.path_of(table, name);
        if let [only] = flows
            && table.flows[*only].path == path
        {
            return json!({
                "name": name,
                "value": value_text(command, table, *only, last),
                "type": table.flows[*only].ty.to_string(),
                "evaluateName": path,
                "variablesReference": 0,
            });
        }
        let text = group_text(command, table, flows, last);
        let inner = path[table.fragments[group.fragment].path.len() + 1..].to_owned();
        let reference = self.add_group(Variables {
            prefix: inner,
            ..group.clone()
        });
        json!({
            "name": name,
            "value": text,
            "evaluateName": path,
            "variablesReference": reference,
        })
    }

    /// Evaluates an expression of the language with the equations of a frame. A name is looked up; anything else is compiled with the
    /// program.
    pub(super) fn evaluate(&mut self, arguments: &Value) -> Answer {
        let expression = arguments["expression"].as_str().unwrap_or_default().trim();
        let first = self.debugger.stop().commands.first();
        let default = first.map(|_| Frame {
            command: 0,
            fragment: 0,
        });
        let frame = self.frame(&arguments["frameId"]).or(default);
        let frame = frame.ok_or_else(|| "no command runs in this tick".to_owned())?;
        if let Some(value) = self.look_up(frame, expression) {
            return Ok(value);
        }
        if arguments["context"] == "hover" {
            return Err(format!("`{expression}` is not a flow here"));
        }
        self.evaluate_compiled(frame, expression)
    }

    /// Returns the value of a flow, or of a group of flows.
    fn look_up(&mut self, frame: Frame, name: &str) -> Option<Value> {
        let command = &self.debugger.stop().commands[frame.command];
        let table = &self.debugger.tables()[command.table];
        let flow = table.find(frame.fragment, name);
        let flow = flow.or_else(|| only_active(command, table, name));
        if let Some(flow) = flow {
            return Some(json!({
                "result": value_text(command, table, flow, self.present_equation(command.id)),
                "type": table.flows[flow].ty.to_string(),
                "variablesReference": 0,
            }));
        }
        let group = Variables {
            command: frame.command,
            fragment: frame.fragment,
            prefix: name.to_owned(),
        };
        if name.is_empty() || self.members(&group).is_empty() {
            return None;
        }
        let reference = self.add_group(group);
        Some(json!({ "result": name, "variablesReference": reference }))
    }

    fn evaluate_compiled(&mut self, frame: Frame, expression: &str) -> Answer {
        let command = &self.debugger.stop().commands[frame.command];
        let (id, table_index) = (command.id, command.table);
        let line = self.line_of(frame)?;
        let added = self.debugger.add_expression(line, expression);
        let added = added.map_err(|e| e.to_string())?;
        // The tables are those of the program with the expression; frames and groups stay the same.
        self.resolve_breakpoints();
        let stop = self.debugger.stop();
        let command = stop.commands.iter().find(|command| command.id == id);
        let command = command.ok_or_else(|| "the command has ended".to_owned())?;
        let table = &self.debugger.tables()[table_index];
        let all: Vec<usize> = self.debugger.flows_of(added, table_index).collect();
        // A node that is called several times has the expression in each call: that of the frame counts.
        let around = format!("{}.", table.fragments[frame.fragment].path);
        let own = all.iter().copied();
        let own = own.filter(|flow| table.flows[*flow].path.starts_with(&around));
        let mut flows: Vec<usize> = own.collect();
        if flows.is_empty() {
            flows = all;
        }
        let values = flows.iter().map(|flow| command.text(table, *flow));
        let values: Vec<String> = values.collect();
        Ok(match (&flows[..], &values[..]) {
            ([flow], [value]) => {
                let ty = table.flows[*flow].ty.to_string();
                json!({ "result": value, "type": ty, "variablesReference": 0 })
            }
            _ => json!({ "result": format!("({})", values.join(", ")), "variablesReference": 0 }),
        })
    }

    /// Returns the line of the program with whose equations an expression of a frame is evaluated: that of its fragment, or of the
    /// nearest one around it that is in the program.
    fn line_of(&self, frame: Frame) -> Result<u32, String> {
        let command = &self.debugger.stop().commands[frame.command];
        let table = &self.debugger.tables()[command.table];
        let program = self.sources().program_id();
        let inner = &table.fragments[frame.fragment].path;
        let around = table.fragments.iter().filter(|fragment| {
            let rest = inner.strip_prefix(&fragment.path);
            let is_around = rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
            is_around && !fragment.span.is_none() && Some(fragment.span.file) == program
        });
        let nearest = around.max_by_key(|fragment| fragment.depth);
        let place = nearest.and_then(|fragment| self.sources().place(fragment.span));
        let place =
            place.ok_or_else(|| "this command is not in the text of the program".to_owned())?;
        Ok(place.1)
    }
}

/// Returns the first values of a group of flows as one text.
fn group_text(
    command: &RunningCommand,
    table: &FlowTable,
    flows: &[usize],
    last: Option<usize>,
) -> String {
    let mut text = String::new();
    for (k, flow) in flows.iter().enumerate() {
        let value = value_text(command, table, *flow, last);
        if text.len() + value.len() > MAX_TEXT {
            text.push_str(if k == 0 { "..." } else { ", ..." });
            break;
        }
        if k > 0 {
            text.push_str(", ");
        }
        text.push_str(&value);
    }
    format!("({text})")
}

/// Returns the value of a flow of a command as text. If equations are stepped through, those behind `last` have not been evaluated.
fn value_text(
    command: &RunningCommand,
    table: &FlowTable,
    flow: usize,
    last: Option<usize>,
) -> String {
    match last.is_some_and(|last| flow > last) {
        true => "not yet evaluated".to_owned(),
        false => command.text(table, flow),
    }
}

/// Returns the flow with this name in the active fragments of a command; `None` if there is none, or several.
fn only_active(command: &RunningCommand, table: &FlowTable, name: &str) -> Option<usize> {
    let flows = table.flows.iter().enumerate();
    let mut named = flows.filter(|(_, flow)| {
        let is_active = flow.fragment == 0 || command.active[flow.fragment];
        is_active && table.short_name(flow) == name
    });
    let (found, _) = named.next()?;
    named.next().is_none().then_some(found)
}

/// Returns the name under which a group with this prefix shows a flow; `None` if the flow does not belong to it.
fn member_name<'n>(flow: &'n str, prefix: &str) -> Option<&'n str> {
    let rest = match prefix.is_empty() {
        true => flow,
        false => {
            let rest = flow.strip_prefix(prefix)?;
            match rest.strip_prefix('.') {
                Some(member) => member,
                None if rest.starts_with('[') => rest,
                None => return None,
            }
        }
    };
    let end = match rest.starts_with('[') {
        true => rest.find(']').map(|k| k + 1),
        false => rest.find(['.', '[']),
    };
    Some(&rest[..end.unwrap_or(rest.len())])
}
