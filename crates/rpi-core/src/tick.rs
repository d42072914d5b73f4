//! One tick of the control core.

use crate::command::{AbortReason, Command};
use crate::command_table::Entry;
use crate::continuity::Continuity;
use crate::control_core::Core;
use crate::cycle_context::CycleContext;
use crate::decision::Decision;
use crate::ids::CommandId;
use crate::lifecycle::CommandState;
use crate::notice::Notice;
use crate::schedule::Schedule;
use rpi_device::DeviceBank;

/// Observer of commands at the end of each of their cycles, for recording, publishing and statistics.
///
/// The methods run on the thread of the cycle. They must not allocate, lock or wait.
pub trait CycleObserver {
    /// Receives a command after each of its cycles, when all its flows can be read.
    fn cycle_finished(&mut self, id: CommandId, command: &Command);

    /// Receives the id of each command just before its evaluation, and `None` after the last command, to measure
    /// computing times.
    fn evaluation_starts(&mut self, _next: Option<CommandId>) {}

    /// Receives each command after its evaluation, before its delays are stored: the values are those of the cycle.
    fn evaluated(&mut self, _id: CommandId, _command: &Command) {}
}

/// Observer that ignores all calls.
impl CycleObserver for () {
    fn cycle_finished(&mut self, _: CommandId, _: &Command) {}
}

impl Core {
    /// Runs one tick: every command that is due runs one cycle, then rules fire. `wall_ns` is the wall-clock time in
    /// nanoseconds since the Unix epoch; `watch` observes the commands.
    pub fn tick(&mut self, bank: &mut dyn DeviceBank, wall_ns: i64, watch: &mut dyn CycleObserver) {
        let now = self.tick;
        self.latch_inputs(bank, wall_ns);
        // Phase by phase over all commands, not command by command: all sensors are latched before the first set-point
        // is sent, so that no command sees effects of another one in the same tick.
        for_each_due(&mut self.schedule, now, |c| {
            c.instance.read(bank, &c.context)
        });
        self.evaluate(bank, watch);
        for_each_due(&mut self.schedule, now, |c| c.instance.commit());
        for_each_due(&mut self.schedule, now, |c| c.hand_over(bank));
        for_each_due(&mut self.schedule, now, Command::latch_exports);
        self.notify_observer(watch);
        self.decide(bank);
        self.tick += 1;
    }

    /// Sets the inputs from the core (times, cancel, takeover, controls) for each command that is due. Requests that
    /// arrive later take effect in the next cycle.
    fn latch_inputs(&mut self, bank: &mut dyn DeviceBank, wall_ns: i64) {
        for place in 0..self.schedule.commands.len() {
            let entry = self.schedule.commands.get(place);
            if !entry.is_some_and(|e| is_due(e, self.tick)) {
                continue;
            }
            let covered = self.schedule.latch_takeover(place, bank);
            let Some(entry) = self.schedule.commands.get_mut(place) else {
                continue;
            };
            let (cycle, command) = (entry.command.instance.cycle(), &mut entry.command);
            if cycle == 0 {
                entry.start_ns = wall_ns;
                let ticks = u32::try_from(entry.period_ticks).unwrap_or(u32::MAX);
                command
                    .resources()
                    .for_each(|r| bank.begin_command(r, ticks));
            }
            let since = cycle.saturating_mul(command.instance.image().period_ns);
            command.context = CycleContext {
                net_ns: entry.start_ns.saturating_add_unsigned(since),
                wall_ns,
                cancel: command.state == CommandState::Cancelling,
                takeover: covered,
                predecessor: command.context.predecessor,
                controls: self.controls,
            };
        }
    }

    /// Evaluates every command that is due, in the order of the table.
    fn evaluate(&mut self, bank: &mut dyn DeviceBank, watch: &mut dyn CycleObserver) {
        for (place, entry) in self.schedule.commands.entries.iter_mut().enumerate() {
            let Some(entry) = entry.as_mut().filter(|e| is_due(e, self.tick)) else {
                continue;
            };
            watch.evaluation_starts(Some(entry.id(place)));
            entry.command.instance.evaluate(bank);
            watch.evaluated(entry.id(place), &entry.command);
        }
        watch.evaluation_starts(None);
    }

    /// Passes to the observer each command that has run a cycle in this tick.
    fn notify_observer(&self, watch: &mut dyn CycleObserver) {
        for (place, entry) in self.schedule.commands.entries.iter().enumerate() {
            if let Some(entry) = entry.as_ref().filter(|e| is_due(e, self.tick)) {
                watch.cycle_finished(entry.id(place), &entry.command);
            }
        }
    }

    /// Decides what happens after the cycles of this tick: first commands end, then rules fire.
    fn decide(&mut self, bank: &mut dyn DeviceBank) {
        let now = self.tick;
        let mut stop = false;
        let mut decision = Decision::new(&mut self.schedule, bank, now);
        for place in 0..decision.schedule.commands.len() {
            let entry = decision.schedule.commands.get_mut(place);
            let Some(entry) = entry.filter(|e| is_due(e, now)) else {
                continue;
            };
            let command = entry.id(place);
            entry.due += entry.period_ticks;
            if let Some(jump) = entry.command.instance.take_discontinuity() {
                decision.schedule.notices.push(Notice::Discontinuity {
                    command,
                    discontinuity: jump,
                });
                stop |= entry.command.continuity == Continuity::AbortAll;
            }
            if let Some(ending) = entry.command.ending_now() {
                decision.end_command(place, ending);
            }
        }
        match stop {
            true => decision.abort_all(AbortReason::Discontinuity),
            false => decision.fire_all(now + 1),
        }
        decision.conclude();
    }
}

/// Runs one phase of the cycle (read, evaluate, commit, hand over) for each command that is due in tick `tick`.
fn for_each_due(schedule: &mut Schedule, tick: u64, mut phase: impl FnMut(&mut Command)) {
    for entry in schedule
        .commands
        .entries
        .iter_mut()
        .flatten()
        .filter(|e| is_due(e, tick))
    {
        phase(&mut entry.command);
    }
}

fn is_due(entry: &Entry, tick: u64) -> bool {
    entry.command.state.is_running() && entry.due == tick
}
