//! The cycle's end of a recording of a core whose commands are not known beforehand.

use std::io;

use rpi_core::{Command, CommandId, Continuity, Watch, Why};
use rpi_sim::{Cell, SimBank};

use super::recorder::{Recorder, Wanted};
use super::told::number_of;
use crate::control::{Control, Executive};
use crate::run::{DeviceTap, Sights, sample, taps};
use crate::tape::{TapeIn, Taped, tape};

/// Records a core with its devices from now on: what its cycle is to do, and what its host is to tell. `continuity` is the
/// policy where a command has none of its own.
///
/// # Errors
/// Those of the file, and of the system if it gives no thread.
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

/// Takes in each tick what is to be recorded. It allocates nothing, and waits for nobody: a tick for which there is no
/// room is lost, and counted.
pub struct Camera {
    tape: TapeIn,
    sights: Sights,
    taps: Box<[DeviceTap]>,
}

impl Camera {
    /// One tick; `watch` looks on as well.
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

    /// Ends all commands after a tick.
    pub fn halt(&mut self, executive: &mut Executive<Taped<SimBank>>, why: Why) {
        executive.plant().halt(number_of(why));
        executive.halt(why);
    }

    /// The tick has ended too late: as [`Executive::too_late`].
    pub fn too_late(
        &mut self,
        executive: &mut Executive<Taped<SimBank>>,
        late: (u64, u64),
    ) -> bool {
        self.sights.overrun(late.0);
        executive.too_late(late)
    }

    /// The tick of this number is over: records it.
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

    /// How many ticks were lost.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.tape.lost()
    }
}

/// Two who look on.
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
