//! Builds the picture of a run from the motion of its devices.

use std::collections::BTreeMap;

use crate::plot::{Chart, ExecutionSpan, Line, Plot, SpacePath};
use rpi_runtime::run::{Channel, Outcome, RunEnd, Sink, Source};

/// Sink of samples that collects the paths of the arms and the states of the digital outputs, for a plot of the run.
#[derive(Default)]
pub struct MotionSink {
    channels: Vec<Channel>,
    /// Number of the tick and first three memory words of each collected sample, by the index of the channel.
    samples: BTreeMap<usize, Vec<(u64, [u64; 3])>>,
}

const JOINT: &str = "joint.commanded_position";
const TOOL: &str = "tcp.commanded_position";
const SWITCH: &str = "out.bool";

impl Sink for MotionSink {
    fn channels(&mut self, channels: &[Channel]) {
        self.channels = channels.to_vec();
    }

    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        let shown = matches!(&self.channels[channel].source, Source::Device { port, .. } if [JOINT, TOOL, SWITCH].contains(port));
        if let Some(value) = value.filter(|_| shown) {
            let cell = |k: usize| value.get(k).copied().unwrap_or(0);
            let kept = self.samples.entry(channel).or_default();
            kept.push((tick, [cell(0), cell(1), cell(2)]));
        }
    }
}

impl MotionSink {
    /// Returns the plot of the run with this outcome: paths, joint positions and velocities, digital outputs and
    /// commands.
    #[must_use]
    pub fn to_plot(&self, title: &str, outcome: &Outcome) -> Plot {
        let dt = outcome.tick_ns as f64 * 1e-9;
        let mut charts = Vec::new();
        for device in self.devices(JOINT) {
            let positions = self.joints(device, dt);
            let velocities = positions.iter().map(velocity).collect();
            charts.push(chart(
                format!("{device}: joint positions, degrees"),
                positions,
            ));
            charts.push(chart(
                format!("{device}: joint velocities, degrees per second"),
                velocities,
            ));
        }
        for device in self.devices(SWITCH) {
            charts.push(Chart {
                title: format!("{device}: digital outputs"),
                lines: self.lines(SWITCH, device, ("output", |cell| cell as f64), dt),
                levels: ["false", "true"].map(str::to_owned).to_vec(),
            });
        }
        Plot {
            title: title.to_owned(),
            paths: self
                .devices(TOOL)
                .into_iter()
                .map(|d| self.path(d, dt))
                .collect(),
            charts,
            spans: execution_spans(outcome, dt),
        }
    }

    /// Returns the names of the devices with samples of the port `wanted`, in the order of the cell.
    fn devices(&self, wanted: &str) -> Vec<&str> {
        let mut devices: Vec<&str> = self.samples_of(wanted).map(|(device, ..)| device).collect();
        devices.dedup();
        devices
    }

    /// Returns the samples of all channels of the port `wanted`: name of the device, index of the port, and for each
    /// sample the number of the tick and three memory words.
    fn samples_of(&self, wanted: &str) -> impl Iterator<Item = (&str, usize, &[(u64, [u64; 3])])> {
        let kept = self.samples.iter();
        kept.filter_map(
            move |(channel, samples)| match &self.channels[*channel].source {
                Source::Device {
                    device,
                    port,
                    index,
                } if *port == wanted => Some((device.as_str(), *index, samples.as_slice())),
                _ => None,
            },
        )
    }

    fn lines(
        &self,
        wanted: &str,
        device: &str,
        (name, value): (&str, fn(u64) -> f64),
        dt: f64,
    ) -> Vec<Line> {
        let mine = self.samples_of(wanted).filter(|(of, ..)| *of == device);
        mine.map(|(_, index, samples)| Line {
            name: format!("{name} {index}"),
            points: samples
                .iter()
                .map(|(tick, c)| (*tick as f64 * dt, value(c[0])))
                .collect(),
        })
        .collect()
    }

    fn joints(&self, device: &str, dt: f64) -> Vec<Line> {
        self.lines(
            JOINT,
            device,
            ("axis", |cell| f64::from_bits(cell).to_degrees()),
            dt,
        )
    }

    fn path(&self, device: &str, dt: f64) -> SpacePath {
        let mut mine = self.samples_of(TOOL).filter(|(of, ..)| *of == device);
        let samples = mine.next().map_or(&[][..], |(_, _, samples)| samples);
        SpacePath {
            name: device.to_owned(),
            points: samples
                .iter()
                .map(|(tick, cells)| (*tick as f64 * dt, cells.map(f64::from_bits)))
                .collect(),
        }
    }
}

fn chart(title: String, lines: Vec<Line>) -> Chart {
    Chart {
        title,
        lines,
        levels: Vec::new(),
    }
}

/// Returns the slope of a line between successive samples, as a line of velocities per second.
fn velocity(line: &Line) -> Line {
    let slope = |w: &[(f64, f64)]| (w[1].0, (w[1].1 - w[0].1) / (w[1].0 - w[0].0));
    Line {
        name: line.name.clone(),
        points: line.points.windows(2).map(slope).collect(),
    }
}

fn execution_spans(outcome: &Outcome, dt: f64) -> Vec<ExecutionSpan> {
    let started = outcome
        .commands
        .iter()
        .filter_map(|c| Some((c, c.first_tick?)));
    started
        .map(|(command, first)| ExecutionSpan {
            command: command.name.clone(),
            from: first as f64 * dt,
            to: (first + command.cycles) as f64 * dt,
            end: end_text(&command.end),
        })
        .collect()
}

fn end_text(end: &RunEnd) -> String {
    match end {
        RunEnd::Result { name, .. } => name.clone(),
        other => other.to_string(),
    }
}
