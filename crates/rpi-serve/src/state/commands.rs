//! The loaded commands and their life, from loading until the core has freed them.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use rpi_image::Image;
use rpi_runtime::control::{AbortReason, AdoptedCommand, CommandError, CommandId, CommandState};

use super::core_link::CoreLink;
use super::deferred::CommandOp;
use super::devices::Devices;
use super::event_log::EventLog;
use super::parse_number;
use super::pending::OnAnswer;
use super::record::CommandRecord;
use super::subscriptions::{Exported, WatchRequest};
use super::types::{ApiError, Phase};

/// Table of the loaded commands by the number in their names (`n12` has number 12). A command that the core knows can
/// also be found by its id in the core.
#[derive(Default)]
pub(crate) struct Commands {
    records: BTreeMap<u64, CommandRecord>,
    by_id: BTreeMap<CommandId, u64>,
}

impl Commands {
    /// Adds the record of a command that is being loaded.
    pub(super) fn insert(&mut self, number: u64, record: CommandRecord) {
        self.records.insert(number, record);
    }

    /// Returns the record of the command with this number; `None` if the command is unknown or was removed.
    pub(super) fn get(&self, number: u64) -> Option<&CommandRecord> {
        self.records.get(&number)
    }

    /// Returns the record of the command with this number, to change it; `None` if there is no such command.
    pub(super) fn get_mut(&mut self, number: u64) -> Option<&mut CommandRecord> {
        self.records.get_mut(&number)
    }

    /// Returns all commands with their numbers, including those that only evaluate a net for a single cycle.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u64, &CommandRecord)> + Clone {
        self.records
            .iter()
            .map(|(number, record)| (*number, record))
    }

    /// Returns the number and the record of the command with this name, or an error if the name is unknown.
    pub(crate) fn find(&self, name: &str) -> Result<(u64, &CommandRecord), ApiError> {
        let number = parse_number(name, 'n');
        let found = number.and_then(|n| Some((n, self.records.get(&n)?)));
        found.ok_or_else(|| ApiError::Unknown(format!("command {name}")))
    }

    /// Returns all commands with their names, except those that only evaluate a net for a single cycle.
    pub(crate) fn all(&self) -> impl Iterator<Item = (String, &CommandRecord)> {
        let commands = self.records.iter().filter(|(_, r)| r.eval.is_none());
        commands.map(|(number, record)| (format!("n{number}"), record))
    }

    /// Returns the id in the core of the command with this name, or an error if the command is unknown or still being
    /// loaded.
    pub(super) fn command_id(&self, name: &str) -> Result<CommandId, ApiError> {
        let (_, record) = self.find(name)?;
        let loading = || ApiError::Invalid(format!("{name} is still being loaded"));
        record.id.ok_or_else(loading)
    }

    /// Returns the record of the command with this id in the core, to change it; `None` if there is no such command.
    pub(super) fn record_of(&mut self, id: CommandId) -> Option<&mut CommandRecord> {
        let number = self.by_id.get(&id)?;
        self.records.get_mut(number)
    }

    /// Returns the number and the record of the command with this id in the core; `None` if there is no such command.
    pub(super) fn find_by_id(&self, id: CommandId) -> Option<(u64, &CommandRecord)> {
        let number = *self.by_id.get(&id)?;
        Some((number, self.records.get(&number)?))
    }

    /// Returns the commands of the session with this number, each with its own number.
    pub(super) fn of_session(&self, session: u64) -> impl Iterator<Item = (u64, &CommandRecord)> {
        self.iter().filter(move |(_, r)| r.session == session)
    }

    /// Returns whether any command runs or is being cancelled.
    pub(super) fn any_runs(&self) -> bool {
        self.records.values().any(CommandRecord::runs)
    }

    /// Registers the core's id and the image of a command that was sent to the core. `bytes` is its memory. The loading
    /// is finished once the core has answered that the command is in its table.
    pub(super) fn register_adopted(
        &mut self,
        number: u64,
        adopted: AdoptedCommand,
        image: Arc<Image>,
        bytes: usize,
        core: &mut CoreLink,
    ) {
        let AdoptedCommand {
            id,
            ticket,
            snapshot,
        } = adopted;
        self.by_id.insert(id, number);
        let mut reply = None;
        if let Some(record) = self.records.get_mut(&number) {
            record.id = Some(id);
            record.bytes += bytes;
            record.image = Some(image);
            record.snapshot = Some(snapshot);
            reply = record.loading.take();
        }
        core.track_request(Ok(ticket), OnAnswer::CommandInserted(number), reply);
    }

    /// Removes the command with this number, which could not be loaded, and returns its record.
    pub(super) fn remove(&mut self, number: u64) -> Option<CommandRecord> {
        self.records.remove(&number)
    }

    /// Removes the command with this id, which the core has freed, and returns its record.
    pub(super) fn forget(&mut self, id: CommandId) -> Option<CommandRecord> {
        let number = self.by_id.remove(&id)?;
        self.records.remove(&number)
    }

    /// Sends an operation on the command with this number to the core as soon as the request queue has room.
    pub(super) fn defer(&self, number: u64, op: CommandOp, core: &mut CoreLink) {
        if let Some(id) = self.records.get(&number).and_then(|r| r.id) {
            core.defer_by_id(id, op);
        }
    }

    /// Unloads a command as soon as it has ended.
    pub(super) fn unload_at_end(&mut self, number: u64, core: &mut CoreLink) {
        let Some(record) = self.records.get_mut(&number) else {
            return;
        };
        record.unload_at_end = true;
        if record.has_ended() {
            self.defer(number, CommandOp::Unload, core);
        }
    }

    /// Lets a command of a closed session run, or wait for the rule that starts it, and unloads the command at its end.
    /// A command that is ready but not scheduled is unloaded now.
    pub(super) fn leave_running(&mut self, number: u64, core: &mut CoreLink) {
        self.unload_at_end(number, core);
        let phase = self.records.get(&number).map(|r| r.status.phase);
        if phase == Some(Phase::Core(CommandState::Ready)) {
            self.defer(number, CommandOp::Unload, core);
        }
    }

    /// Cancels a command if it runs, and unloads it at its end. A command that does not run is unloaded now.
    pub(super) fn cancel_and_unload(&mut self, number: u64, core: &mut CoreLink) {
        let phase = self.records.get(&number).map(|r| r.status.phase);
        self.unload_at_end(number, core);
        match phase {
            Some(Phase::Core(CommandState::Running)) => self.defer(number, CommandOp::Cancel, core),
            Some(Phase::Core(_)) => self.defer(number, CommandOp::Unload, core),
            _ => {}
        }
    }

    /// Unloads a command that has ended or can no longer be started, if it is marked to be unloaded because its session
    /// was closed or its client asked for it.
    pub(super) fn unload_if_abandoned(&self, id: CommandId, core: &mut CoreLink) {
        let found = self.find_by_id(id);
        if found.is_some_and(|(_, r)| r.unload_at_end && r.eval.is_none()) {
            core.defer_by_id(id, CommandOp::Unload);
        }
    }

    /// Subscribes a client to the command with this name: reports the command's state and exports now and at each
    /// change.
    pub(crate) fn watch(&mut self, name: &str, watching: WatchRequest) -> Result<(), ApiError> {
        let (number, _) = self.find(name)?;
        if let Some(record) = self.records.get_mut(&number) {
            let exported = Exported::new(record.snapshot.as_deref(), record.image.as_deref());
            let subscriptions = &mut record.subscriptions;
            subscriptions.add(watching, &record.status, &exported);
        }
        Ok(())
    }

    /// Sets the grace time of the command with this name: the time within which it must end after a cancel request.
    /// `None` leaves the time unchanged.
    pub(super) fn set_grace(&mut self, name: &str, grace: Option<Duration>) {
        let found = self.find(name).map(|(number, _)| number);
        let record = found.ok().and_then(|number| self.records.get_mut(&number));
        if let Some(record) = record {
            record.grace = grace.or(record.grace);
        }
    }

    /// Aborts the cancelled commands that have not ended within their grace times.
    pub(super) fn abort_overdue(&mut self, core: &mut CoreLink, log: &mut EventLog) {
        let now = Instant::now();
        for (number, record) in &mut self.records {
            let is_overdue = record.deadline.is_some_and(|deadline| deadline <= now);
            if !is_overdue {
                continue;
            }
            record.deadline = None;
            if let Some(id) = record.id.filter(|_| record.runs()) {
                let name = record.display_name(*number);
                log.write(format_args!(
                    "{name} had not ended within the grace time after its cancel; it was aborted"
                ));
                core.defer_by_id(id, CommandOp::Abort(AbortReason::CancelTimeout));
            }
        }
    }

    /// Reports changed exports of all commands to the subscribers whose update periods have elapsed.
    pub(super) fn publish(&mut self) {
        let now = Instant::now();
        self.records.values_mut().for_each(|r| r.publish(now));
    }

    /// Removes the subscriptions of disconnected clients from all commands.
    pub(super) fn remove_disconnected(&mut self) {
        let records = self.records.values_mut();
        records.for_each(|r| r.subscriptions.drop_disconnected());
    }

    /// Converts the reason for which the core refused a request to an error for the client, with the display names of
    /// the held actuator and of the command that holds it.
    pub(super) fn refusal_error(&self, why: CommandError, devices: &Devices) -> ApiError {
        let CommandError::ResourceHeld { resource, by } = why else {
            return ApiError::Refused(why);
        };
        let actuator = devices.actuator_name(resource);
        ApiError::ResourceHeld(match self.find_by_id(by) {
            Some((number, record)) => {
                let title = record.title.as_str();
                let gap = if title.is_empty() { "" } else { " " };
                format!("{actuator} is held by {title}{gap}n{number}")
            }
            None => format!("{actuator} is held by another command"),
        })
    }
}
