//! The cycle's thread: one tick after the other, orders in between.
//!
//! It owns the core and the devices. Nothing here allocates, frees, locks, waits for anybody or formats text.

use std::sync::Arc;

use rpi_core::{Command, CommandId, Core, Refused, Watch};
use rpi_sim::SimBank;

use super::board::Board;
use super::clock::Clock;
use super::links::{CycleEnds, Order, Report, Spent};

/// Orders taken between two ticks, so that a flood of them cannot stretch a cycle.
const ORDERS: usize = 16;
/// Reports that one order can bring at once: what it leaves over, and its answer.
const PER_ORDER: usize = 2;

/// The core, the devices and what connects them to the desk.
pub(crate) struct Cycle {
    core: Core,
    bank: SimBank,
    clock: Clock,
    ends: CycleEnds,
    publisher: Publisher,
}

/// Copies what commands export onto their boards, and lets another look too.
struct Publisher {
    /// By the commands' places.
    boards: Box<[Option<Arc<Board>>]>,
    also: Box<dyn Watch + Send>,
}

impl Watch for Publisher {
    fn cycle(&mut self, id: CommandId, command: &Command) {
        if let Some(Some(board)) = self.boards.get(place(id)) {
            board.write(command);
        }
        self.also.cycle(id, command);
    }
}

/// The place of a command in the core's table.
fn place(id: CommandId) -> usize {
    (id.number() & u64::from(u32::MAX)) as usize
}

impl Cycle {
    /// `also` looks at each command after each of its cycles, on the cycle's thread: see [`Watch`].
    pub(crate) fn new(
        commands: usize,
        bank: SimBank,
        clock: Clock,
        ends: CycleEnds,
        also: Box<dyn Watch + Send>,
    ) -> Cycle {
        Cycle {
            core: Core::with_capacity(commands, clock.tick_ns()),
            bank,
            clock,
            ends,
            publisher: Publisher {
                boards: (0..commands).map(|_| None).collect(),
                also,
            },
        }
    }

    /// Orders, one tick, reports.
    pub(crate) fn tick(&mut self) {
        for _ in 0..ORDERS {
            if self.ends.reports.slots() < PER_ORDER {
                break;
            }
            let Ok((number, order)) = self.ends.orders.pop() else {
                break;
            };
            let answer = self.obey(order);
            self.tell(Report::Answer(number, answer));
        }
        self.report();
        let now = self.core.now();
        self.clock.wait(now);
        let wall_ns = self.clock.wall_ns(now);
        self.core.tick(&mut self.bank, wall_ns, &mut self.publisher);
        self.bank.step();
        self.report();
    }

    fn obey(&mut self, order: Order) -> Result<(), Refused> {
        let bank = &mut self.bank;
        match order {
            Order::Insert(id, command, board) => self.insert(id, command, board),
            Order::Start(id) => self.core.start(id, bank),
            Order::Cancel(id) => self.core.cancel(id),
            Order::Abort(id, why) => self.core.abort(id, why, bank),
            Order::Unload(id) => {
                let command = self.core.remove(id)?;
                self.bury(id, command);
                Ok(())
            }
            Order::Rule(id, rule) => {
                let made = self.core.schedule_as(id, rule, bank);
                made.map_err(|(rule, why)| {
                    self.tell(Report::Spent(Spent::Rule(rule)));
                    why
                })
            }
            Order::Withdraw(id) => self.core.withdraw(id),
            Order::Set(settings) => {
                for setting in &settings {
                    if let Some(command) = self.core.command_mut(setting.command) {
                        command.set_input(setting.input, &setting.value);
                    }
                }
                self.tell(Report::Spent(Spent::Settings(settings)));
                Ok(())
            }
            Order::Device(place, part) => {
                if let Some(part) = bank.swap(place, part) {
                    self.tell(Report::Spent(Spent::Part(part)));
                }
                Ok(())
            }
        }
    }

    fn insert(
        &mut self,
        id: CommandId,
        command: Box<Command>,
        board: Arc<Board>,
    ) -> Result<(), Refused> {
        match self.core.insert_as(id, command) {
            Ok(()) => {
                if let Some(own) = self.publisher.boards.get_mut(place(id)) {
                    *own = Some(board);
                }
                Ok(())
            }
            Err((command, why)) => {
                self.tell(Report::Gone(id, Spent::Command(command, Some(board))));
                Err(why)
            }
        }
    }

    fn bury(&mut self, id: CommandId, command: Box<Command>) {
        let board = self.publisher.boards.get_mut(place(id));
        let board = board.and_then(Option::take);
        self.tell(Report::Gone(id, Spent::Command(command, board)));
    }

    /// Tells what there is room for; the rest waits inside of the core.
    fn report(&mut self) {
        while !self.ends.reports.is_full() {
            if let Some(notice) = self.core.next_notice() {
                self.tell(Report::Notice(notice));
            } else if let Some((id, command)) = self.core.take_gone() {
                self.bury(id, command);
            } else if let Some((_, rule)) = self.core.take_spent() {
                self.tell(Report::Spent(Spent::Rule(rule)));
            } else {
                return;
            }
        }
    }

    /// There is room: everybody who calls this has looked.
    fn tell(&mut self, report: Report) {
        if let Err(rtrb::PushError::Full(report)) = self.ends.reports.push(report) {
            // Freeing here would take locks of the allocator; leaking does not.
            std::mem::forget(report);
        }
    }
}
