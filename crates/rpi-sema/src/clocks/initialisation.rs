//! Reports an initialisation whose two operands have different clocks. The compiler does not guess which clock was
//! meant.

use crate::clocks::check::Check;
use crate::clocks::clock::Clock;
use crate::typed::ExprId;
use crate::typed::TypedKind;
use rpi_diag::{Code, Diagnostic, Fix};

impl Check<'_, '_> {
    /// Returns whether both operands of an initialisation have the same clock, leaf by leaf. Reports a mismatch.
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
            .primary(first_span, format!("the first value is present {}", presence_phrase(&first_words)))
            .secondary(later_span, format!("the later values are present {}", presence_phrase(&later_words)))
            .help("for a value in all cycles: `x ?? other`, `hold(x, init)` or `present(x)` of the sampled side")
            .help("for a delay on the slower clock: sample the other side too, `x when c`");
        let diagnostic = match self.fix_sample_other_side(sides, [first, later]) {
            Some(fix) => diagnostic.fix(fix),
            None => diagnostic,
        };
        self.add(diagnostic);
        false
    }

    /// Returns a fix that samples the faster operand like the slower one, if a single sampling separates their clocks.
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

/// Returns words for the cycles in which a value is present, for use after "is present".
fn presence_phrase(words: &str) -> String {
    match words.starts_with('`') {
        true => format!("only {words}"),
        false => words.to_owned(),
    }
}
