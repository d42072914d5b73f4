//! Errors about values that must be present but may be absent, with their fixes.

use crate::clocks::ClockId;
use crate::facts::presence::PresenceInference;
use crate::facts::presence_check::absence_cause;
use crate::typed::{ElementwiseOp, ExprId, TypedKind};
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};

/// Label of a value that must be present, if nothing else explains its place.
pub(super) const ABSENT: &str = "absent in some cycles";

impl PresenceInference<'_> {
    /// Returns a fix that rewrites `if present(x) then x else y` to `x ?? y`.
    fn fix_present_or(&self, id: ExprId) -> Option<Fix> {
        let TypedKind::Each(ElementwiseOp::If, operands) = &self.unit.expr(id).kind else {
            return None;
        };
        let [condition, yes, no] = operands[..] else {
            return None;
        };
        let TypedKind::Present(tested) = self.unit.expr(condition).kind else {
            return None;
        };
        let flow = |id: ExprId| match self.unit.expr(id).kind {
            TypedKind::Flow(flow) => Some(flow),
            _ => None,
        };
        let same = flow(tested).is_some() && flow(tested) == flow(yes);
        let [whole, yes, no] = [id, yes, no].map(|id| self.unit.expr(id).span);
        let before = Span {
            end: yes.start,
            ..whole
        };
        let between = Span {
            start: yes.end,
            end: no.start,
            ..whole
        };
        let meant = format!("{} ?? {}", Quote::operand(yes), Quote::operand(no));
        let fix = Fix::maybe(format!("replace it with `{meant}`"))
            .replace(before, "")
            .replace(between, " ?? ");
        same.then_some(fix)
    }

    /// Returns a fix that appends `?? otherwise` to an expression.
    pub(super) fn fix_coalesce(&self, id: ExprId, otherwise: &str) -> Fix {
        let span = self.unit.expr(id).span;
        let fix = Fix::maybe(format!("use `{otherwise}` while it is absent"));
        match self.unit.expr(id).kind {
            TypedKind::Flow(_) | TypedKind::Part { .. } | TypedKind::Call(_) => {
                fix.insert_after(span, format!(" ?? {otherwise}"))
            }
            _ => fix
                .insert_before(span, "(")
                .insert_after(span, format!(") ?? {otherwise}")),
        }
    }

    /// Reports a value that may be absent but must be present, for a reader on clock `reader`. `why` is the label.
    pub(super) fn absence_error(&self, id: ExprId, reader: ClockId, why: &str) -> Diagnostic {
        let zero = self.unit.expr(id).ty.zero_literal();
        self.absence_error_or(id, reader, why, &zero.unwrap_or("...".to_owned()))
    }

    /// Reports a value that may be absent but must be present, for a reader on clock `reader`. `why` is the label; the
    /// help offers the literal `otherwise` for the cycles without a value.
    pub(super) fn absence_error_or(
        &self,
        id: ExprId,
        reader: ClockId,
        why: &str,
        otherwise: &str,
    ) -> Diagnostic {
        let span = self.unit.expr(id).span;
        let message = match self.unit.expr(id).kind {
            TypedKind::Flow(flow) => {
                format!("`{}` may be absent here", self.unit.flow(flow).name)
            }
            _ => "this value may be absent".to_owned(),
        };
        let cause = absence_cause(self, id, reader);
        // Beside the label of an operand, that of the whole must not look like the label of the rest.
        let is_inside = |cause: Span| span.contains(cause) && span != cause;
        let why = match &cause {
            Some((cause, _)) if why == ABSENT && is_inside(*cause) => {
                "so the whole expression is absent in some cycles"
            }
            _ => why,
        };
        let diagnostic = Diagnostic::new(Code::RPI3001, message).primary(span, why.to_owned());
        let diagnostic = match self.fix_present_or(id) {
            Some(fix) => diagnostic
                .help(
                    "`??` gives its left side where that is present, and its right side where not",
                )
                .fix(fix),
            None => self.with_absence_help(diagnostic, id, otherwise),
        };
        match cause {
            Some((span, text)) => diagnostic.secondary(span, text),
            None => diagnostic,
        }
    }

    /// Adds the expressions that are always present to a diagnostic about a value that may be absent.
    fn with_absence_help(&self, diagnostic: Diagnostic, id: ExprId, otherwise: &str) -> Diagnostic {
        let span = self.unit.expr(id).span;
        let TypedKind::Current(held) = self.unit.expr(id).kind else {
            return diagnostic.help(absence_help(span, otherwise));
        };
        let held = self.unit.expr(held).span;
        let before = Span {
            end: held.start,
            ..span
        };
        let after = Span {
            start: held.end,
            ..span
        };
        let form = format!("hold({}, {otherwise})", Quote::text(held));
        diagnostic
            .help(format!(
                "`current` is absent before the first value: `{form}` is `{otherwise}` until then"
            ))
            .fix(
                Fix::maybe(format!("write `{form}`"))
                    .replace(before, "hold(")
                    .replace(after, format!(", {otherwise})")),
            )
    }
}

/// Returns the help for a value at `value` that may be absent: the expressions that are always present. They use the
/// literal `otherwise` while it is absent.
fn absence_help(value: Span, otherwise: &str) -> String {
    let [operand, argument] = [Quote::operand(value), Quote::text(value)];
    format!(
        "define what holds while it is absent: `{operand} ?? {otherwise}` uses another value, `hold({argument}, {otherwise})` the latest one"
    )
}
