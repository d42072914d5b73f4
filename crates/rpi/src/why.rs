//! `rpi why`: the causes of the value of a flow in a recording.

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use rpi_core::CommandId;
use rpi_driver::{AnalysedNet, Compiled};
use rpi_net::{ExportPort, PortRef};
use rpi_record::mcap::{Recording, replay_observed};
use rpi_replay::why::{History, Why, WhyStep, why};
use serde_json::{Value, json};

use crate::exit::{CommandResult, Exit};
use crate::recorded_run;
use crate::watched_recording::compiled_again;

/// Options of `rpi why`.
#[derive(Args, Debug)]
pub(crate) struct WhyArgs {
    /// Recording (.mcap): the file of its first part.
    recording: PathBuf,
    /// Flow, named by its command and the path to it, such as `Move.Approach.way.done`.
    flow: String,
    /// Time of the run at which the flow has the value in question, such as 1.5s; default: the last cycle of the command.
    #[arg(long, value_name = "TIME", value_parser = rpi_driver::parse_duration)]
    at: Option<u64>,
    /// Program that was recorded, if it consists of several files.
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

/// Carries out `rpi why`.
pub(crate) fn why_command(args: &WhyArgs) -> CommandResult {
    let mut recording = recorded_run::open(&args.recording)?;
    let question = Question {
        flow: &args.flow,
        until: args.at.map_or(u64::MAX, |at| at / recording.tick_ns),
        program: args.program.as_deref(),
    };
    let explained = explain(&mut recording, &question)?;
    rpi_cli::print(explained.text())?;
    Ok(Exit::Success)
}

/// Question for the causes of a value.
pub(crate) struct Question<'a> {
    /// Name of the flow, with the command and the path to it.
    pub(crate) flow: &'a str,
    /// Number of the tick of the value. The last cycle of the command up to this tick counts.
    pub(crate) until: u64,
    /// File of the program, which is needed if it consists of several files.
    pub(crate) program: Option<&'a Path>,
}

/// Answer to a question.
pub(crate) struct Explained {
    answer: Why,
    compiled: Compiled,
    times: Times,
}

/// Replays a recording and returns the causes of a value. The images of the recording are replaced.
pub(crate) fn explain(
    recording: &mut Recording,
    question: &Question<'_>,
) -> Result<Explained, Box<dyn Error>> {
    let flow = question.flow;
    let (watch, lower) = ([flow.to_owned()], rpi_driver::lower_for_observation_in_tick);
    let compiled = compiled_again(recording, &watch, question.program, lower)?;
    let nets = compiled.nets().iter();
    let requested: Vec<(&AnalysedNet, String, PortRef)> =
        nets.flat_map(|net| requested_ports(net, flow)).collect();
    let [(net, name, port)] = &requested[..] else {
        return Err(not_one_value(flow, &requested).into());
    };
    let (history, last_tick) = history(recording, net, question.until)?;
    let cycle = history
        .last_cycle()
        .ok_or_else(|| format!("{} has no cycle up to this time", net.name))?;
    let answer = why(net, &history, *port, name, cycle);
    let times = Times {
        tick_ns: recording.tick_ns,
        cycle,
        tick: last_tick,
    };
    Ok(Explained {
        answer,
        compiled,
        times,
    })
}

/// Returns the exported ports of a net that a name selects, with their names in the command.
fn requested_ports<'n>(
    net: &'n AnalysedNet,
    flow: &str,
) -> Vec<(&'n AnalysedNet, String, PortRef)> {
    let Some(inside) = flow
        .strip_prefix(&net.name)
        .and_then(|rest| rest.strip_prefix('.'))
    else {
        return Vec::new();
    };
    let is_requested = |key: &str| {
        let rest = key.strip_prefix(inside);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    };
    let named = |export: &ExportPort| (net, export.key.clone(), export.source);
    let exports = || net.exports.iter();
    // The value of a call has the name of the call, which also stands for all flows inside.
    match exports().find(|export| export.key == inside) {
        Some(export) => vec![named(export)],
        None => {
            let requested = exports().filter(|export| is_requested(&export.key));
            requested.map(named).collect()
        }
    }
}

fn not_one_value(flow: &str, requested: &[(&AnalysedNet, String, PortRef)]) -> String {
    let names = requested
        .iter()
        .map(|(net, name, _)| format!("{}.{name}", net.name));
    let names: Vec<String> = names.take(8).collect();
    match names.is_empty() {
        true => format!("`{flow}` is the name of a command; name a flow inside of it"),
        false => format!(
            "`{flow}` has several values; choose one: {}",
            names.join(", ")
        ),
    }
}

/// Replays a recording up to a tick and returns the values of the last run of the command up to then, with the number of the tick of
/// its last cycle.
fn history(
    recording: &Recording,
    net: &AnalysedNet,
    until: u64,
) -> Result<(History, u64), Box<dyn Error>> {
    let mut found: Option<(CommandId, History, u64)> = None;
    let report = replay_observed(recording, &mut |tick, id, command| {
        let instance = command.instance();
        if tick > until || instance.image().name != net.name {
            return;
        }
        if found.as_ref().is_none_or(|(known, ..)| *known != id) {
            found = Some((id, History::new(net, instance.image()), tick));
        }
        if let Some((_, history, last)) = &mut found {
            history.add(instance);
            *last = tick;
        }
    })?;
    if let Some(difference) = report.difference {
        return Err(format!("the replay differs from the recording: {difference}").into());
    }
    let (_, history, tick) =
        found.ok_or_else(|| format!("{} does not run up to this time", net.name))?;
    Ok((history, tick))
}

/// Times of the cycles of a command.
struct Times {
    tick_ns: u64,
    /// Number of a cycle, and of the tick in which it was.
    cycle: u64,
    tick: u64,
}

impl Times {
    fn tick_of(&self, cycle: u64) -> u64 {
        self.tick.saturating_sub(self.cycle.saturating_sub(cycle))
    }

    fn seconds(&self, cycle: u64) -> f64 {
        self.tick_of(cycle) as f64 * self.tick_ns as f64 * 1e-9
    }
}

impl Explained {
    /// Returns the answer as lines, each indented below the one of which it is a cause.
    fn text(&self) -> String {
        let answer = &self.answer;
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); answer.steps.len()];
        for (k, step) in answer.steps.iter().enumerate() {
            if let Some(of) = step.of {
                children[of].push(k);
            }
        }
        let mut text = String::new();
        let mut open = vec![(0, 0)];
        while let Some((k, depth)) = open.pop() {
            let step = &answer.steps[k];
            let place = self.place(step);
            let place = place.map_or_else(String::new, |(file, line)| format!("{file}:{line}"));
            let line = format!("{}{}", "  ".repeat(depth), step_text(step, &self.times));
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{line:<64} {place}");
            open.extend(children[k].iter().rev().map(|child| (*child, depth + 1)));
        }
        if answer.is_incomplete {
            text.push_str("further causes are left out\n");
        }
        text
    }

    /// Returns the answer for the page of `rpi view`.
    pub(crate) fn json(&self) -> Value {
        let steps = self.answer.steps.iter().map(|step| {
            let place = self.place(step);
            json!({
                "of": step.of,
                "name": step.name,
                "value": step.value,
                "tick": self.times.tick_of(step.cycle),
                "since": self.times.tick_of(step.since),
                "isRoot": step.is_root,
                "file": place.map(|(file, _)| file),
                "line": place.map(|(_, line)| line),
            })
        });
        json!({
            "steps": steps.collect::<Vec<_>>(),
            "isIncomplete": self.answer.is_incomplete,
        })
    }

    /// Returns the file and line of a step; `None` for one without a place.
    fn place(&self, step: &WhyStep) -> Option<(&str, u32)> {
        let sources = &self.compiled.sources;
        let line = || sources.line_col(step.span).line;
        (!step.span.is_none()).then(|| (sources.name(step.span.file), line()))
    }
}

fn step_text(step: &WhyStep, times: &Times) -> String {
    let at = times.seconds(step.cycle);
    match (step.value.as_str(), step.since < step.cycle) {
        ("", _) => step.name.clone(),
        (value, false) => format!("{} = {value} at {at:.3} s", step.name),
        (value, true) => {
            let since = times.seconds(step.since);
            format!("{} = {value} from {since:.3} s to {at:.3} s", step.name)
        }
    }
}
