//! Recording of a core whose commands are not known in advance: the part that runs in the cycle.

use std::io;

use rpi_core::{Command, CommandId, Continuity, Watch, Why};
use rpi_sim::{Cell, SimBank};

use super::recorder::{Recorder, Wanted};
use super::told::number_of;
use crate::control::{Control, Executive};
use crate::run::{DeviceTap, Sights, sample, taps};
use crate::tape::{TapeIn, Taped, tape};

/// Starts recording a core and its devices.
///
/// Returns the recorder for the host and the camera for the cycle. `continuity` is the policy of commands that have
/// none of their own.
///
/// # Errors
/// Returns the errors of the output, and an error if no thread can be created.
pub fn record(
    wanted: Wanted,
    cell: &Cell,
    (tick_ns, continuity): (u64, Continuity),
    (control, executive): (&mut Control, &mut Executive<Taped<SimBank>>),
) -> io::Result<(Recorder, Camera)> {
    let (tape_in, tape_out) = tape();
    let (taps, channels) = taps(cell, executive.plant().plant());
    executive.plant().begin();
    let recorder = Recorder::begin(wanted, (cell, &channels), (tick_ns, continuity), tape_out)?;
    control.write_down(recorder.journal());
    let camera = Camera {
        tape: tape_in,
        sights: Sights::new(&[]),
        taps,
    };
    Ok((recorder, camera))
}

/// Records each tick from within the cycle. It never allocates or blocks. A tick that does not fit on the tape is
/// dropped and counted.
pub struct Camera {
    tape: TapeIn,
    sights: Sights,
    taps: Box<[DeviceTap]>,
}

impl Camera {
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
        executive.plant().halt(number_of(why));
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
