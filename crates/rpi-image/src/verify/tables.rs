//! Checks of the memory layout, the initial contents and the tables of sensors, inputs, flows, exports and ends.

use super::{ErrorLocation, UNWRITTEN, Verifier};
use crate::image::{CommandEnd, FALSE, MAX_SLOTS, Signal, SlotRange, TRUE};
use crate::types::{Scalar, Type};
use alloc::{format, vec};

/// Maximum period of a command in ns: one hour.
const MAX_PERIOD_NS: u64 = 3_600_000_000_000;

impl Verifier<'_> {
    /// Checks the memory regions, the period, the tick and the initial contents. If they are valid, creates the tables
    /// that record the writer of each slot.
    pub(super) fn layout(&mut self) {
        let l = self.image.layout;
        let ordered = TRUE < l.constants
            && l.constants <= l.external
            && l.external <= l.state
            && l.state <= l.end;
        self.require(ordered && l.end <= MAX_SLOTS, || {
            format!("invalid memory regions {l:?}")
        });
        let period = self.image.period_ns;
        self.require((1..=MAX_PERIOD_NS).contains(&period), || {
            format!("invalid period of {period} ns")
        });
        let tick = self.image.tick_ns;
        self.require(tick > 0 && period.is_multiple_of(tick), || {
            format!("the period of {period} ns is not a multiple of the tick of {tick} ns")
        });
        if self.errors.is_empty() {
            self.writer_scope = vec![UNWRITTEN; l.end as usize];
            self.writer_scope[..l.state as usize].fill(0);
            self.open_guards = vec![0; l.end as usize];
            self.owned = vec![false; (l.state - l.external) as usize];
            self.init();
        }
    }

    fn init(&mut self) {
        let init = &self.image.init;
        let ascending = init.windows(2).all(|w| w[0].0 < w[1].0);
        self.require(ascending, || {
            "initial contents are not in ascending order".into()
        });
        for (k, &(cell, bits)) in init.iter().enumerate() {
            self.location = ErrorLocation::Table("initial content", k);
            let is_valid =
                cell != FALSE && cell < self.image.layout.state && (cell != TRUE || bits == 1);
            self.require(is_valid, || {
                format!("slot {cell} cannot start as {bits:#x}")
            });
        }
        let is_true = init.first() == Some(&(TRUE, 1));
        self.require(is_true, || format!("slot {TRUE} must start as 1"));
    }

    /// Checks the tables of fragments, sensors, inputs, core flows and debug information, which do not depend on the
    /// steps.
    pub(super) fn tables(&mut self) {
        self.fragments();
        for (k, s) in self.image.sensors.iter().enumerate() {
            self.location = ErrorLocation::Table("sensor", k);
            self.check_external_flow(s.value);
        }
        for (k, p) in self.image.inputs.iter().enumerate() {
            self.location = ErrorLocation::Table("input", k);
            self.check_external_flow(p.value);
            p.last_updated
                .into_iter()
                .for_each(|u| self.check_external_flow(u));
        }
        for (k, f) in self.image.flows.iter().enumerate() {
            self.location = ErrorLocation::Table("flow", k);
            self.check_external_flow(f.value);
        }
        self.check_locations();
    }

    fn fragments(&mut self) {
        let all = &self.image.fragments;
        let l = self.image.layout;
        for (k, f) in all.iter().enumerate() {
            self.location = ErrorLocation::Table("fragment", k);
            let parent = f.parent.and_then(|p| all[..k].get(p as usize));
            self.require((k == 0) == f.parent.is_none(), || "invalid parent".into());
            self.require(f.parent.is_none() || parent.is_some(), || {
                "invalid parent".into()
            });
            let within = parent.map_or(l.external..l.state, |p| p.state.start..p.state.end());
            // Even an empty state must start inside the memory.
            let inside = within.start <= f.state.start || f.state.len == 0;
            let end = if f.state.len == 0 { l.end } else { within.end };
            let is_valid = inside && f.state.end() <= end;
            self.require(is_valid, || {
                format!("state {:?} lies outside {within:?}", f.state)
            });
            self.require(f.active < l.end, || {
                format!("slot {} is out of range", f.active)
            });
        }
        self.require(!all.is_empty(), || "there is no root fragment".into());
    }

    fn check_locations(&mut self) {
        let places = self.image.debug.locations.len();
        let known = |p: u32| (p as usize) < places;
        self.location = ErrorLocation::Table("origin", 0);
        let origins = &self.image.debug.origins;
        let ascending = origins.windows(2).all(|w| w[0].0 < w[1].0);
        self.require(ascending && origins.iter().all(|o| known(o.1)), || {
            "invalid origins".into()
        });
        let trace = &self.image.debug.step_locations;
        let is_valid = trace.is_empty() || trace.len() == self.image.steps.len();
        self.require(
            is_valid && trace.iter().all(|&p| p == u32::MAX || known(p)),
            || "invalid trace".into(),
        );
        for (k, p) in self.image.debug.probes.iter().enumerate() {
            self.location = ErrorLocation::Table("probe", k);
            self.signal(p.value);
            let is_valid = known(p.location) && (p.fragment as usize) < self.image.fragments.len();
            self.require(is_valid, || "invalid location or fragment".into());
        }
    }

    /// Checks the flows that are read after the evaluation phase: exports and results. The check needs the writers of
    /// slots, so [`Verifier::evaluation`] must have run before.
    pub(super) fn check_results(&mut self) {
        for (k, e) in self.image.exports.iter().enumerate() {
            self.location = ErrorLocation::Table("export", k);
            self.check_final_read(e.value);
        }
        self.location = ErrorLocation::Table("end", 0);
        match &self.image.end {
            CommandEnd::Results(results) => {
                let conditions = results.iter().map(|r| r.condition);
                conditions.for_each(|s| self.check_end_condition(s, Scalar::Bool));
            }
            CommandEnd::Ports { terminate, fail } => {
                terminate
                    .iter()
                    .for_each(|s| self.check_end_condition(*s, Scalar::Bool));
                fail.iter()
                    .for_each(|s| self.check_end_condition(*s, Scalar::Int));
            }
        }
    }

    /// Checks a flow that ends a command: it must be a single value of type `scalar`, and readable after the evaluation
    /// phase.
    fn check_end_condition(&mut self, s: Signal, scalar: Scalar) {
        let ty = s.ty;
        self.require(ty == Type::Scalar(scalar), || {
            format!("expected {scalar} as the end of a command, found {ty}")
        });
        self.check_final_read(s);
    }

    /// Checks a flow that is read after the evaluation phase: its slots must exist, and a step must have written its
    /// presence in every cycle.
    fn check_final_read(&mut self, s: Signal) {
        self.signal(s);
        self.check_control_read(s.present);
    }

    /// Checks a flow that the core writes before the evaluation phase: its slots must be external slots.
    fn check_external_flow(&mut self, s: Signal) {
        self.external(s.slots());
        if s.present != TRUE {
            self.external(SlotRange {
                start: s.present,
                len: 1,
            });
        }
    }

    fn external(&mut self, c: SlotRange) {
        let l = self.image.layout;
        let is_valid = l.constants <= c.start && c.end() <= l.external;
        self.require(is_valid, || {
            format!("slots {}..{} are not external", c.start, c.end())
        });
    }

    fn signal(&mut self, s: Signal) {
        let (cells, present) = (s.slots(), s.present);
        let is_valid = cells.end() <= self.image.layout.end && present < self.image.layout.end;
        self.require(is_valid, || {
            format!(
                "slots {}..{} or presence slot {present} are out of range",
                cells.start,
                cells.end()
            )
        });
    }
}
