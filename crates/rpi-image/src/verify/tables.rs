//! Checks of the memory layout, the initial contents and the tables of sensors, inputs, flows, exports and ends.

use super::{At, Check, UNWRITTEN};
use crate::image::{Cells, End, FALSE, MAX_CELLS, Signal, TRUE};
use crate::ty::{Scalar, Type};
use alloc::{format, vec};

/// Maximum period, one hour.
const MAX_PERIOD_NS: u64 = 3_600_000_000_000;

impl Check<'_> {
    /// Checks memory regions and initial contents, and initialises the knowledge about each slot.
    pub(super) fn layout(&mut self) {
        let l = self.image.layout;
        let ordered = TRUE < l.constants
            && l.constants <= l.external
            && l.external <= l.state
            && l.state <= l.cells;
        self.demand(ordered && l.cells <= MAX_CELLS, || {
            format!("invalid memory regions {l:?}")
        });
        let period = self.image.period_ns;
        self.demand((1..=MAX_PERIOD_NS).contains(&period), || {
            format!("invalid period of {period} ns")
        });
        let tick = self.image.tick_ns;
        self.demand(tick > 0 && period.is_multiple_of(tick), || {
            format!("the period of {period} ns is not a multiple of the tick of {tick} ns")
        });
        if self.errors.is_empty() {
            self.writer = vec![UNWRITTEN; l.cells as usize];
            self.writer[..l.state as usize].fill(0);
            self.holds = vec![0; l.cells as usize];
            self.owned = vec![false; (l.state - l.external) as usize];
            self.init();
        }
    }

    fn init(&mut self) {
        let init = &self.image.init;
        let ascending = init.windows(2).all(|w| w[0].0 < w[1].0);
        self.demand(ascending, || {
            "initial contents are not in ascending order".into()
        });
        for (k, &(cell, bits)) in init.iter().enumerate() {
            self.at = At::Table("initial content", k);
            let fits =
                cell != FALSE && cell < self.image.layout.state && (cell != TRUE || bits == 1);
            self.demand(fits, || format!("slot {cell} cannot start as {bits:#x}"));
        }
        let is_true = init.first() == Some(&(TRUE, 1));
        self.demand(is_true, || format!("slot {TRUE} must start as 1"));
    }

    /// Checks the tables that do not depend on the steps.
    pub(super) fn tables(&mut self) {
        self.fragments();
        for (k, s) in self.image.sensors.iter().enumerate() {
            self.at = At::Table("sensor", k);
            self.filled(s.value);
        }
        for (k, p) in self.image.inputs.iter().enumerate() {
            self.at = At::Table("input", k);
            self.filled(p.value);
            p.updated.into_iter().for_each(|u| self.filled(u));
        }
        for (k, f) in self.image.flows.iter().enumerate() {
            self.at = At::Table("flow", k);
            self.filled(f.value);
        }
        self.names();
    }

    fn fragments(&mut self) {
        let all = &self.image.fragments;
        let l = self.image.layout;
        for (k, f) in all.iter().enumerate() {
            self.at = At::Table("fragment", k);
            let parent = f.parent.and_then(|p| all[..k].get(p as usize));
            self.demand((k == 0) == f.parent.is_none(), || "invalid parent".into());
            self.demand(f.parent.is_none() || parent.is_some(), || {
                "invalid parent".into()
            });
            let within = parent.map_or(l.external..l.state, |p| p.state.at..p.state.end());
            // Even an empty state must start inside the memory.
            let inside = within.start <= f.state.at || f.state.len == 0;
            let end = if f.state.len == 0 {
                l.cells
            } else {
                within.end
            };
            let fits = inside && f.state.end() <= end;
            self.demand(fits, || {
                format!("state {:?} lies outside {within:?}", f.state)
            });
            self.demand(f.active < l.cells, || {
                format!("slot {} is out of range", f.active)
            });
        }
        self.demand(!all.is_empty(), || "there is no root fragment".into());
    }

    fn names(&mut self) {
        let places = self.image.places.len();
        let known = |p: u32| (p as usize) < places;
        self.at = At::Table("origin", 0);
        let origins = &self.image.origins;
        let ascending = origins.windows(2).all(|w| w[0].0 < w[1].0);
        self.demand(ascending && origins.iter().all(|o| known(o.1)), || {
            "invalid origins".into()
        });
        let trace = &self.image.trace;
        let fits = trace.is_empty() || trace.len() == self.image.steps.len();
        self.demand(
            fits && trace.iter().all(|&p| p == u32::MAX || known(p)),
            || "invalid trace".into(),
        );
        for (k, p) in self.image.probes.iter().enumerate() {
            self.at = At::Table("probe", k);
            self.signal(p.value);
            let fits = known(p.place) && (p.fragment as usize) < self.image.fragments.len();
            self.demand(fits, || "invalid location or fragment".into());
        }
    }

    /// Checks the flows read after evaluation. Valid only after [`Check::evaluation`].
    pub(super) fn results(&mut self) {
        for (k, e) in self.image.exports.iter().enumerate() {
            self.at = At::Table("export", k);
            self.published(e.value);
        }
        self.at = At::Table("end", 0);
        match &self.image.end {
            End::Results(results) => {
                let conditions = results.iter().map(|r| r.condition);
                conditions.for_each(|s| self.deciding(s, Scalar::Bool));
            }
            End::Ports { terminate, fail } => {
                terminate
                    .iter()
                    .for_each(|s| self.deciding(*s, Scalar::Bool));
                fail.iter().for_each(|s| self.deciding(*s, Scalar::Int));
            }
        }
    }

    /// Checks a flow that ends a command: a single value of type `scalar`.
    fn deciding(&mut self, s: Signal, scalar: Scalar) {
        let ty = s.ty;
        self.demand(ty == Type::One(scalar), || {
            format!("expected {scalar} as the end of a command, found {ty}")
        });
        self.published(s);
    }

    /// Checks a flow that is read at the end of the cycle.
    fn published(&mut self, s: Signal) {
        self.signal(s);
        self.decides(s.present);
    }

    /// Checks a flow written by the core: it must lie in external slots.
    fn filled(&mut self, s: Signal) {
        self.external(s.cells());
        if s.present != TRUE {
            self.external(Cells {
                at: s.present,
                len: 1,
            });
        }
    }

    fn external(&mut self, c: Cells) {
        let l = self.image.layout;
        let fits = l.constants <= c.at && c.end() <= l.external;
        self.demand(fits, || {
            format!("slots {}..{} are not external", c.at, c.end())
        });
    }

    fn signal(&mut self, s: Signal) {
        let (cells, present) = (s.cells(), s.present);
        let fits = cells.end() <= self.image.layout.cells && present < self.image.layout.cells;
        self.demand(fits, || {
            format!(
                "slots {}..{} or presence slot {present} are out of range",
                cells.at,
                cells.end()
            )
        });
    }
}
