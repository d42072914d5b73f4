//! Recording of a core whose commands are not known in advance: the part that runs in the cycle.

use rpi_core::{Command, CommandId, Watch, Why};
use rpi_sim::{Cell, SimBank};

use super::cycle::DeviceTap;
use super::devices::{sample, taps};
use super::samples::Channel;
use super::sights::Sights;
use crate::control::Executive;
use crate::tape::{TapeIn, TapeOut, Taped, tape};

/// Records each tick from within the cycle. It never allocates or blocks. A tick that does not fit on the tape is
/// dropped and counted.
pub struct Camera {
    tape: TapeIn,
    sights: Sights,
    taps: Box<[DeviceTap]>,
}

impl Camera {
    /// Starts logging the devices of an executive. Returns the camera, the end of its tape for the recorder, and the
    /// device ports that are sampled after each tick.
    pub fn begin(
        cell: &Cell,
        executive: &mut Executive<Taped<SimBank>>,
    ) -> (Camera, TapeOut, Vec<Channel>) {
        let (tape_in, tape_out) = tape();
        let (taps, channels) = taps(cell, executive.plant().plant());
        executive.plant().begin();
        let camera = Camera {
            tape: tape_in,
            sights: Sights::new(&[]),
            taps,
        };
        (camera, tape_out, channels)
    }

    /// Executes one tick of the executive and records its flows. `watch` observes the tick as well.
    pub fn tick(
        &mut self,
        executive: &mut Executive<Taped<SimBank>>,
        wall_ns: i64,
        watch: &mut dyn Watch,
    ) {
        self.sights.begin();
        let mut both = Both(&mut self.sights, watch);
        executive.tick(wall_ns, &mut both);
    }

    /// Ends all commands after a tick and records the reason.
    pub fn halt(&mut self, executive: &mut Executive<Taped<SimBank>>, why: Why) {
        executive.plant().halt(why);
        executive.halt(why);
    }

    /// Records that the tick ended too late, then calls [`Executive::too_late`].
    pub fn too_late(
        &mut self,
        executive: &mut Executive<Taped<SimBank>>,
        late: (u64, u64),
    ) -> bool {
        self.sights.overrun(late.0);
        executive.too_late(late)
    }

    /// Records the tick with this number once it has ended.
    pub fn take(
        &mut self,
        executive: &mut Executive<Taped<SimBank>>,
        (number, wall_ns): (u64, i64),
    ) {
        for tap in &mut self.taps {
            sample(tap, executive.plant().plant(), |channel, value| {
                self.sights.sample(channel, value);
            });
        }
        if let Some(exchange) = executive.plant().stage() {
            self.tape
                .put((number, wall_ns), true, exchange, self.sights.stage());
            exchange.clear();
        }
    }

    /// Returns the number of ticks that were lost.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.tape.lost()
    }
}

/// Forwards each notification to two observers.
struct Both<'a>(&'a mut Sights, &'a mut dyn Watch);

impl Watch for Both<'_> {
    fn cycle(&mut self, id: CommandId, command: &Command) {
        self.0.cycle(id, command);
        self.1.cycle(id, command);
    }

    fn turn(&mut self, next: Option<CommandId>) {
        self.1.turn(next);
    }
}
