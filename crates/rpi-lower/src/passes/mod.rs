//! Optimisation passes that do not change a bit of the outputs. One file per pass; [`PASSES`] has the order.
//!
//! Invariants of every pass: operations that may fault or reach a device are kept, in their relative order; exports,
//! results and set-points keep their bits; each register has one writer, which runs before its readers.

mod coalesce;
mod cse;
mod dce;
mod delays;
mod fold;
mod fuse;
mod identities;
mod list_schedule;
mod sensors;
mod substitution;
pub(crate) mod traversal;

use crate::flat_net::FlatNet;
use rpi_prims::CycleTime;

/// Optimisation pass over a flat net, which changes the net in place but not a bit of its outputs.
pub(crate) struct Pass {
    /// Name of the pass in messages and listings, such as `fold`.
    pub(crate) name: &'static str,
    /// One line that says what the pass does, such as "read each device port once per cycle".
    pub(crate) description: &'static str,
    pub(crate) run: fn(&mut FlatNet, CycleTime),
}

const FOLD: Pass = Pass {
    name: "fold",
    description: "evaluate constant expressions at compile time",
    run: fold::fold,
};

/// All optimisation passes in the order in which they run. A pass can occur more than once.
pub(crate) const PASSES: &[Pass] = &[
    Pass {
        name: "sensors",
        description: "read each device port once per cycle",
        run: sensors::merge_sensors,
    },
    FOLD,
    Pass {
        name: "start",
        description: "turn a constant first value into the initial content of its delay",
        run: delays::fold_initial_values,
    },
    FOLD,
    Pass {
        name: "share",
        description: "compute common subexpressions once",
        run: cse::eliminate,
    },
    Pass {
        name: "direct",
        description: "read delayed values directly from the state",
        run: delays::read_state_directly,
    },
    Pass {
        name: "dead",
        description: "remove computations without an effect",
        run: dce::remove,
    },
    Pass {
        name: "fuse",
        description: "fuse two primitives if one feeds only the other",
        run: fuse::fuse,
    },
    Pass {
        name: "rows",
        description: "group calls of the same primitive",
        run: list_schedule::arrange,
    },
    Pass {
        name: "coalesce",
        description: "compute a value directly in the state of its delay",
        run: coalesce::coalesce,
    },
];

/// Runs all optimisation passes on a flat net and calls `check` with the net after each. `clock` has the times that
/// constant folding uses.
pub(crate) fn run(flat: &mut FlatNet, clock: CycleTime, mut check: impl FnMut(&FlatNet, &Pass)) {
    for pass in PASSES {
        (pass.run)(flat, clock);
        check(flat, pass);
    }
}
