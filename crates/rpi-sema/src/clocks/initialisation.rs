//! Reports an initialisation whose two operands have different clocks. The compiler does not guess which clock was
//! meant.

use crate::clocks::check::Check;
use crate::clocks::clock::Clock;
use crate::typed::ExprId;
use crate::typed::TypedKind;
use rpi_diag::{Code, Diagnostic, Fix, Quote};

impl Check<'_, '_> {
    /// Whether both operands of an initialisation have the same clock, leaf by leaf (scalar part). Reports a mismatch.
    pub(super) fn check_same_clock(&mut self, id: ExprId, sides: [ExprId; 2]) -> bool {
        let unit = self.solver.unit;
        let count = unit.expr(id).ty.leaf_count();
        let clocks = |k: usize| sides.map(|side| self.solver.leaf(side, k));
        let Some([first, later]) = (0..count).map(clocks).find(|[a, b]| a != b) else {
            return true;
        };
        let [first_words, later_words] = [first, later].map(|clock| self.describe(clock));
        let message = format!("clock mismatch in a delay: {first_words}, then {later_words}");
        let [first_span, later_span] = sides.map(|side| unit.expr(side).span);
        let diagnostic = Diagnostic::new(Code::RPI3009, message)
            .primary(
                first_span,
                format!(
                    "the first value is present {}",
                    presence_phrase(&first_words)
                ),
            )
            .secondary(
                later_span,
                format!(
                    "the later values are present {}",
                    presence_phrase(&later_words)
                ),
            )
            .help(self.initialisation_help(sides, [first, later]));
        let diagnostic = match self.fix_sample_other_side(sides, [first, later]) {
            Some(fix) => diagnostic.fix(fix),
            None => diagnostic,
        };
        self.add(diagnostic);
        false
    }

    /// Returns the help text for an initialisation whose operands have different clocks: sample both operands, or hold
    /// the sampled one. `sides` are the operands with their `clocks`.
    fn initialisation_help(&self, sides: [ExprId; 2], clocks: [Clock; 2]) -> String {
        let unit = self.solver.unit;
        let sampled = match clocks[0] == Clock::BASE {
            true => sides[1],
            false => sides[0],
        };
        let (span, ty) = (unit.expr(sampled).span, &unit.expr(sampled).ty);
        let (value, zero) = (Quote::text(span), ty.zero_literal());
        let zero = zero.unwrap_or("...".to_owned());
        match clocks.contains(&Clock::BASE) {
            true => format!(
                "sample both sides alike, or hold the sampled one in the other cycles: `hold({value}, {zero})`"
            ),
            false => "sample both sides by one condition".to_owned(),
        }
    }

    /// Returns a fix that samples the operand with the faster clock like the other one. `None` unless a single sampling
    /// by a flow separates the two clocks.
    fn fix_sample_other_side(&self, sides: [ExprId; 2], clocks: [Clock; 2]) -> Option<Fix> {
        let unit = self.solver.unit;
        let (slow, fast) = match self.solver.parent(clocks[0]) == Some(clocks[1]) {
            true => (clocks[0], sides[1]),
            false if self.solver.parent(clocks[1]) == Some(clocks[0]) => (clocks[1], sides[0]),
            false => return None,
        };
        let crate::clocks::ClockCondition::Flow(_) = self.solver.ticks.sampling(slow)?.condition
        else {
            return None;
        };
        let tick = self.solver.ticks.sampling(slow)?;
        let text = crate::clocks::format_clock(self.solver.units, self.solver.facts, unit, &[tick]);
        // In `a fby b` the operand of the delay is sampled, not the delay, whose span may be that of both operands.
        let inner = match &unit.expr(fast).kind {
            TypedKind::Each(crate::typed::ElementwiseOp::Pre, operands) => operands[0],
            _ => fast,
        };
        let span = unit.expr(inner).span;
        Some(
            Fix::maybe(format!("sample the other side, {text}"))
                .insert_before(span, "((")
                .insert_after(span, format!(") {text})")),
        )
    }
}

/// Returns the phrase `words`, which describes cycles in which a value is present, in the form for use after "is
/// present": "only ..." for a clock in backticks.
pub(super) fn presence_phrase(words: &str) -> String {
    match words.starts_with('`') {
        true => format!("only {words}"),
        false => words.to_owned(),
    }
}
