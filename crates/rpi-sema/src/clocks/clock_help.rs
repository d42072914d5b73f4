//! Help texts for clock mismatches: how a value gets the clock that is expected.

use crate::clocks::check::Check;
use crate::clocks::clock::Clock;
use crate::ty::Ty;
use crate::typed::{ExprId, Target, TargetPlace, TypedKind};
use rpi_diag::Quote;

/// Returns the advice for two flows of different clocks.
pub(super) fn sample_or_hold(is_lustre: bool) -> String {
    let hold = if is_lustre { "current" } else { "hold" };
    format!("sample the faster flow by `when`, or hold the slower one by `{hold}`")
}

impl Check<'_, '_> {
    /// Returns the advice for a value of the clock `found` where one of the clock `wanted` is expected.
    pub(super) fn mismatch_help(&self, found: Clock, wanted: Clock, id: ExprId) -> String {
        match self.iterated_callee(id) {
            Some(name) if self.is_lustre() => format!(
                "an iterator needs a value of each element in all cycles: let `{name}` return `current (...)`"
            ),
            Some(name) => format!(
                "an iterator needs a value of each element in all cycles: let `{name}` return `hold(..., {})`, without a clock",
                self.zero_element(id)
            ),
            None if wanted == Clock::BASE && self.is_lustre() => format!(
                "give it a value in the other cycles, {}, or hold it by {} if its clock is true in the first cycle",
                self.filled(found, id),
                self.held(id)
            ),
            None if wanted == Clock::BASE => format!(
                "hold it in the other cycles: {}; or use it only in the cycles of its clock",
                self.held(id)
            ),
            None if found == Clock::BASE => {
                format!(
                    "sample it: `{} {}`",
                    Quote::operand(self.solver.unit.expr(id).span),
                    self.describe(wanted).trim_matches('`')
                )
            }
            None => sample_or_hold(self.is_lustre()),
        }
    }

    /// Returns the text of an expression with the value of `id`, of the clock `found`, and a literal in the other cycles.
    fn filled(&self, found: Clock, id: ExprId) -> String {
        let unit = self.solver.unit;
        let (clock, zero) = (self.describe(found), unit.expr(id).ty.zero_or_dots());
        let condition = clock.trim_matches('`').trim_start_matches("when ");
        match &unit.expr(id).kind {
            TypedKind::When { value, .. } => {
                let value = Quote::text(unit.expr(*value).span);
                format!("`if {condition} then {value} else {zero}`")
            }
            _ => {
                let value = Quote::text(unit.expr(id).span);
                format!("`merge ({condition}; {value}; {zero} when not {condition})`")
            }
        }
    }

    /// Returns the text of an expression that holds the value of `id` in the cycles in which it is absent.
    pub(super) fn held(&self, id: ExprId) -> String {
        let place = self.solver.unit.expr(id).span;
        if self.is_lustre() {
            return format!("`current ({})`", Quote::text(place));
        }
        let sampled = match self.operand_of_sampled_current(id) {
            Some(inner) => {
                let clock = self.describe(self.row(id).leaf(0));
                let inner = self.solver.unit.expr(inner).span;
                format!("{} {}", Quote::operand(inner), clock.trim_matches('`'))
            }
            None => Quote::text(place).to_string(),
        };
        format!("`hold({sampled}, {})`", self.zero_literal(id))
    }

    /// Returns the expression `x` in `current x when c`, which is parsed as `(current x) when c`; `None` for other
    /// expressions.
    fn operand_of_sampled_current(&self, id: ExprId) -> Option<ExprId> {
        let unit = self.solver.unit;
        let TypedKind::When { value, .. } = unit.expr(id).kind else {
            return None;
        };
        match unit.expr(value).kind {
            TypedKind::Current(inner) => Some(inner),
            _ => None,
        }
    }

    /// Returns a literal of the type of an expression, for the cycles before its first value.
    fn zero_literal(&self, id: ExprId) -> String {
        self.solver.unit.expr(id).ty.zero_or_dots()
    }

    /// Returns a literal of the type of an element of an array.
    fn zero_element(&self, id: ExprId) -> String {
        match &self.solver.unit.expr(id).ty {
            Ty::Array(element, _) => element.zero_or_dots(),
            ty => ty.zero_or_dots(),
        }
    }

    /// Returns the name of the node that an iterator such as `map<<f, 3>>(a)` applies. The calls into which it is expanded
    /// have its span.
    fn iterated_callee(&self, id: ExprId) -> Option<String> {
        let unit = self.solver.unit;
        let TypedKind::Build(elements) = &unit.expr(id).kind else {
            return None;
        };
        let mut element = *elements.first()?;
        while let TypedKind::Part { base, .. } = unit.expr(element).kind {
            element = base;
        }
        let TypedKind::Call(call) = &unit.expr(element).kind else {
            return None;
        };
        let is_expanded = unit.expr(element).span == unit.expr(id).span;
        let callee = &self.solver.units[call.unit.0 as usize];
        is_expanded.then(|| callee.name.to_string())
    }

    /// Adds to the last diagnostic that `k = current(k) when c` keeps the value of `k` by `pre`.
    pub(super) fn hint_kept_value(&mut self, target: &Target, value: ExprId) {
        let unit = self.solver.unit;
        let TargetPlace::Flow { flow, .. } = &target.place else {
            return;
        };
        let Some(inner) = self.operand_of_sampled_current(value) else {
            return;
        };
        if !matches!(unit.expr(inner).kind, TypedKind::Flow(read) if read == *flow) {
            return;
        }
        let help = format!(
            "`{0}` keeps its value by `pre`: `{0} = {1} -> if ... then ... else pre {0};`",
            unit.flow(*flow).name,
            self.zero_literal(value)
        );
        if let Some(diagnostic) = self.diagnostics.last_mut()
            && diagnostic.span() == unit.expr(value).span
        {
            diagnostic.help = vec![help];
        }
    }
}
