//! Requests of clients that need several parts of the state.

use std::time::Duration;

use rpi_core::MotionControls;
use rpi_runtime::control::{AbortReason, Control};

use super::deferred::CommandOp;
use super::device_spec::NewDevice;
use super::emergency::{StopOrigin, requester};
use super::pending::OnAnswer;
use super::rule_request::{RuleRequest, record_end_result};
use super::sessions::SessionPolicy;
use super::settings::{self, Value};
use super::task_core::TaskCoreAdapter;
use super::types::{ApiError, Reply, Subscriber};
use super::{Client, ServerState};
use crate::role::Identity;

impl ServerState {
    /// Opens a session for the client in `owner`, logs the identity `by` of the client, and returns the name of the
    /// session. The Boolean in `owner` is true for a shared session, on which every client that knows its name may act.
    pub(crate) fn open_session(
        &mut self,
        name: &str,
        policy: SessionPolicy,
        owner: (Client, bool),
        by: &Identity,
    ) -> Result<String, ApiError> {
        let session = self.objects.open_session(name, policy, owner)?;
        let of = match name {
            "" => String::new(),
            name => format!(" of {name}"),
        };
        self.log
            .write(format_args!("session {session}{of} was opened by {by}"));
        Ok(session)
    }

    /// Starts the command with this name. `reply` receives the core's answer, or an error.
    pub(crate) fn start(&mut self, name: &str, reply: Reply) {
        let may = self.emergency.ensure_not_stopped().and_then(|()| {
            let (_, record) = self.objects.commands.find(name)?;
            record.ensure_inputs_set(name)
        });
        match may {
            Ok(()) => self
                .core
                .send_request(&self.objects.commands, name, Control::start, reply),
            Err(why) => reply(Err(why)),
        }
    }

    /// Cancels the command with this name, which must end within `grace`; `None` for the time of its session.
    pub(crate) fn cancel(&mut self, name: &str, grace: Option<Duration>, reply: Reply) {
        self.objects.commands.set_grace(name, grace);
        self.core
            .send_request(&self.objects.commands, name, Control::cancel, reply);
    }

    /// Aborts the command with this name.
    pub(crate) fn abort(&mut self, name: &str, reply: Reply) {
        let abort = |core: &mut Control, id| core.abort(id, AbortReason::Request);
        self.core
            .send_request(&self.objects.commands, name, abort, reply);
    }

    /// Unloads the command with this name. A running command is unloaded as soon as it has ended.
    pub(crate) fn unload(&mut self, name: &str, reply: Reply) {
        let commands = &mut self.objects.commands;
        let found = commands.find(name).map(|(n, record)| (n, record.runs()));
        match found {
            Ok((number, true)) => {
                commands.unload_at_end(number, &mut self.core);
                reply(Ok(String::new()));
            }
            Ok(_) => self
                .core
                .send_request(commands, name, Control::unload, reply),
            Err(why) => reply(Err(why)),
        }
    }

    /// Returns an error if `count` is more than the number of values that one request may set.
    pub(crate) fn may_set(&self, count: usize) -> Result<(), ApiError> {
        settings::may_set(count, self.limits.values_per_request)
    }

    /// Sets inputs of commands, given by command, key and literal: either all of them between the same two cycles, or
    /// none.
    pub(crate) fn set(&mut self, values: &[Value<'_>], reply: Reply) {
        let may = self
            .core
            .ensure_queue_space()
            .and_then(|()| self.may_set(values.len()));
        let commands = &mut self.objects.commands;
        match may
            .and_then(|()| settings::settings(commands, values, self.limits.values_per_request))
        {
            Ok(settings) => {
                let ticket = self.core.control.set(settings);
                if self
                    .core
                    .track_request(ticket, OnAnswer::Nothing, Some(reply))
                {
                    for value in values {
                        settings::mark_input_set(commands, value);
                    }
                }
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Makes a rule. `reply` receives the name of the rule.
    pub(crate) fn make_rule(&mut self, make: &RuleRequest<'_>, reply: Reply) {
        let may = self
            .emergency
            .ensure_not_stopped()
            .or_else(|why| match make.start {
                [] => Ok(()),
                _ => Err(why),
            });
        let commands = &mut self.objects.commands;
        let made = may
            .and_then(|()| self.core.ensure_queue_space())
            .and_then(|()| self.rules.make(make, commands, &mut self.core));
        match made {
            Ok((id, ticket)) => {
                record_end_result(make, commands);
                self.core
                    .track_request(Ok(ticket), OnAnswer::RuleMade(id), Some(reply));
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Withdraws the rule with this name, if the client may act on all commands of the rule.
    pub(crate) fn withdraw(&mut self, client: Client, name: &str, reply: Reply) {
        let found = self.core.ensure_queue_space().and_then(|()| {
            let (id, rule) = self.rules.find(name)?;
            self.objects.may_change(client, name, rule)?;
            Ok(id)
        });
        match found {
            Ok(id) => {
                let ticket = self.core.control.withdraw(id);
                self.core
                    .track_request(ticket, OnAnswer::Nothing, Some(reply));
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Subscribes to the rule with this name: reports its state now and when it changes.
    pub(crate) fn watch_rule(
        &mut self,
        name: &str,
        sink: Box<dyn Subscriber>,
    ) -> Result<(), ApiError> {
        self.rules.watch(name, sink, &mut self.objects.commands)
    }

    /// Adds a simulated device. If a device of the same name and type exists, it remains and the request succeeds.
    pub(crate) fn add_device(&mut self, new: &NewDevice<'_>, reply: Reply) {
        let added = match self.devices.is_inserted(new) {
            Ok(true) => return reply(Ok(new.name.to_owned())),
            Ok(false) => self
                .core
                .ensure_queue_space()
                .and_then(|()| self.devices.add(new)),
            Err(why) => Err(why),
        };
        match added {
            Ok((place, part, info)) => {
                let ticket = self.core.control.replace_device(place, Some(part));
                let then = OnAnswer::DeviceAdded(info);
                if !self.core.track_request(ticket, then, Some(reply)) {
                    self.devices.clear(place);
                }
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Removes a device that was added by a client and is not in use. Ended commands that used it are unloaded first.
    pub(crate) fn remove_device(&mut self, name: &str, reply: Reply) {
        // Processes events first, so that commands unloaded a moment ago do not count as users.
        self.update();
        let commands = &self.objects.commands;
        let found = self.core.ensure_queue_space();
        let found = found.and_then(|()| self.devices.removable(name, commands));
        let (place, ended) = match found {
            Ok(found) => found,
            Err(why) => return reply(Err(why)),
        };
        self.devices.clear(place);
        for number in ended {
            if let Some(record) = commands.get(number) {
                let called = record.display_name(number);
                self.log.write(format_args!(
                    "{called} is unloaded because device {name} is removed"
                ));
            }
            commands.defer(number, CommandOp::Unload, &mut self.core);
        }
        let then = OnAnswer::DeviceRemoved(name.to_owned());
        let ticket = self.core.control.replace_device(place, None);
        self.core.track_request(ticket, then, Some(reply));
    }

    /// Starts the task with this name; its first commands start in one of the next ticks. A task can be started only
    /// once.
    pub(crate) fn start_task(&mut self, name: &str) -> Result<(), ApiError> {
        self.emergency.ensure_not_stopped()?;
        self.objects.tasks.start(name)
    }

    /// Cancels the task with this name: no further command starts, and running commands are cancelled.
    pub(crate) fn cancel_task(&mut self, name: &str) -> Result<(), ApiError> {
        let number = self.objects.tasks.cancel(name)?;
        self.task_core(number)
            .with_task(|task, core| task.cancel(core));
        Ok(())
    }

    /// Unloads the task with this name. A running task is unloaded when it has ended.
    pub(crate) fn unload_task(&mut self, name: &str) -> Result<(), ApiError> {
        let number = self.objects.tasks.unload_at_end(name)?;
        self.objects.remove_task_if_abandoned(number);
        Ok(())
    }

    /// Returns the adapter through which the task with this number loads, starts and schedules its commands in the
    /// core.
    pub(super) fn task_core(&mut self, number: u64) -> TaskCoreAdapter<'_> {
        TaskCoreAdapter {
            objects: &mut self.objects,
            core: &mut self.core,
            devices: &self.devices,
            defaults: &self.defaults,
            number,
        }
    }

    /// Sets the speed override (a factor from 0 to 1) and the pause of all motions; `None` leaves a setting unchanged.
    /// `reply` is called once the core has applied them.
    ///
    /// # Errors
    /// If too many requests are pending.
    pub(crate) fn set_controls(
        &mut self,
        speed_override: Option<f64>,
        paused: Option<bool>,
        reply: Reply,
    ) -> Result<(), ApiError> {
        self.core.ensure_queue_space()?;
        let before = self.controls.current();
        let controls = MotionControls {
            speed_override: speed_override.unwrap_or(before.speed_override),
            paused: paused.unwrap_or(before.paused),
        };
        let ticket = self.core.control.set_controls(controls);
        let is_sent = self
            .core
            .track_request(ticket, OnAnswer::Nothing, Some(reply));
        if is_sent {
            self.controls.set(controls);
        }
        Ok(())
    }

    /// Aborts all commands and tasks, as requested by the named requester. `reply` is called once no earlier request
    /// can start a command any more.
    pub(crate) fn emergency_stop(&mut self, (by, origin): (&str, StopOrigin), reply: Reply) {
        let by = requester(by);
        self.statistics.emergency_stops += 1;
        self.log.write(format_args!("EMERGENCY STOP by {by}"));
        self.emergency.raise(by, origin);
        for number in self.objects.tasks.under_way() {
            self.task_core(number)
                .with_task(|task, core| task.abort(core));
        }
        self.emergency
            .send_stop_request(&mut self.core, Some(reply));
        self.emergency.notify();
    }

    /// Resets the emergency stop, so that commands can be started again. `by` is the name of the requester.
    ///
    /// # Errors
    /// If only the operator may reset the stop, a device still moves, or earlier requests are pending.
    pub(crate) fn reset_emergency(&mut self, by: &str, origin: StopOrigin) -> Result<(), ApiError> {
        if self.emergency.reset(self.devices.any_moving(), origin)? {
            self.log
                .write(format_args!("the emergency stop was reset by {by}"));
        }
        Ok(())
    }
}
