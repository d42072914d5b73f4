//! Monitoring of claims during a run. It works on the samples sent by the cycle, so the cycle only computes and
//! publishes the claims.

use rpi_diag::Finding;
use rpi_image::Type;
use rpi_net::Claim;

use super::{Broken, Flows, Watch};
use crate::faults::Faults;
use rpi_runtime::run::{Channel, CommandEnd, Outcome, RunEnd, Sink};

/// Sink that monitors the claims of the commands of a run.
#[derive(Debug)]
pub struct ClaimSink {
    commands: Vec<Watched>,
    /// For each channel, the indices of its command and of its flow in the command.
    of: Vec<Option<(usize, usize)>>,
}

#[derive(Debug)]
struct Watched {
    name: String,
    claims: Vec<Claim>,
    watch: Watch,
    /// Values of the current tick.
    row: Row,
    tick: Option<u64>,
    broken: Vec<(u64, Broken)>,
}

#[derive(Debug, Default)]
struct Row(Vec<Option<Vec<u64>>>);

impl Flows for Row {
    fn cells(&self, export: usize) -> Option<&[u64]> {
        self.0[export].as_deref()
    }
}

impl ClaimSink {
    /// Creates a sink for commands with their names and claims.
    #[must_use]
    pub fn new<'n>(commands: impl Iterator<Item = (&'n str, &'n [Claim])>) -> ClaimSink {
        let watched = |(name, claims): (&str, &[Claim])| Watched {
            name: name.to_owned(),
            claims: claims.to_vec(),
            watch: Watch::new(&[], |_| None),
            row: Row::default(),
            tick: None,
            broken: Vec::new(),
        };
        ClaimSink {
            commands: commands.map(watched).collect(),
            of: Vec::new(),
        }
    }

    /// Returns the diagnostics of all violated claims and a summary, after the end of a run. A violation that ended a
    /// command with a fault is merged into the diagnostic of that fault in `faults`.
    #[must_use]
    pub fn told(mut self, outcome: &mut Outcome, faults: &mut Faults) -> (Vec<Finding>, String) {
        let (mut findings, mut summary) = (Vec::new(), String::new());
        let seconds = outcome.tick_ns as f64 * 1e-9;
        let is_alone = outcome.commands.len() == 1;
        for command in &mut self.commands {
            command.look();
            for (tick, broken) in &command.broken {
                let run = run_in(outcome, &command.name, *tick);
                let start = run.as_ref().and_then(|run| run.1.first_tick).unwrap_or(0);
                let fault = run.and_then(|(index, run)| Some((run, faults.0.get_mut(&index)?)));
                if fault.is_some_and(|fault| is_its_fault(fault, &command.watch, *tick, broken)) {
                    continue;
                }
                let finding = command.watch.told(broken, tick - start);
                let from = start as f64 * seconds;
                findings.push(match is_alone {
                    true => finding,
                    false => finding.note(format!("in `{}` from {from:.3} s on", command.name)),
                });
            }
            summary.push_str(&command.watch.summary());
        }
        (findings, summary)
    }
}

/// Returns the run of the command with this name that was active in a tick, with its index in the outcome.
fn run_in<'o>(
    outcome: &'o mut Outcome,
    name: &str,
    tick: u64,
) -> Option<(usize, &'o mut CommandEnd)> {
    let runs = outcome.commands.iter_mut().enumerate();
    let begun = runs
        .filter(|(_, run)| run.name == name && run.first_tick.is_some_and(|first| first <= tick));
    begun.max_by_key(|(_, run)| run.first_tick)
}

/// Merges a violated claim into the fault of its command and the diagnostic of the fault. Returns false if the command
/// did not fault in this tick because of this claim.
fn is_its_fault(
    (run, finding): (&mut CommandEnd, &mut Finding),
    watch: &Watch,
    tick: u64,
    broken: &Broken,
) -> bool {
    let last = run
        .first_tick
        .map(|first| first + run.cycles.saturating_sub(1));
    match &mut run.end {
        RunEnd::Fault { what, .. } if last == Some(tick) => {
            let sentence = watch.tell_fault(finding, broken);
            sentence.map(|sentence| *what = sentence).is_some()
        }
        _ => false,
    }
}

impl Sink for ClaimSink {
    fn channels(&mut self, channels: &[Channel]) {
        self.of = vec![None; channels.len()];
        for (number, command) in self.commands.iter_mut().enumerate() {
            let mut places: Vec<(String, Type)> = Vec::new();
            for (channel, of) in channels.iter().zip(&mut self.of) {
                let key = channel.name.strip_prefix(&command.name);
                if let Some(key) = key.and_then(|key| key.strip_prefix('.')) {
                    *of = Some((number, places.len()));
                    places.push((key.to_owned(), channel.ty));
                }
            }
            command.row.0 = vec![None; places.len()];
            command.watch = Watch::new(&command.claims, |key| {
                let place = places.iter().position(|(known, _)| known == key)?;
                Some((place, places[place].1))
            });
        }
    }

    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        let Some((command, place)) = self.of[channel] else {
            return;
        };
        let command = &mut self.commands[command];
        if command.tick != Some(tick) {
            command.look();
            command.tick = Some(tick);
        }
        command.row.0[place] = value.map(<[u64]>::to_vec);
    }
}

impl Watched {
    /// Evaluates the claims on the values of a completed tick.
    fn look(&mut self) {
        if let Some(tick) = self.tick.take() {
            let broken = self.watch.look(&self.row);
            self.broken.extend(broken.into_iter().map(|b| (tick, b)));
        }
    }
}
