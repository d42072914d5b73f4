//! What makes an image faster without changing a bit of what leaves it. One file per pass; the order is that of
//! [`PASSES`].
//!
//! Every pass keeps: what may fault and what reaches a device stays, in its order among its like; values that leave the
//! command (exports, ends, set-points) keep their bits; a slot has one writer, which comes before its readers.

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

/// A pass over a net that was taken apart.
pub(crate) struct Pass {
    /// Its name in messages and listings.
    pub(crate) name: &'static str,
    /// What it is for, in one line.
    pub(crate) what: &'static str,
    pub(crate) run: fn(&mut Flat, Clock),
}

const FOLD: Pass = Pass {
    name: "fold",
    what: "what depends on constants only is computed here",
    run: fold::fold,
};

/// All passes in order.
pub(crate) const PASSES: &[Pass] = &[
    Pass {
        name: "sensors",
        what: "a device port that is read several times is read once",
        run: sensors::share,
    },
    FOLD,
    Pass {
        name: "start",
        what: "a delay whose start is chosen by a constant starts with it",
        run: delays::start,
    },
    FOLD,
    Pass {
        name: "share",
        what: "equal expressions are computed once",
        run: share::share,
    },
    Pass {
        name: "direct",
        what: "what a delay gives is read where it is kept",
        run: delays::direct,
    },
    Pass {
        name: "dead",
        what: "what nobody reads is not computed",
        run: dead::remove,
    },
    Pass {
        name: "fuse",
        what: "two primitives of which one feeds only the other become one",
        run: fuse::fuse,
    },
    Pass {
        name: "rows",
        what: "equal primitives stand side by side",
        run: rows::arrange,
    },
    Pass {
        name: "coalesce",
        what: "a value is computed where the delay of it is kept",
        run: coalesce::coalesce,
    },
];

/// Runs all passes; `check` looks at the net after each.
pub(crate) fn run(flat: &mut Flat, clock: Clock, mut check: impl FnMut(&Flat, &Pass)) {
    for pass in PASSES {
        (pass.run)(flat, clock);
        check(flat, pass);
    }
}

/// The passes after which a net reads well: for what is written for people and other compilers.
pub(crate) fn tidy(flat: &mut Flat, clock: Clock) {
    let all = PASSES.iter().take_while(|p| p.name != "fuse");
    all.for_each(|p| (p.run)(flat, clock));
}
