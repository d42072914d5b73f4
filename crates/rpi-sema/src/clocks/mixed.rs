//! A delay or an initialisation has one clock: which of two was meant is not to be guessed.

use super::check::Check;
use super::clock::Clock;
use crate::typed::{ExprId, Kind};
use rpi_diag::{Code, Finding, Fix};

impl Check<'_, '_> {
    /// Whether both sides of an initialisation have one clock, leaf by leaf; reports it if not.
    pub(super) fn mixes_none(&mut self, id: ExprId, sides: [ExprId; 2]) -> bool {
        let unit = self.solver.unit;
        let count = unit.expr(id).ty.leaf_count();
        let clocks = |k: usize| sides.map(|side| self.solver.leaf(side, k));
        let Some([first, later]) = (0..count).map(clocks).find(|[a, b]| a != b) else {
            return true;
        };
        let [first_words, later_words] = [first, later].map(|clock| self.words(clock));
        let message = format!("a delay of two clocks: {first_words}, then {later_words}");
        let [first_span, later_span] = sides.map(|side| unit.expr(side).span);
        let finding = Finding::new(Code::RPI3009, message)
            .at(first_span, format!("the first value is there {}", there(&first_words)))
            .also(later_span, format!("the later ones are there {}", there(&later_words)))
            .help("in all cycles: `x ?? other`, `hold(x, init)` or `present(x)` of what is sampled")
            .help("in those of the clock: sample the other side, `x when c`, so that the delay is inside of the clock");
        let finding = match self.sampled_too(sides, [first, later]) {
            Some(fix) => finding.fix(fix),
            None => finding,
        };
        self.add(finding);
        false
    }

    /// The faster side, sampled as the slower one is, if one sampling is between them.
    fn sampled_too(&self, sides: [ExprId; 2], clocks: [Clock; 2]) -> Option<Fix> {
        let unit = self.solver.unit;
        let (slow, fast) = match self.solver.parent(clocks[0]) == Some(clocks[1]) {
            true => (clocks[0], sides[1]),
            false if self.solver.parent(clocks[1]) == Some(clocks[0]) => (clocks[1], sides[0]),
            false => return None,
        };
        let super::Decider::Flow(_) = self.solver.ticks.tick(slow)?.by else {
            return None;
        };
        let tick = self.solver.ticks.tick(slow)?;
        let text = super::print(self.solver.units, self.solver.facts, unit, &[tick]);
        // What is delayed is sampled, not the delay, which may stand for both: `a fby b`.
        let inner = match &unit.expr(fast).kind {
            Kind::Each(crate::typed::Each::Pre, operands) => operands[0],
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

/// Where a value is, in a sentence.
fn there(words: &str) -> String {
    match words.starts_with('`') {
        true => format!("only {words}"),
        false => words.to_owned(),
    }
}
