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

/// Table of the commands by number. A command that the core knows can also be found by its id there; each id belongs to
/// one command.
#[derive(Default)]
pub(crate) struct Commands {
    records: BTreeMap<u64, CommandRecord>,
    by_id: BTreeMap<CommandId, u64>,
}

impl Commands {
    /// Adds a command that is being loaded.
    pub(super) fn insert(&mut self, number: u64, record: CommandRecord) {
        self.records.insert(number, record);
    }

    /// Returns the command that clients address by this number; `None` if it is unknown or was removed.
    pub(super) fn get(&self, number: u64) -> Option<&CommandRecord> {
        self.records.get(&number)
    }

    /// As [`Self::get`], to change the record.
    pub(super) fn get_mut(&mut self, number: u64) -> Option<&mut CommandRecord> {
        self.records.get_mut(&number)
    }

    /// Returns all commands by number, also those for a single cycle.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u64, &CommandRecord)> + Clone {
        self.records
            .iter()
            .map(|(number, record)| (*number, record))
    }

    /// Returns a command and its number by name.
    pub(crate) fn find(&self, name: &str) -> Result<(u64, &CommandRecord), ApiError> {
        let number = parse_number(name, 'n');
        let found = number.and_then(|n| Some((n, self.records.get(&n)?)));
        found.ok_or_else(|| ApiError::Unknown(format!("command {name}")))
    }

    /// Returns all commands with their names, except those for a single cycle.
    pub(crate) fn all(&self) -> impl Iterator<Item = (String, &CommandRecord)> {
        let commands = self.records.iter().filter(|(_, r)| r.eval.is_none());
        commands.map(|(number, record)| (format!("n{number}"), record))
    }

    /// Returns the id of a command in the core.
    pub(super) fn command_id(&self, name: &str) -> Result<CommandId, ApiError> {
        let (_, record) = self.find(name)?;
        let loading = || ApiError::Invalid(format!("{name} is still being loaded"));
        record.id.ok_or_else(loading)
    }

    /// Returns the command with this id in the core.
    pub(super) fn record_of(&mut self, id: CommandId) -> Option<&mut CommandRecord> {
        let number = self.by_id.get(&id)?;
        self.records.get_mut(number)
    }

    /// Returns the command with this id in the core, and its number.
    pub(super) fn find_by_id(&self, id: CommandId) -> Option<(u64, &CommandRecord)> {
        let number = *self.by_id.get(&id)?;
        Some((number, self.records.get(&number)?))
    }

    /// Returns the numbers of the commands of a session.
    pub(super) fn of_session(&self, session: u64) -> impl Iterator<Item = (u64, &CommandRecord)> {
        self.iter().filter(move |(_, r)| r.session == session)
    }

    /// Returns whether a command runs.
    pub(super) fn any_runs(&self) -> bool {
        self.records.values().any(CommandRecord::runs)
    }

    /// Registers a command that is on its way to the core. Its loading is finished once the core has answered.
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

    /// Removes a command that could not be loaded.
    pub(super) fn remove(&mut self, number: u64) -> Option<CommandRecord> {
        self.records.remove(&number)
    }

    /// Removes a command that the core has freed.
    pub(super) fn forget(&mut self, id: CommandId) -> Option<CommandRecord> {
        let number = self.by_id.remove(&id)?;
        self.records.remove(&number)
    }

    /// Applies an operation to a command in the table, as soon as the queue has room.
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

    /// Lets a command run, or wait for its rule. A command that is only ready is unloaded.
    pub(super) fn leave_running(&mut self, number: u64, core: &mut CoreLink) {
        self.unload_at_end(number, core);
        let phase = self.records.get(&number).map(|r| r.status.phase);
        if phase == Some(Phase::Core(CommandState::Ready)) {
            self.defer(number, CommandOp::Unload, core);
        }
    }

    /// Ends a command: a running one is cancelled and then unloaded, any other one is unloaded.
    pub(super) fn cancel_and_unload(&mut self, number: u64, core: &mut CoreLink) {
        let phase = self.records.get(&number).map(|r| r.status.phase);
        self.unload_at_end(number, core);
        match phase {
            Some(Phase::Core(CommandState::Running)) => self.defer(number, CommandOp::Cancel, core),
            Some(Phase::Core(_)) => self.defer(number, CommandOp::Unload, core),
            _ => {}
        }
    }

    /// Unloads a command whose session has left it behind, once it can be unloaded.
    pub(super) fn unload_if_abandoned(&self, id: CommandId, core: &mut CoreLink) {
        let found = self.find_by_id(id);
        if found.is_some_and(|(_, r)| r.unload_at_end && r.eval.is_none()) {
            core.defer_by_id(id, CommandOp::Unload);
        }
    }

    /// Subscribes to a command: reports its state now and at each change, and its exports.
    pub(crate) fn watch(&mut self, name: &str, watching: WatchRequest) -> Result<(), ApiError> {
        let (number, _) = self.find(name)?;
        if let Some(record) = self.records.get_mut(&number) {
            let exported = Exported::new(record.snapshot.as_deref(), record.image.as_deref());
            let subscriptions = &mut record.subscriptions;
            subscriptions.add(watching, &record.status, &exported);
        }
        Ok(())
    }

    /// Sets the time in which a command must end after a cancel request.
    pub(super) fn set_grace(&mut self, name: &str, grace: Option<Duration>) {
        let found = self.find(name).map(|(number, _)| number);
        let record = found.ok().and_then(|number| self.records.get_mut(&number));
        if let Some(record) = record {
            record.grace = grace.or(record.grace);
        }
    }

    /// Aborts the cancelled commands that have not ended in time.
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

    /// Reports changed exports to all subscriptions that are due.
    pub(super) fn publish(&mut self) {
        let now = Instant::now();
        self.records.values_mut().for_each(|r| r.publish(now));
    }

    /// Removes the subscriptions of disconnected clients.
    pub(super) fn remove_disconnected(&mut self) {
        let records = self.records.values_mut();
        records.for_each(|r| r.subscriptions.drop_disconnected());
    }

    /// Converts a refusal of the core to an error with the display names of actuator and command.
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
