//! Events from the cycle, and their effects on the server state.

use rpi_runtime::control::{
    Cause, CommandError, CommandId, CommandState, Ending, Event, Notice, RuleOutcome, Ticket,
};

use super::ServerState;
use super::command_events::{on_braked, on_discontinuity, on_ended, on_inserted, set_phase};
use super::eval::{fail_eval, finish_evals};
use super::pending::{OnAnswer, PendingRequest, answer};
use super::types::RuleState;

impl ServerState {
    /// Processes all pending events of the cycle, sends deferred requests and due updates, and advances the tasks.
    /// Called periodically outside the cycle thread.
    pub(crate) fn update(&mut self) {
        while let Some(event) = self.core.poll() {
            self.handle_event(event);
        }
        self.recording.warn_if_failed(&mut self.log);
        self.core.send_deferred();
        self.emergency.repeat_stop_request(&mut self.core);
        self.advance_tasks();
        let commands = &mut self.objects.commands;
        self.rules.release_reported(commands);
        self.rules.report_delayed_rules(commands);
        finish_evals(commands, &mut self.core);
        commands.abort_overdue(&mut self.core, &mut self.log);
        commands.publish();
    }

    fn handle_event(&mut self, event: Event) {
        self.recording.event(&event);
        self.objects.tasks.handle_event(&event);
        match event {
            Event::Answer {
                ticket, refused, ..
            } => self.on_answer(ticket, refused),
            Event::Notice(notice) => self.on_notice(notice),
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
            } => self.devices.on_changed(device, code, moving, &mut self.log),
        }
    }

    /// Lets all running tasks start and schedule their next commands, and reports their progress.
    fn advance_tasks(&mut self) {
        for number in self.objects.tasks.under_way() {
            self.task_core(number)
                .with_task(|task, core| task.advance(core));
            let objects = &mut self.objects;
            let tasks = &mut objects.tasks;
            let released = tasks.update_progress(number, &objects.commands, &mut self.log);
            self.core.make_safe(released);
            objects.remove_task_if_abandoned(number);
        }
    }

    fn on_answer(&mut self, ticket: Ticket, refused: Option<CommandError>) {
        let Some(PendingRequest { then, reply }) = self.core.take_answered(ticket) else {
            return;
        };
        let counts = &mut self.statistics;
        let Some(why) = refused else {
            counts.requests_done += 1;
            let name = self.on_success(then);
            return answer(reply, Ok(name));
        };
        counts.requests_refused += 1;
        let why = self.objects.commands.refusal_error(why, &self.devices);
        match then {
            OnAnswer::RuleMade(rule) => self.rules.forget(rule),
            OnAnswer::Eval(number) => {
                let commands = &mut self.objects.commands;
                fail_eval(commands, number, why.clone(), &mut self.core);
            }
            _ => {}
        }
        answer(reply, Err(why));
    }

    /// Carries out the action that follows a successful request to the core. Returns the name of the created object;
    /// empty if the request creates none.
    fn on_success(&mut self, then: OnAnswer) -> String {
        match then {
            OnAnswer::Nothing | OnAnswer::Eval(_) => String::new(),
            OnAnswer::CommandInserted(number) => {
                let commands = &mut self.objects.commands;
                let may_start = self.emergency.ensure_not_stopped();
                on_inserted(commands, number, may_start, &mut self.core);
                format!("n{number}")
            }
            OnAnswer::RuleMade(rule) => format!("r{}", rule.0),
            OnAnswer::DeviceAdded(info) => self.devices.on_added(info, &mut self.log),
            OnAnswer::Stopped => {
                self.emergency.clear_stop_flag();
                String::new()
            }
            OnAnswer::DeviceRemoved(name) => {
                self.devices.on_removed(&name, &mut self.log);
                String::new()
            }
        }
    }

    fn on_notice(&mut self, notice: Notice) {
        let commands = &mut self.objects.commands;
        match notice {
            Notice::Scheduled { command, .. } => {
                set_phase(commands, command, CommandState::Scheduled)
            }
            Notice::Started { command, .. } => set_phase(commands, command, CommandState::Running),
            Notice::Cancelling { command, .. } => {
                set_phase(commands, command, CommandState::Cancelling);
                self.objects.set_deadline(command);
            }
            Notice::Ended {
                command, ending, ..
            } => self.on_ended(command, ending),
            Notice::Orphaned { command, kept } => {
                if kept {
                    set_phase(commands, command, CommandState::Ready);
                }
                commands.unload_if_abandoned(command, &mut self.core);
            }
            Notice::Braked {
                command, resource, ..
            } => on_braked(commands, command, self.devices.device_name(resource)),
            Notice::Discontinuity {
                command,
                discontinuity: jump,
            } => {
                self.statistics.discontinuities += 1;
                on_discontinuity(commands, command, (&jump, &self.devices), &mut self.log);
            }
            Notice::Rule { rule, outcome } => match outcome {
                RuleOutcome::Fired => self.rules.on_fired(rule, commands, &mut self.log),
                RuleOutcome::Failed(_) => self.rules.on_ended(rule, RuleState::Failed),
                RuleOutcome::Dropped => self.rules.on_ended(rule, RuleState::Dropped),
            },
        }
    }

    fn on_ended(&mut self, id: CommandId, ending: Ending) {
        self.statistics.count_ending(&ending);
        let stopped = match ending.cause {
            Cause::Stopped(rule) => self.rules.takes_over(rule),
            _ => false,
        };
        let objects = &mut self.objects;
        on_ended(&mut objects.commands, id, (ending, stopped), &mut self.log);
        objects.tasks.add_step(id, &objects.commands);
        objects.commands.unload_if_abandoned(id, &mut self.core);
    }
}
