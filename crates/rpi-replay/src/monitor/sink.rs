//! Monitoring of claims during a run. It works on the samples sent by the cycle, so the cycle only computes and
//! publishes the claims.

use rpi_diag::Diagnostic;
use rpi_image::Type;
use rpi_net::Claim;

use super::{ClaimMonitor, ClaimViolation, ExportValues};
use crate::faults::{Faults, ReportedFault};
use rpi_runtime::run::{Channel, CommandEnd, Outcome, RunEnd, Sink};

/// Sink of samples that monitors the claims (assertions and contracts) of the commands of a run.
#[derive(Debug)]
pub struct ClaimMonitorSink {
    commands: Vec<MonitoredCommand>,
    /// For each channel of samples, the index of its command and the index of its flow in the command; `None` for a
    /// channel of no monitored command.
    channel_owners: Vec<Option<(usize, usize)>>,
}

#[derive(Debug)]
struct MonitoredCommand {
    name: String,
    claims: Vec<Claim>,
    watch: ClaimMonitor,
    /// Latest values of the command's sampled flows.
    row: SampleRow,
    tick: Option<u64>,
    violations: Vec<(u64, ClaimViolation)>,
}

#[derive(Debug, Default)]
struct SampleRow(Vec<Option<Vec<u64>>>);

impl ExportValues for SampleRow {
    fn words(&self, export: usize) -> Option<&[u64]> {
        self.0[export].as_deref()
    }
}

impl ClaimMonitorSink {
    /// Creates a sink that monitors commands, given by name and claims.
    #[must_use]
    pub fn new<'n>(commands: impl Iterator<Item = (&'n str, &'n [Claim])>) -> ClaimMonitorSink {
        let watched = |(name, claims): (&str, &[Claim])| MonitoredCommand {
            name: name.to_owned(),
            claims: claims.to_vec(),
            watch: ClaimMonitor::new(&[], |_| None),
            row: SampleRow::default(),
            tick: None,
            violations: Vec::new(),
        };
        ClaimMonitorSink {
            commands: commands.map(watched).collect(),
            channel_owners: Vec::new(),
        }
    }

    /// Returns the diagnostics of all violated claims and a summary, after the end of a run. A violation that ended a
    /// command with a fault is merged into the diagnostic of that fault in `faults`.
    #[must_use]
    pub fn into_diagnostics(
        mut self,
        outcome: &mut Outcome,
        faults: &mut Faults,
    ) -> (Vec<Diagnostic>, String) {
        let (mut diagnostics, mut summary) = (Vec::new(), String::new());
        let seconds = outcome.tick_ns as f64 * 1e-9;
        let is_alone = outcome.commands.len() == 1;
        for command in &mut self.commands {
            command.evaluate();
            for (tick, broken) in &command.violations {
                let run = command_at(outcome, &command.name, *tick);
                let start = run.as_ref().and_then(|run| run.1.first_tick).unwrap_or(0);
                let fault = run.and_then(|(index, run)| Some((run, faults.0.get_mut(&index)?)));
                if fault.is_some_and(|fault| merge_into_fault(fault, &command.watch, *tick, broken))
                {
                    continue;
                }
                let diagnostic = command.watch.diagnostic(broken, tick - start);
                let from = start as f64 * seconds;
                diagnostics.push(match is_alone {
                    true => diagnostic,
                    false => diagnostic.note(format!("in `{}` from {from:.3} s on", command.name)),
                });
            }
            summary.push_str(&command.watch.summary());
        }
        (diagnostics, summary)
    }
}

/// Returns the entry in the outcome of the command with this name that was active in a tick, with its index; `None` if
/// there is none.
fn command_at<'o>(
    outcome: &'o mut Outcome,
    name: &str,
    tick: u64,
) -> Option<(usize, &'o mut CommandEnd)> {
    let runs = outcome.commands.iter_mut().enumerate();
    let begun = runs
        .filter(|(_, run)| run.name == name && run.first_tick.is_some_and(|first| first <= tick));
    begun.max_by_key(|(_, run)| run.first_tick)
}

/// Replaces the description of a command's fault by that of a violated claim. Returns false, and changes nothing, if
/// the command did not end in this tick with a fault because of the claim.
fn merge_into_fault(
    (run, fault): (&mut CommandEnd, &mut ReportedFault),
    watch: &ClaimMonitor,
    tick: u64,
    broken: &ClaimViolation,
) -> bool {
    let last = run
        .first_tick
        .map(|first| first + run.cycles.saturating_sub(1));
    match &mut run.end {
        RunEnd::Fault { what, .. } if last == Some(tick) => {
            let sentence = watch.explain_fault(fault, broken);
            sentence.map(|sentence| *what = sentence).is_some()
        }
        _ => false,
    }
}

impl Sink for ClaimMonitorSink {
    fn channels(&mut self, channels: &[Channel]) {
        self.channel_owners = vec![None; channels.len()];
        for (number, command) in self.commands.iter_mut().enumerate() {
            let mut places: Vec<(String, Type)> = Vec::new();
            for (channel, of) in channels.iter().zip(&mut self.channel_owners) {
                let key = channel.name.strip_prefix(&command.name);
                if let Some(key) = key.and_then(|key| key.strip_prefix('.')) {
                    *of = Some((number, places.len()));
                    places.push((key.to_owned(), channel.ty));
                }
            }
            command.row.0 = vec![None; places.len()];
            command.watch = ClaimMonitor::new(&command.claims, |key| {
                let place = places.iter().position(|(known, _)| known == key)?;
                Some((place, places[place].1))
            });
        }
    }

    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        let Some((command, place)) = self.channel_owners[channel] else {
            return;
        };
        let command = &mut self.commands[command];
        if command.tick != Some(tick) {
            command.evaluate();
            command.tick = Some(tick);
        }
        command.row.0[place] = value.map(<[u64]>::to_vec);
    }
}

impl MonitoredCommand {
    /// Evaluates the claims on the values of the tick whose samples have all arrived.
    fn evaluate(&mut self) {
        if let Some(tick) = self.tick.take() {
            let broken = self.watch.evaluate(&self.row);
            self.violations
                .extend(broken.into_iter().map(|b| (tick, b)));
        }
    }
}
