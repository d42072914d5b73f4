//! Events from the cycle, and their effects on the server state.

use rpi_runtime::control::{
    Cause, CommandId, Ending, Event, Notice, Outcome, Refused, State, Ticket, Why,
};

use rpi_device::Jump;
use rpi_runtime::run::{Written, jump_text};

use super::commands::{results, yields};
use super::owed::Debt;
use super::place::Place;
use super::rules::RuleRecord;
use super::types::why;
use super::{Desk, Errand, Failure, Phase, Record, RuleState, Then, answer, cause};

impl Desk {
    /// Processes all pending events and due updates. Called periodically outside the cycle thread.
    pub(crate) fn keep(&mut self) {
        while let Some(event) = self.control.poll() {
            self.recorder.iter().for_each(|r| r.event(&event));
            self.tasks_hear(&event);
            match event {
                Event::Answer {
                    ticket, refused, ..
                } => self.answered(ticket, refused),
                Event::Notice(notice) => self.note(notice),
                Event::Freed(id) => self.forget(id),
                Event::Device {
                    device,
                    code,
                    moving,
                    ..
                } => self.device_changed(device, code, moving),
            }
        }
        self.look_after_recording();
        self.pay();
        self.keep_stopped();
        self.advance_tasks();
        for rule in std::mem::take(&mut self.told) {
            self.rule_told(rule);
        }
        self.tell_early();
        self.finish_evals();
        self.publish();
    }

    /// Warns once when the recording has stopped because of a write error.
    fn look_after_recording(&mut self) {
        if self.recorded
            && let Some(recorder) = self.recorder.as_ref().filter(|r| !r.writes())
        {
            self.recorded = false;
            let why = recorder.trouble().unwrap_or("the writer has failed");
            let told = format!("RECORDING STOPPED: {why}");
            self.journal.warn(&told);
        }
    }

    /// Called after the last tick: processes the remaining events and closes the recording, which misses `lost` ticks.
    pub(crate) fn finish_recording(&mut self, lost: u64) -> std::io::Result<Option<Written>> {
        self.keep();
        self.recorded = false;
        let recorder = self.recorder.take();
        recorder.map(|recorder| recorder.finish(lost)).transpose()
    }

    fn answered(&mut self, ticket: Ticket, refused: Option<Refused>) {
        let Some(Errand { then, reply }) = self.errands.remove(&ticket) else {
            return;
        };
        match refused {
            None => {
                let name = self.done(then);
                answer(reply, Ok(name));
            }
            Some(why) => {
                let why = self.refusal(why);
                match then {
                    Then::Made(rule) => self.forget_rule(rule),
                    Then::Eval(number) => self.give_up_eval(number, why.clone()),
                    _ => {}
                }
                answer(reply, Err(why));
            }
        }
    }

    /// Converts a refusal of the core to an error with the display names of actuator and command.
    pub(super) fn refusal(&self, why: Refused) -> Failure {
        let Refused::Held { resource, by } = why else {
            return Failure::Refused(why);
        };
        let actuator = self.devices.actuator(resource);
        let number = self.by_id.get(&by);
        let holder = number.and_then(|n| Some((n, self.commands.get(n)?)));
        Failure::Held(match holder {
            Some((number, record)) => {
                let title = record.title.as_str();
                let gap = if title.is_empty() { "" } else { " " };
                format!("{actuator} is held by {title}{gap}n{number}")
            }
            None => format!("{actuator} is held by another command"),
        })
    }

    /// Carries out the action after a request. Returns the name of the created object.
    fn done(&mut self, then: Then) -> String {
        match then {
            Then::Nothing | Then::Eval(_) => String::new(),
            Then::Inserted(number) => self.inserted(number),
            Then::Made(rule) => format!("r{}", rule.0),
            Then::Device(info) => self.device_there(info),
            Then::Stopped => {
                self.has_stopped();
                String::new()
            }
            Then::NoDevice(name) => {
                self.device_gone(&name);
                String::new()
            }
        }
    }

    fn inserted(&mut self, number: u64) -> String {
        if let Some(record) = self.commands.get_mut(&number) {
            record.set_phase(Phase::Is(State::Ready));
            let (eval, abandoned) = (record.eval.is_some(), record.unload_at_end);
            if eval {
                self.start_eval(number);
            } else if abandoned {
                // Its client disconnected while it was loaded.
                self.owe(number, Debt::Unload);
            }
        }
        format!("n{number}")
    }

    pub(super) fn record_of(&mut self, id: CommandId) -> Option<&mut Record> {
        let number = self.by_id.get(&id)?;
        self.commands.get_mut(number)
    }

    fn note(&mut self, notice: Notice) {
        match notice {
            Notice::Scheduled { command, .. } => self.phase(command, State::Scheduled),
            Notice::Started { command, .. } => self.phase(command, State::Running),
            Notice::Cancelling { command, .. } => self.phase(command, State::Cancelling),
            Notice::Ended {
                command, ending, ..
            } => self.ended(command, ending),
            Notice::Orphaned { command, kept } => {
                if kept {
                    self.phase(command, State::Ready);
                }
                self.unload_if_abandoned(command);
            }
            Notice::Braked {
                command, resource, ..
            } => self.braked(command, resource),
            Notice::Jumped { command, jump } => self.jumped(command, &jump),
            Notice::Rule { rule, outcome } => match outcome {
                Outcome::Fired => self.rule_fired(rule),
                Outcome::Failed(_) => self.rule_over(rule, RuleState::Failed),
                Outcome::Dropped => self.rule_over(rule, RuleState::Dropped),
            },
        }
    }

    fn phase(&mut self, id: CommandId, state: State) {
        if let Some(record) = self.record_of(id) {
            record.set_phase(Phase::Is(state));
        }
    }

    /// A command has left a device moving, which brakes on its own.
    fn braked(&mut self, id: CommandId, resource: u32) {
        let device = self.devices.name(resource);
        let Some(record) = self.record_of(id) else {
            return;
        };
        if record.status.place.is_none()
            && let Some(image) = &record.image
        {
            let place = image.place_of_device(&device);
            record.status.place = place.map(|p| Place::of_node(p, record.text.as_deref()));
        }
        if !record.status.braked.contains(&device) {
            record.status.braked.push(device);
        }
    }

    /// The first set-points of a command do not continue those of its predecessor. Reported even if the policy allows
    /// it.
    fn jumped(&mut self, id: CommandId, jump: &Jump) {
        let jump = jump_text(jump, &self.devices.actuator(jump.resource));
        let number = self.by_id.get(&id).copied().unwrap_or_default();
        let Some(record) = self.record_of(id) else {
            return;
        };
        let line = format!("{} takes over with a jump: {jump}", record.called(number));
        record.tell_jump(&jump);
        record.status.jump.get_or_insert(jump);
        self.journal.note(format_args!("{line}"));
    }

    fn ended(&mut self, id: CommandId, ending: Ending) {
        let by = match ending.cause {
            Cause::Stopped(rule) => self.rules.get(&rule),
            _ => None,
        };
        let stopped = by.is_some_and(RuleRecord::takes_over);
        let number = self.by_id.get(&id).copied().unwrap_or_default();
        let Some(record) = self.record_of(id) else {
            return;
        };
        if let (Cause::Result(k), Some(image)) = (ending.cause, &record.image) {
            record.status.result = results(image).get(k).map(|name| (*name).to_owned());
        }
        if let (Cause::Fault(fault), Some(image)) = (ending.cause, &record.image) {
            let place = image.place_of(fault.cell);
            record.status.place = place.map(|p| Place::of_node(p, record.text.as_deref()));
        }
        if ending.cause == Cause::Aborted(Why::Overrun) {
            let worst = record.overruns();
            let fragment = worst.and_then(|(_, worst)| record.fragment(worst.fragment));
            record.status.place = fragment.map(Place::of_fragment);
        }
        let yielded = record.image.as_ref().is_some_and(|i| yields(i, &ending));
        (record.status.ending, record.status.taken_over) = (Some(ending), stopped || yielded);
        record.set_phase(Phase::Is(State::Terminated));
        let how = record.status.result.clone();
        let how = how.unwrap_or_else(|| match why(&ending) {
            Some(why) => format!("{}, {why}", cause(&ending)),
            None => cause(&ending).to_owned(),
        });
        let line = format!(
            "{} has ended: {how}, error {}",
            record.called(number),
            ending.error
        );
        self.journal.note(format_args!("{line}"));
        self.note_step(id);
        self.unload_if_abandoned(id);
    }

    fn unload_if_abandoned(&mut self, id: CommandId) {
        let record = self.record_of(id);
        if record.is_some_and(|r| r.unload_at_end && r.eval.is_none()) {
            self.owe_by_id(id, Debt::Unload);
        }
    }

    /// Removes a command that the core has freed.
    pub(super) fn forget(&mut self, id: CommandId) {
        let Some(mut record) = self
            .by_id
            .remove(&id)
            .and_then(|n| self.commands.remove(&n))
        else {
            return;
        };
        record.set_phase(Phase::Unloaded);
        if let Some(eval) = record.eval.take() {
            (eval.reply)(Err(Failure::Busy));
        }
        self.close_if_empty(record.session);
    }
}
