//! Adapter between a running task and the server state. The task's commands are ordinary commands of the server, with
//! names that clients can watch.

use std::sync::{Arc, PoisonError};

use rpi_core::Command;
use rpi_image::Image;
use rpi_runtime::control::{Adopted, CommandId, Rejected, Rule, RuleId, State, Ticket};
use rpi_runtime::run::{NotStarted, Workshop};

use super::commands::Record;
use super::owed::Debt;
use super::tasks::TaskRecord;
use super::{Desk, Phase};

/// The core as seen by a running task.
pub(super) struct Shop<'d> {
    pub(super) desk: &'d mut Desk,
    /// Number of the task.
    pub(super) number: u64,
}

impl Shop<'_> {
    fn record(&mut self) -> Option<&mut TaskRecord> {
        self.desk.tasks.get_mut(&self.number)
    }

    fn images(&self) -> &[Arc<Image>] {
        let record = self.desk.tasks.get(&self.number);
        let script = record.and_then(|r| r.script.as_ref());
        script.map_or(&[], |script| &script.images)
    }

    /// Loads a command of the task and sets its policies.
    fn make(&self, index: usize, image: &Arc<Image>) -> Result<Box<Command>, Rejected> {
        let twin = self.desk.twin.lock();
        let mut twin = twin.unwrap_or_else(PoisonError::into_inner);
        let command = Command::load(Arc::clone(image), &mut twin.bank);
        let mut command = command.map_err(Rejected::Loading)?;
        command.guard(self.desk.continuity.unwrap_or_default());
        let record = self.desk.tasks.get(&self.number);
        let on_overrun = record.map_or(self.desk.on_overrun, |r| r.on_overrun);
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
        let room = self.desk.has_memory_left(self.number, bytes);
        room.map_err(|_| Rejected::Memory)?;
        let adopted: Adopted = self.desk.control.adopt_with_board(command)?;
        let id = adopted.id;
        let task = self.record();
        let session = task.as_ref().map_or(0, |task| task.session);
        let text = task.map(|task| Arc::clone(&task.text));
        let number = self.desk.number();
        let record = Record {
            task: Some(self.number),
            text,
            ..Record::new(session, &image.name, Phase::Is(State::Loading))
        };
        self.desk.commands.insert(number, record);
        self.desk.adopted(number, adopted, image, bytes);
        Ok(id)
    }

    fn start(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        self.desk.control.start(id)
    }

    fn schedule(&mut self, rule: Rule) -> Result<(RuleId, Ticket), Rejected> {
        self.desk.control.schedule(rule)
    }

    fn cancel(&mut self, id: CommandId) {
        self.desk.owe_by_id(id, Debt::Cancel);
    }

    fn unload(&mut self, id: CommandId) {
        self.desk.owe_by_id(id, Debt::Unload);
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
            let mut steps = record.status.steps.iter_mut().rev();
            steps
                .find(|step| step.id == id)
                .into_iter()
                .for_each(|step| step.handled = true);
        }
    }

    fn not_started(&mut self, indices: &[usize], why: NotStarted) {
        let why = match why {
            NotStarted::Refused(why) => self.desk.refusal(why).to_string(),
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
