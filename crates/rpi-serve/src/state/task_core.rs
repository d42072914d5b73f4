//! Adapter between a running task and the control core. The task's commands are ordinary commands of the server, with
//! names that clients can watch.

use std::sync::Arc;

use rpi_core::Command;
use rpi_image::Image;
use rpi_runtime::control::{
    AdoptedCommand, CommandId, CommandState, RequestError, Rule, RuleId, Ticket,
};
use rpi_runtime::run::{ExecutablePlan, NotStartedError, Task, TaskCore};

use super::core_link::CoreLink;
use super::defaults::CommandDefaults;
use super::deferred::CommandOp;
use super::devices::Devices;
use super::objects::Objects;
use super::record::CommandRecord;
use super::tasks::TaskRecord;
use super::types::Phase;

/// Adapter through which a running task uses the core. The commands of the task become commands of the server.
pub(super) struct TaskCoreAdapter<'s> {
    pub(super) objects: &'s mut Objects,
    pub(super) core: &'s mut CoreLink,
    pub(super) devices: &'s Devices,
    pub(super) defaults: &'s CommandDefaults,
    /// Number of the task whose commands are loaded and started through the adapter.
    pub(super) number: u64,
}

impl TaskCoreAdapter<'_> {
    /// Calls `then` with the execution state of the task and the adapter, if the task runs.
    pub(super) fn with_task(
        &mut self,
        then: impl FnOnce(&mut Task<ExecutablePlan>, &mut TaskCoreAdapter<'_>),
    ) {
        let number = self.number;
        if let Some(mut task) = self.objects.tasks.take(number) {
            then(&mut task, self);
            self.objects.tasks.put_back(number, task);
        }
    }

    fn record(&mut self) -> Option<&mut TaskRecord> {
        self.objects.tasks.get_mut(self.number)
    }

    fn images(&self) -> &[Arc<Image>] {
        let record = self.objects.tasks.get(self.number);
        let script = record.and_then(|r| r.script.as_ref());
        script.map_or(&[], |script| &script.images)
    }

    /// Loads the command with this index in the task from its image, and sets its policies.
    fn load_command(&self, index: usize, image: &Arc<Image>) -> Result<Box<Command>, RequestError> {
        let command = self.devices.load(image);
        let mut command = command.map_err(RequestError::Load)?;
        command.set_continuity(self.defaults.continuity.unwrap_or_default());
        let record = self.objects.tasks.get(self.number);
        let on_overrun = record.map_or(self.defaults.on_overrun, |r| r.on_overrun);
        command.set_overrun_policy(on_overrun);
        let script = record.and_then(|r| r.script.as_ref());
        if let Some(Some(work)) = script.and_then(|s| s.work.get(index)) {
            command.set_work_bound(*work);
        }
        Ok(Box::new(command))
    }
}

impl TaskCore for TaskCoreAdapter<'_> {
    fn image(&self, index: usize) -> Arc<Image> {
        Arc::clone(&self.images()[index])
    }

    fn load(&mut self, index: usize) -> Result<CommandId, RequestError> {
        let image = self.image(index);
        let command = self.load_command(index, &image)?;
        // The image belongs to the task and is counted there.
        let bytes = command.instance().memory();
        let resources: Vec<u32> = command.instance().resources().collect();
        let objects = &mut *self.objects;
        let room = objects.ensure_total_memory(self.number, bytes, self.core);
        room.map_err(|_| RequestError::OutOfMemoryQuota)?;
        let adopted: AdoptedCommand = self.core.control.adopt_with_snapshot(command)?;
        let id = adopted.id;
        if let Some(record) = objects.tasks.get_mut(self.number) {
            record.resources.extend(resources);
        }
        let task = objects.tasks.get(self.number);
        let session = task.map_or(0, |task| task.session);
        let record = CommandRecord {
            task: Some(self.number),
            text: task.map(|task| Arc::clone(&task.text)),
            ..CommandRecord::new(session, &image.name, Phase::Core(CommandState::Loading))
        };
        let number = objects.number();
        objects.commands.insert(number, record);
        let commands = &mut objects.commands;
        commands.register_adopted(number, adopted, image, bytes, self.core);
        Ok(id)
    }

    fn start(&mut self, id: CommandId) -> Result<Ticket, RequestError> {
        self.core.control.start(id)
    }

    fn schedule(&mut self, rule: Rule) -> Result<(RuleId, Ticket), RequestError> {
        self.core.control.schedule(rule)
    }

    fn cancel(&mut self, id: CommandId) {
        self.core.defer_by_id(id, CommandOp::Cancel);
    }

    fn unload(&mut self, id: CommandId) {
        self.core.defer_by_id(id, CommandOp::Unload);
    }

    fn can_plan(&self, _: Option<u64>) -> bool {
        true
    }

    fn report_late(&mut self, in_motion: bool) {
        if let Some(record) = self.record() {
            record.status.late += 1;
            record.status.missed_in_motion += u64::from(in_motion);
            record.changed = true;
        }
    }

    fn report_handled(&mut self, id: CommandId) {
        if let Some(record) = self.record() {
            record.status.handled(id);
        }
    }

    fn report_not_started(&mut self, indices: &[usize], why: NotStartedError) {
        let why = match why {
            NotStartedError::Refused(why) => {
                let refusal = self.objects.commands.refusal_error(why, self.devices);
                refusal.to_string()
            }
            other => other.to_string(),
        };
        let names = indices.iter().map(|index| self.image(*index).name.clone());
        let names = names.collect::<Vec<_>>().join(" and ");
        if let Some(record) = self.record() {
            record.status.error = Some(format!("cannot start {names}: {why}"));
            record.changed = true;
        }
    }
}
