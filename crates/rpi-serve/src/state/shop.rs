//! Adapter between a running task and the control core. The task's commands are ordinary commands of the server, with
//! names that clients can watch.

use std::sync::Arc;

use rpi_core::Command;
use rpi_image::Image;
use rpi_runtime::control::{Adopted, CommandId, Rejected, Rule, RuleId, State, Ticket};
use rpi_runtime::run::{NotStarted, Plan, Task, Workshop};

use super::core_link::CoreLink;
use super::defaults::CommandDefaults;
use super::devices::Devices;
use super::objects::Objects;
use super::owed::Debt;
use super::record::Record;
use super::tasks::TaskRecord;
use super::types::Phase;

/// The core as seen by a running task.
pub(super) struct Shop<'s> {
    pub(super) objects: &'s mut Objects,
    pub(super) core: &'s mut CoreLink,
    pub(super) devices: &'s Devices,
    pub(super) defaults: &'s CommandDefaults,
    /// Number of the task.
    pub(super) number: u64,
}

impl Shop<'_> {
    /// Calls `then` with the task, if it runs.
    pub(super) fn with_task(&mut self, then: impl FnOnce(&mut Task<Plan>, &mut Shop<'_>)) {
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

    /// Loads a command of the task and sets its policies.
    fn make(&self, index: usize, image: &Arc<Image>) -> Result<Box<Command>, Rejected> {
        let command = self.devices.load(image);
        let mut command = command.map_err(Rejected::Loading)?;
        command.guard(self.defaults.continuity.unwrap_or_default());
        let record = self.objects.tasks.get(self.number);
        let on_overrun = record.map_or(self.defaults.on_overrun, |r| r.on_overrun);
        command.bound_overruns(on_overrun);
        let script = record.and_then(|r| r.script.as_ref());
        if let Some(Some(work)) = script.and_then(|s| s.work.get(index)) {
            command.bound_work(*work);
        }
        Ok(Box::new(command))
    }
}

impl Workshop for Shop<'_> {
    fn image(&self, index: usize) -> Arc<Image> {
        Arc::clone(&self.images()[index])
    }

    fn load(&mut self, index: usize) -> Result<CommandId, Rejected> {
        let image = self.image(index);
        let command = self.make(index, &image)?;
        // The image belongs to the task and is counted there.
        let bytes = command.machine().memory();
        let objects = &mut *self.objects;
        let room = objects.has_memory_left(self.number, bytes, self.core);
        room.map_err(|_| Rejected::Memory)?;
        let adopted: Adopted = self.core.control.adopt_with_board(command)?;
        let id = adopted.id;
        let task = objects.tasks.get(self.number);
        let session = task.map_or(0, |task| task.session);
        let record = Record {
            task: Some(self.number),
            text: task.map(|task| Arc::clone(&task.text)),
            ..Record::new(session, &image.name, Phase::Is(State::Loading))
        };
        let number = objects.number();
        objects.commands.insert(number, record);
        let commands = &mut objects.commands;
        commands.adopted(number, adopted, image, bytes, self.core);
        Ok(id)
    }

    fn start(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        self.core.control.start(id)
    }

    fn schedule(&mut self, rule: Rule) -> Result<(RuleId, Ticket), Rejected> {
        self.core.control.schedule(rule)
    }

    fn cancel(&mut self, id: CommandId) {
        self.core.owe_by_id(id, Debt::Cancel);
    }

    fn unload(&mut self, id: CommandId) {
        self.core.owe_by_id(id, Debt::Unload);
    }

    fn may_plan(&self, _: Option<u64>) -> bool {
        true
    }

    fn late(&mut self, in_motion: bool) {
        if let Some(record) = self.record() {
            record.status.late += 1;
            record.status.missed += u64::from(in_motion);
            record.changed = true;
        }
    }

    fn handled(&mut self, id: CommandId) {
        if let Some(record) = self.record() {
            record.status.handled(id);
        }
    }

    fn not_started(&mut self, indices: &[usize], why: NotStarted) {
        let why = match why {
            NotStarted::Refused(why) => {
                let refusal = self.objects.commands.refusal(why, self.devices);
                refusal.to_string()
            }
            other => other.to_string(),
        };
        let names = indices.iter().map(|index| self.image(*index).name.clone());
        let names = names.collect::<Vec<_>>().join(" and ");
        if let Some(record) = self.record() {
            record.status.trouble = Some(format!("cannot start {names}: {why}"));
            record.changed = true;
        }
    }
}
