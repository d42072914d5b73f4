//! The host's side of a run: loads commands ahead, frees what is over, hands samples on, keeps the books.

use std::sync::Arc;

use rpi_core::{Cause, Command, Ending, LoadFault, Refused};
use rpi_image::Image;
use rpi_image::image::{End, EndKind};
use rpi_prims::FaultCode;

use super::directory::Directory;
use super::inputs::Set;
use super::links::{Event, HostEnds, Ready};
use super::outcome::{CommandEnd, RunEnd};
use super::samples::{Channel, Drain, Sink};

/// The host's side.
pub(super) struct Host<'a> {
    pub(super) images: &'a [Arc<Image>],
    /// Values for the inputs of each image.
    pub(super) sets: Vec<Vec<Set>>,
    pub(super) directory: Directory,
    pub(super) walk: Box<dyn Iterator<Item = usize> + Send + 'a>,
    pub(super) ends: HostEnds,
    pub(super) drain: Drain,
    pub(super) channels: Vec<Channel>,
    /// The commands so far, by number, with the image of each.
    pub(super) commands: Vec<(usize, CommandEnd)>,
    /// Why loading has failed, if it has.
    pub(super) failed: Option<(String, Vec<LoadFault>)>,
    /// The last tick of which a sample has arrived.
    pub(super) last_tick: u64,
}

impl Host<'_> {
    /// Does all that there is to do now, and hands samples to `sink`; called again and again beside the cycle.
    pub(super) fn serve(&mut self, sink: &mut dyn Sink) {
        while self.ends.dead.pop().is_ok() {}
        while let Ok(event) = self.ends.events.pop() {
            self.note(event);
        }
        self.load_ahead();
        let last_tick = &mut self.last_tick;
        self.drain.each(|channel, tick, value| {
            *last_tick = tick;
            sink.sample(channel, tick, value);
        });
    }

    /// The command that runs now, or the last one that did.
    pub(super) fn running(&self) -> Option<&CommandEnd> {
        let started = |c: &&(usize, CommandEnd)| c.1.first_tick.is_some();
        self.commands.iter().rev().find(started).map(|c| &c.1)
    }

    fn load_ahead(&mut self) {
        while self.ends.ready.slots() > 0 {
            let Some(index) = self.walk.next() else {
                self.ends.all_loaded();
                return;
            };
            if let Err(faults) = self.load(index) {
                self.failed = Some((self.images[index].name.clone(), faults));
                self.walk = Box::new(std::iter::empty());
            }
        }
    }

    fn load(&mut self, index: usize) -> Result<(), Vec<LoadFault>> {
        let image = &self.images[index];
        let mut command = Command::load(Arc::clone(image), &mut self.directory)?;
        for (input, value) in &self.sets[index] {
            command.set_input(*input, value);
        }
        let serial = self.commands.len() as u64;
        let end = CommandEnd {
            name: image.name.clone(),
            first_tick: None,
            cycles: 0,
            end: RunEnd::NeverStarted,
        };
        self.commands.push((index, end));
        // There is room, as was just seen; nobody else loads.
        let _ = self.ends.ready.push(Ready {
            serial,
            command: command.into(),
        });
        Ok(())
    }

    fn note(&mut self, event: Event) {
        let (Event::Started { serial, .. }
        | Event::Ended { serial, .. }
        | Event::Refused { serial, .. }) = event;
        let Some((index, command)) = self.commands.get_mut(serial as usize) else {
            return;
        };
        match event {
            Event::Started { tick, .. } => command.first_tick = Some(tick),
            Event::Refused { why, .. } => command.end = RunEnd::Refused { why: refused(why) },
            Event::Ended { ending, .. } => {
                command.cycles = ending.cycles;
                command.end = end(&self.images[*index], ending);
            }
        }
    }
}

fn end(image: &Image, ending: Ending) -> RunEnd {
    let number = ending.error;
    match ending.cause {
        Cause::Aborted(_) | Cause::Stopped(_) => RunEnd::CutOff,
        Cause::Fault(fault) => RunEnd::Fault {
            what: fault_text(fault.code).to_owned(),
            place: image
                .place_of(fault.cell)
                .map_or_else(String::new, |p| p.path.clone()),
        },
        Cause::Terminate if number == 0 => RunEnd::Terminated,
        Cause::Terminate => RunEnd::Error { number, name: None },
        Cause::Result(k) => result(image, k, number),
    }
}

fn result(image: &Image, k: usize, number: i64) -> RunEnd {
    let results = match &image.end {
        End::Results(results) => results.as_slice(),
        End::Ports { .. } => &[],
    };
    let name = results.get(k).map_or_else(String::new, |r| r.name.clone());
    match number {
        0 => RunEnd::Result {
            name,
            moving: results.get(k).is_some_and(|r| r.kind == EndKind::Yield),
        },
        number => RunEnd::Error {
            number,
            name: Some(name),
        },
    }
}

fn refused(why: Refused) -> String {
    match why {
        Refused::Unknown => "the core does not know it".to_owned(),
        Refused::State(state) => format!("that does not fit the state {state:?}"),
        Refused::Held { resource, .. } => format!("actuator {resource} is held by another command"),
        Refused::Successor => "it would follow itself or start twice".to_owned(),
        Refused::Never => "nothing can start it any more".to_owned(),
        Refused::Condition => "its rule's condition is nested too deeply".to_owned(),
        Refused::Period => "its period is no whole multiple of the tick".to_owned(),
        Refused::Full => "the core's table is full".to_owned(),
    }
}

/// A fault in words.
pub(crate) fn fault_text(code: FaultCode) -> &'static str {
    match code {
        FaultCode::IntegerOverflow => "the result does not fit a 64-bit integer",
        FaultCode::DivisionByZero => "integer division by zero",
        FaultCode::LossyConversion => "this real has no integer value",
        FaultCode::IndexOutOfRange => "the index lies outside of its array",
        FaultCode::ShapeMismatch => "matrices or arrays whose shapes do not fit",
        FaultCode::ConcurrentAccess => "two writers of one actuator in a cycle",
        FaultCode::MissingSample => "a sensor had no sample",
        FaultCode::DeviceFailed => "the device refuses its set-point or has failed",
        FaultCode::SetPointMissing => "a moving actuator got no set-point and was stopped",
        FaultCode::EmergencyStop => "an emergency stop was demanded",
        FaultCode::AssertionFailed => "an assertion does not hold",
    }
}
