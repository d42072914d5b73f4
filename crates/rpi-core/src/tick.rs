//! One tick of the control core.

use crate::command::{Command, Why};
use crate::commands::{Core, Entry};
use crate::continuity::Continuity;
use crate::id::CommandId;
use crate::lifecycle::State;
use crate::machine::Moment;
use crate::notice::Notice;
use rpi_device::DeviceBank;

/// Observer of commands at the end of each of their cycles, for recording, publishing and statistics.
///
/// The methods run on the thread of the cycle. They must not allocate, lock or wait.
pub trait Watch {
    /// Called after each cycle of a command, when all its flows can be read.
    fn cycle(&mut self, id: CommandId, command: &Command);

    /// Called before each command is evaluated, and with `None` after the last one. For measuring computing times.
    fn turn(&mut self, _next: Option<CommandId>) {}
}

/// Observer that does nothing.
impl Watch for () {
    fn cycle(&mut self, _: CommandId, _: &Command) {}
}

impl Core {
    /// Runs one tick: every command that is due runs one cycle. `wall_ns` is the wall-clock time in nanoseconds since
    /// the Unix epoch.
    pub fn tick(&mut self, bank: &mut dyn DeviceBank, wall_ns: i64, watch: &mut dyn Watch) {
        let now = self.tick;
        self.tell(bank, wall_ns);
        // Phase by phase over all commands, not command by command: all sensors are latched before the first set-point
        // is sent, so that no command sees effects of another one in the same tick.
        due(&mut self.entries, now, |c| c.machine.read(bank, &c.moment));
        self.evaluate(bank, watch);
        due(&mut self.entries, now, |c| c.machine.commit());
        due(&mut self.entries, now, |c| c.hand_over(bank));
        due(&mut self.entries, now, Command::show);
        self.publish(watch);
        self.decide(bank);
        self.tick += 1;
    }

    /// Sets the core's inputs for each command that is due. Requests that arrive later take effect in the next cycle.
    fn tell(&mut self, bank: &mut dyn DeviceBank, wall_ns: i64) {
        for place in 0..self.entries.len() {
            if !self.entries[place]
                .as_ref()
                .is_some_and(|e| is_due(e, self.tick))
            {
                continue;
            }
            let covered = self.latch_cover(place, bank);
            let entry = self.entries[place].as_mut();
            let Some(entry) = entry else {
                continue;
            };
            let (cycle, command) = (entry.command.machine.cycle(), &mut entry.command);
            if cycle == 0 {
                entry.start_ns = wall_ns;
                let ticks = u32::try_from(entry.ticks).unwrap_or(u32::MAX);
                command.resources().for_each(|r| bank.begin(r, ticks));
            }
            let since = cycle.saturating_mul(command.machine.image().period_ns);
            command.moment = Moment {
                net_ns: entry.start_ns.saturating_add_unsigned(since),
                wall_ns,
                cancel: command.state == State::Cancelling,
                takeover: covered,
                predecessor: command.moment.predecessor,
            };
        }
    }

    /// Evaluates every command that is due, in the order of the table.
    fn evaluate(&mut self, bank: &mut dyn DeviceBank, watch: &mut dyn Watch) {
        for (place, entry) in self.entries.iter_mut().enumerate() {
            let Some(entry) = entry.as_mut().filter(|e| is_due(e, self.tick)) else {
                continue;
            };
            watch.turn(Some(entry.id(place)));
            entry.command.machine.evaluate(bank);
        }
        watch.turn(None);
    }

    fn publish(&self, watch: &mut dyn Watch) {
        for (place, entry) in self.entries.iter().enumerate() {
            if let Some(entry) = entry.as_ref().filter(|e| is_due(e, self.tick)) {
                watch.cycle(self.id(place), &entry.command);
            }
        }
    }

    /// Decides what happens after this cycle: first ends of commands, then firing of rules.
    fn decide(&mut self, bank: &mut dyn DeviceBank) {
        let now = self.tick;
        let mut stop = false;
        for place in 0..self.entries.len() {
            let command = self.id(place);
            let entry = self.entries[place].as_mut();
            let Some(entry) = entry.filter(|e| is_due(e, now)) else {
                continue;
            };
            entry.due += entry.ticks;
            if let Some(jump) = entry.command.machine.take_jump() {
                self.notices.push(Notice::Jumped { command, jump });
                stop |= entry.command.continuity == Continuity::Stop;
            }
            if let Some(ending) = entry.command.ends() {
                self.leave(place, ending);
            }
        }
        match stop {
            true => self.stop_all(Why::Discontinuity, bank),
            false => self.fire_all(now + 1, bank),
        }
    }
}

/// Runs one phase of the cycle for each command that is due.
fn due(entries: &mut [Option<Entry>], tick: u64, mut phase: impl FnMut(&mut Command)) {
    for entry in entries.iter_mut().flatten().filter(|e| is_due(e, tick)) {
        phase(&mut entry.command);
    }
}

fn is_due(entry: &Entry, tick: u64) -> bool {
    entry.command.state.runs() && entry.due == tick
}
