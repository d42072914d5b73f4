//! Events from the cycle, and their effects on the server state.

use rpi_runtime::control::{
    Cause, CommandId, Ending, Event, Notice, Outcome, Refused, State, Ticket,
};

use super::ServerState;
use super::command_events::{braked, ended, inserted, jumped, phase};
use super::eval::{finish_evals, give_up_eval};
use super::pending::{Errand, Then, answer};
use super::types::RuleState;

impl ServerState {
    /// Processes all pending events and due updates. Called periodically outside the cycle thread.
    pub(crate) fn keep(&mut self) {
        while let Some(event) = self.core.poll() {
            self.hear(event);
        }
        self.recording.look_after(&mut self.log);
        self.core.pay();
        self.emergency.keep_stopped(&mut self.core);
        self.advance_tasks();
        let commands = &mut self.objects.commands;
        self.rules.release_told(commands);
        self.rules.tell_early(commands);
        finish_evals(commands, &mut self.core);
        commands.publish();
    }

    fn hear(&mut self, event: Event) {
        self.recording.event(&event);
        self.objects.tasks.hear(&event);
        match event {
            Event::Answer {
                ticket, refused, ..
            } => self.answered(ticket, refused),
            Event::Notice(notice) => self.note(notice),
            Event::Freed(id) => {
                if let Some(record) = self.objects.commands.forget(id) {
                    self.objects.forget_command(record);
                }
            }
            Event::Device {
                device,
                code,
                moving,
                ..
            } => self.devices.changed(device, code, moving, &mut self.log),
        }
    }

    /// Advances all running tasks and reports their progress.
    fn advance_tasks(&mut self) {
        for number in self.objects.tasks.under_way() {
            self.shop(number).with_task(|task, shop| task.advance(shop));
            let objects = &mut self.objects;
            objects
                .tasks
                .note_progress(number, &objects.commands, &mut self.log);
            objects.forget_task_if_abandoned(number);
        }
    }

    fn answered(&mut self, ticket: Ticket, refused: Option<Refused>) {
        let Some(Errand { then, reply }) = self.core.answered(ticket) else {
            return;
        };
        let Some(why) = refused else {
            let name = self.done(then);
            return answer(reply, Ok(name));
        };
        let why = self.objects.commands.refusal(why, &self.devices);
        match then {
            Then::Made(rule) => self.rules.forget(rule),
            Then::Eval(number) => {
                let commands = &mut self.objects.commands;
                give_up_eval(commands, number, why.clone(), &mut self.core);
            }
            _ => {}
        }
        answer(reply, Err(why));
    }

    /// Carries out the action after a request. Returns the name of the created object.
    fn done(&mut self, then: Then) -> String {
        match then {
            Then::Nothing | Then::Eval(_) => String::new(),
            Then::Inserted(number) => {
                let commands = &mut self.objects.commands;
                let may_start = self.emergency.may_start();
                inserted(commands, number, may_start, &mut self.core);
                format!("n{number}")
            }
            Then::Made(rule) => format!("r{}", rule.0),
            Then::Device(info) => self.devices.added(info, &mut self.log),
            Then::Stopped => {
                self.emergency.has_stopped();
                String::new()
            }
            Then::NoDevice(name) => {
                self.devices.gone(&name, &mut self.log);
                String::new()
            }
        }
    }

    fn note(&mut self, notice: Notice) {
        let commands = &mut self.objects.commands;
        match notice {
            Notice::Scheduled { command, .. } => phase(commands, command, State::Scheduled),
            Notice::Started { command, .. } => phase(commands, command, State::Running),
            Notice::Cancelling { command, .. } => phase(commands, command, State::Cancelling),
            Notice::Ended {
                command, ending, ..
            } => self.ended(command, ending),
            Notice::Orphaned { command, kept } => {
                if kept {
                    phase(commands, command, State::Ready);
                }
                commands.unload_if_abandoned(command, &mut self.core);
            }
            Notice::Braked {
                command, resource, ..
            } => braked(commands, command, self.devices.name(resource)),
            Notice::Jumped { command, jump } => {
                jumped(commands, command, (&jump, &self.devices), &mut self.log);
            }
            Notice::Rule { rule, outcome } => match outcome {
                Outcome::Fired => self.rules.fired(rule, commands, &mut self.log),
                Outcome::Failed(_) => self.rules.over(rule, RuleState::Failed),
                Outcome::Dropped => self.rules.over(rule, RuleState::Dropped),
            },
        }
    }

    fn ended(&mut self, id: CommandId, ending: Ending) {
        let stopped = match ending.cause {
            Cause::Stopped(rule) => self.rules.takes_over(rule),
            _ => false,
        };
        let objects = &mut self.objects;
        ended(&mut objects.commands, id, (ending, stopped), &mut self.log);
        objects.tasks.note_step(id, &objects.commands);
        objects.commands.unload_if_abandoned(id, &mut self.core);
    }
}
