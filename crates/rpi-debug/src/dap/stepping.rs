//! Forwards and backwards, by cycles and by equations.

use rpi_core::CommandId;
use serde_json::Value;

use super::session::{Debugged, Focus, Stopped};
use crate::breakpoint::{Breakpoint, Hit, Trigger};
use crate::debugger::DebugError;

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
            "next" if !by_equation => self.step_cycle(true),
            "next" | "stepIn" => self.step_equation(thread, true),
            "stepBack" if by_equation => self.step_equation(thread, false),
            "stepBack" => self.step_cycle(false),
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
        let hits = hits.map_err(text)?;
        self.focus = hits.first().map(|hit| self.focus_of(*hit, breakpoints));
        let mut hits: Vec<u32> = hits
            .iter()
            .map(|hit| breakpoints[hit.breakpoint].id)
            .collect();
        hits.dedup();
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

    /// Returns what a stop at a breakpoint is about.
    fn focus_of(&self, hit: Hit, breakpoints: &[Breakpoint]) -> Focus {
        let breakpoint = &breakpoints[hit.breakpoint];
        let table = &self.debugger.tables()[breakpoint.table];
        let of_fragment = |fragment: usize| Focus {
            command: hit.command,
            fragment,
            place: table.fragments[fragment].span,
            line: breakpoint.line,
        };
        match breakpoint.trigger {
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
        }
    }

    fn step_cycle(&mut self, forwards: bool) -> Result<Stopped, String> {
        self.equation = None;
        self.focus = None;
        let tick = self.debugger.stop().tick;
        let is_there = match forwards {
            true => self.debugger.go_to(tick + 1).map_err(text)?,
            false if tick == 0 => false,
            false => self.debugger.go_to(tick - 1).map_err(text)?,
        };
        Ok(match (is_there, forwards) {
            (true, _) => Stopped::new("step", self.place()),
            (false, true) => Stopped::new("step", "end of the recording"),
            (false, false) => Stopped::new("step", "start of the recording"),
        })
    }

    /// Goes to the next or previous equation that a command evaluates, at the border of a cycle to that of the cycle beside it.
    fn step_equation(&mut self, thread: i64, forwards: bool) -> Result<Stopped, String> {
        let Some(id) = self.command_of(thread) else {
            return self.step_cycle(forwards);
        };
        let at = self.equation.filter(|(of, _)| *of == id).map(|(_, at)| at);
        let count = self.equations(id).len();
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
                self.step_cycle(forwards)?;
                let count = self.equations(id).len();
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
            return self.step_cycle(true);
        };
        let last = self.debugger.last_cycle(id).map_err(text)?;
        self.debugger.go_to(last).map_err(text)?;
        Ok(Stopped::new("step", self.place()))
    }

    /// Returns the indices of the flows that a command evaluates in the present cycle, in order.
    pub(super) fn equations(&self, id: CommandId) -> Vec<usize> {
        let stop = self.debugger.stop();
        let Some(command) = stop.commands.iter().find(|command| command.id == id) else {
            return Vec::new();
        };
        let table = &self.debugger.tables()[command.table];
        let evaluated = table.flows.iter().enumerate().filter(|(k, flow)| {
            let is_present = command.values[*k].is_some();
            is_present && !crate::Debugger::is_added(&flow.path) && !flow.span.is_none()
        });
        evaluated.map(|(k, _)| k).collect()
    }

    /// Returns the tick and its time as text.
    pub(super) fn place(&self) -> String {
        let tick = self.debugger.stop().tick;
        let seconds = tick as f64 * self.debugger.tick_ns() as f64 * 1e-9;
        format!("tick {tick}, {seconds:.3} s")
    }
}

fn text(error: DebugError) -> String {
    error.to_string()
}
