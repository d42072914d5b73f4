//! Optimisation passes that do not change a bit of the outputs. One file per pass; [`PASSES`] has the order.
//!
//! Invariants of every pass: operations that may fault or reach a device are kept, in their relative order; exports,
//! results and set-points keep their bits; each register has one writer, which runs before its readers.

mod coalesce;
mod dead;
mod delays;
mod fold;
mod fuse;
mod laws;
pub(crate) mod order;
mod rename;
mod rows;
mod sensors;
mod share;

use crate::flat::Flat;
use rpi_prims::Clock;

/// A pass over a flat net.
pub(crate) struct Pass {
    /// Name of the pass in messages and listings.
    pub(crate) name: &'static str,
    /// One-line description.
    pub(crate) what: &'static str,
    pub(crate) run: fn(&mut Flat, Clock),
}

const FOLD: Pass = Pass {
    name: "fold",
    what: "evaluate constant expressions at compile time",
    run: fold::fold,
};

/// All passes in order.
pub(crate) const PASSES: &[Pass] = &[
    Pass {
        name: "sensors",
        what: "read each device port once per cycle",
        run: sensors::share,
    },
    FOLD,
    Pass {
        name: "start",
        what: "turn a constant first value into the initial content of its delay",
        run: delays::start,
    },
    FOLD,
    Pass {
        name: "share",
        what: "compute common subexpressions once",
        run: share::share,
    },
    Pass {
        name: "direct",
        what: "read delayed values directly from the state",
        run: delays::direct,
    },
    Pass {
        name: "dead",
        what: "remove computations without an effect",
        run: dead::remove,
    },
    Pass {
        name: "fuse",
        what: "fuse two primitives if one feeds only the other",
        run: fuse::fuse,
    },
    Pass {
        name: "rows",
        what: "group calls of the same primitive",
        run: rows::arrange,
    },
    Pass {
        name: "coalesce",
        what: "compute a value directly in the state of its delay",
        run: coalesce::coalesce,
    },
];

/// Runs all passes and calls `check` after each.
pub(crate) fn run(flat: &mut Flat, clock: Clock, mut check: impl FnMut(&Flat, &Pass)) {
    for pass in PASSES {
        (pass.run)(flat, clock);
        check(flat, pass);
    }
}

/// Runs the passes that keep the net readable, for generated C code.
pub(crate) fn tidy(flat: &mut Flat, clock: Clock) {
    let all = PASSES.iter().take_while(|p| p.name != "fuse");
    all.for_each(|p| (p.run)(flat, clock));
}
