//! Forwards and backwards, by cycles and by equations.

use serde_json::Value;

use super::session::{Debugged, Focus, Stopped};
use crate::breakpoint::{Breakpoint, Hit, Trigger};
use crate::error::DebugError;
use crate::flow_table::FlowTable;

impl Debugged {
    /// Carries out a request that moves; `None` for any other request.
    pub(super) fn movement(
        &mut self,
        command: &str,
        arguments: &Value,
    ) -> Option<Result<Stopped, String>> {
        let by_equation = arguments["granularity"] == "instruction";
        let thread = arguments["threadId"].as_i64().unwrap_or(0);
        let moved = match command {
            "continue" => self.run(true),
            "reverseContinue" => self.run(false),
            "next" if !by_equation => self.step_cycles(1),
            "rpi/move" => self.step_cycles(arguments["ticks"].as_i64().unwrap_or(0)),
            "next" | "stepIn" => self.step_equation(thread, true),
            "stepBack" if by_equation => self.step_equation(thread, false),
            "stepBack" => self.step_cycles(-1),
            "stepOut" => self.step_out(thread),
            _ => return None,
        };
        Some(moved)
    }

    /// Runs to a breakpoint, forwards or backwards.
    pub(super) fn run(&mut self, forwards: bool) -> Result<Stopped, String> {
        let breakpoints = self.breakpoints.all();
        self.run_to(&breakpoints, forwards)
    }

    fn run_to(&mut self, breakpoints: &[Breakpoint], forwards: bool) -> Result<Stopped, String> {
        self.equation = None;
        let debugger = &mut self.debugger;
        let hits = match forwards {
            true => debugger.run_forwards(breakpoints),
            false => debugger.run_backwards(breakpoints),
        };
        let hits = hits.map_err(|error| self.recover(&error))?;
        let first = hits.first();
        self.focus = first.and_then(|hit| focus_of(self.debugger.tables(), *hit, breakpoints));
        if hits.iter().any(|hit| hit.breakpoint.is_none()) {
            return Ok(Stopped::new("exception", self.place()));
        }
        let hits = hits.iter().filter_map(|hit| hit.breakpoint);
        let mut hits: Vec<u32> = hits.map(|index| breakpoints[index].id).collect();
        hits.dedup();
        if hits.is_empty() && self.debugger.is_interrupted() {
            return Ok(Stopped::new("pause", self.place()));
        }
        Ok(match (hits.is_empty(), forwards) {
            (false, _) => Stopped {
                hits,
                ..Stopped::new("breakpoint", self.place())
            },
            (true, true) => {
                Stopped::new("pause", format!("end of the recording, {}", self.place()))
            }
            (true, false) => {
                Stopped::new("pause", format!("start of the recording, {}", self.place()))
            }
        })
    }

    /// Goes forwards or, with a negative number, backwards by some ticks.
    fn step_cycles(&mut self, ticks: i64) -> Result<Stopped, String> {
        self.equation = None;
        self.focus = None;
        let tick = self.debugger.stop().tick;
        let to = tick.checked_add_signed(ticks);
        let is_there = self.debugger.go_to(to.unwrap_or(0));
        let is_there = is_there.map_err(|error| self.recover(&error))? && to.is_some();
        Ok(match (is_there, ticks >= 0) {
            (true, _) => Stopped::new("step", self.place()),
            (false, true) => Stopped::new("step", "end of the recording"),
            (false, false) => Stopped::new("step", "start of the recording"),
        })
    }

    /// Returns the message of an error. If the replay differs from the recording and there are expressions, they are dropped: one of
    /// them has changed the run.
    fn recover(&mut self, error: &DebugError) -> String {
        let tick = self.debugger.stop().tick;
        if !matches!(error, DebugError::Differs(_)) || !self.debugger.has_expressions() {
            return error.to_string();
        }
        let error = error.to_string();
        let error = error.lines().next().unwrap_or_default();
        let dropped = self.debugger.drop_expressions(tick);
        self.breakpoints.drop_conditions();
        self.resolve_breakpoints();
        match dropped {
            Ok(()) => format!(
                "an expression changes the run, because it faults or uses a device; all expressions and conditions were dropped: {error}"
            ),
            Err(again) => again.to_string(),
        }
    }

    /// Goes to the next or previous equation that a command evaluates, at the border of a cycle to that of the cycle beside it.
    fn step_equation(&mut self, thread: i64, forwards: bool) -> Result<Stopped, String> {
        let Some(id) = self.command_of(thread) else {
            return self.step_cycles(if forwards { 1 } else { -1 });
        };
        let at = self.equation.filter(|(of, _)| *of == id).map(|(_, at)| at);
        let count = self.debugger.equations(id).len();
        let next = match (at, forwards) {
            (None, true) => Some(0),
            (None, false) => None,
            (Some(at), true) => Some(at + 1),
            (Some(at), false) => at.checked_sub(1),
        };
        match next.filter(|next| *next < count) {
            Some(next) => {
                self.equation = Some((id, next));
                self.focus = None;
            }
            None => {
                self.step_cycles(if forwards { 1 } else { -1 })?;
                let count = self.debugger.equations(id).len();
                let border = if forwards { 0 } else { count.saturating_sub(1) };
                self.equation = (count > 0).then_some((id, border));
            }
        }
        Ok(Stopped::new("step", self.place()))
    }

    /// Goes to the end of the cycle if equations are stepped through, else to the end of the command.
    fn step_out(&mut self, thread: i64) -> Result<Stopped, String> {
        if self.equation.take().is_some() {
            return Ok(Stopped::new("step", self.place()));
        }
        let Some(id) = self.command_of(thread) else {
            return self.step_cycles(1);
        };
        let last = self.debugger.last_cycle(id).map_err(text)?;
        self.debugger.go_to(last).map_err(text)?;
        Ok(Stopped::new("step", self.place()))
    }

    /// Returns the tick and its time as text, with the faults in it.
    pub(super) fn place(&self) -> String {
        let stop = self.debugger.stop();
        let (tick, tick_ns) = (stop.tick, self.debugger.tick_ns());
        let seconds = tick as f64 * tick_ns as f64 * 1e-9;
        let mut text = format!("tick {tick}, {seconds:.3} s");
        for command in &stop.commands {
            if let Some(fault) = command.fault {
                let name = &self.debugger.tables()[command.table].command;
                text.push_str(&format!(", {name} ends with a fault: {fault}"));
            }
        }
        text
    }
}

fn text(error: DebugError) -> String {
    error.to_string()
}

/// Returns what a stop at a breakpoint is about.
fn focus_of(tables: &[FlowTable], hit: Hit, breakpoints: &[Breakpoint]) -> Option<Focus> {
    let breakpoint = &breakpoints[hit.breakpoint?];
    let table = &tables[breakpoint.table];
    let of_fragment = |fragment: usize| Focus {
        command: hit.command,
        fragment,
        place: table.fragments[fragment].span,
        line: breakpoint.line,
    };
    Some(match breakpoint.trigger {
        Trigger::Activated(fragment) => of_fragment(fragment),
        Trigger::BecomesTrue(flow) | Trigger::Appears(flow) | Trigger::Changes(flow) => {
            let flow = &table.flows[flow];
            let focus = of_fragment(flow.fragment);
            match crate::Debugger::is_added(&flow.path) {
                true => focus,
                false => Focus {
                    place: flow.span,
                    ..focus
                },
            }
        }
    })
}
