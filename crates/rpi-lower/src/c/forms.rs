//! Table of the C code of primitives, one row each.
//!
//! In a row, `a`, `b`, `c`, ... in braces are the inputs, followed by the parameters; `{a?}` is the presence of an
//! input, `{s}` the state, `{dt}` the period, and `{tick}` the tick in nanoseconds. A form for values of several memory
//! slots is written once and applied to each slot. A number selects a single slot: `{a2}`.

use rpi_image::image::Form;

/// Template of the C code of a primitive in one form (with or without presences), with placeholders such as `{a}` for
/// its operands.
#[derive(Clone, Copy, Debug)]
pub(super) struct CForm {
    /// Registered name of the primitive, such as `Core::DoubleAdd`. A leading `*` matches any beginning of the name:
    /// `*Conditional` stands for `Core::DoubleConditional` and others.
    name: &'static str,
    form: Form,
    /// C types of the slots of the primitive's state; empty for a primitive without state.
    pub(super) state: &'static [&'static str],
    /// C statements that run before the assignments to the outputs; empty if there are none.
    pub(super) before: &'static str,
    /// C expressions: one for each output slot, counted over all outputs, or a single one that is applied to each slot.
    pub(super) cells: &'static [&'static str],
    /// C expression for the presence of the output in the form with presences; empty in the form without.
    pub(super) present: &'static str,
}

const fn total(name: &'static str, cells: &'static [&'static str]) -> CForm {
    CForm {
        name,
        form: Form::Total,
        state: &[],
        before: "",
        cells,
        present: "",
    }
}

const fn optional(
    name: &'static str,
    cells: &'static [&'static str],
    present: &'static str,
) -> CForm {
    CForm {
        form: Form::Optional,
        present,
        ..total(name, cells)
    }
}

const fn state(
    name: &'static str,
    state: &'static [&'static str],
    before: &'static str,
    cells: &'static [&'static str],
) -> CForm {
    CForm {
        state,
        before,
        ..total(name, cells)
    }
}

static FORMS: &[CForm] = &[
    total("Core::BooleanAnd", &["{a} && {b}"]),
    total("Core::BooleanOr", &["{a} || {b}"]),
    total("Core::BooleanNot", &["!{a}"]),
    total("Core::DoubleAdd", &["{a} + {b}"]),
    total("Core::DoubleMultiply", &["{a} * {b}"]),
    total("Core::DoubleDivide", &["{a} / {b}"]),
    total("Core::DoubleModulo", &["fmod({a}, {b})"]),
    total("Core::DoubleGreater", &["{a} > {b}"]),
    total(
        "Core::DoubleEquals",
        &["{a} == {b} || fabs({a} - {b}) <= {c}"],
    ),
    total("Rpi::DoubleSubtract", &["{a} - {b}"]),
    total("Rpi::DoubleNegate", &["-{a}"]),
    total("Rpi::DoubleAbsolute", &["fabs({a})"]),
    total("Rpi::DoubleMinimum", &["fmin({a}, {b})"]),
    total("Rpi::DoubleMaximum", &["fmax({a}, {b})"]),
    total("Rpi::DoubleGreaterOrEqual", &["{a} >= {b}"]),
    total("Rpi::DoubleFloor", &["floor({a})"]),
    total("Rpi::DoubleCeiling", &["ceil({a})"]),
    total("Rpi::DoubleRound", &["round({a})"]),
    total("Rpi::DoubleExponential", &["exp({a})"]),
    total("Rpi::DoubleHyperbolicTangent", &["tanh({a})"]),
    total("Rpi::DoubleAtan", &["atan({a})"]),
    total("Rpi::BooleanXor", &["{a} != {b}"]),
    total("Rpi::BooleanEquals", &["{a} == {b}"]),
    total("Rpi::IntSubtract", &["subtract_int({a}, {b}, &fault)"]),
    total("Rpi::IntMinimum", &["{a} < {b} ? {a} : {b}"]),
    total("Rpi::IntMaximum", &["{a} > {b} ? {a} : {b}"]),
    total("Rpi::IntGreaterOrEqual", &["{a} >= {b}"]),
    total("Core::DoubleSquareRoot", &["sqrt({a})"]),
    total("Core::DoubleSin", &["sin({a})"]),
    total("Core::DoubleCos", &["cos({a})"]),
    total("Core::DoubleTan", &["tan({a})"]),
    total("Core::DoubleAsin", &["asin({a})"]),
    total("Core::DoubleAcos", &["acos({a})"]),
    total("Core::DoubleAtan2", &["atan2({a}, {b})"]),
    total("Core::DoublePower", &["pow({a}, {b})"]),
    total("Core::DoubleLog", &["log({a})"]),
    total("Core::DoubleFromInt", &["(double){a}"]),
    total("Rpi::SecondsFromTicks", &["(double){a} * {tick} / 1e9"]),
    total("Core::IntGreater", &["{a} > {b}"]),
    total("Core::IntAdd", &["add_int({a}, {b}, &fault)"]),
    total("Core::IntMultiply", &["multiply_int({a}, {b}, &fault)"]),
    total("Core::IntDivide", &["divide_int({a}, {b}, &fault)"]),
    total("Core::Lerp", &["{a} + ({b} - {a}) * {c}"]),
    total("Core::TimeDiff", &["(double)({b} - {a}) / 1e9"]),
    total("World::VectorAdd", &["{a} + {b}"]),
    total("World::VectorScale", &["{a} * {b0}"]),
    total("Rpi::VectorDivide", &["{a} / {b0}"]),
    total("World::VectorFromXYZ", &["{a}", "{b}", "{c}"]),
    total("World::VectorToXYZ", &["{a0}", "{a1}", "{a2}"]),
    total(
        "World::VectorDot",
        &["{a0} * {b0} + {a1} * {b1} + {a2} * {b2}"],
    ),
    total(
        "World::VectorCross",
        &[
            "{a1} * {b2} - {a2} * {b1}",
            "{a2} * {b0} - {a0} * {b2}",
            "{a0} * {b1} - {a1} * {b0}",
        ],
    ),
    total(
        "World::FrameFromPosRot",
        &["{a0}", "{a1}", "{a2}", "{b0}", "{b1}", "{b2}", "{b3}"],
    ),
    total(
        "World::FrameToPosRot",
        &["{a0}", "{a1}", "{a2}", "{a3}", "{a4}", "{a5}", "{a6}"],
    ),
    total(
        "World::RotationInvert",
        &["-{a0}", "-{a1}", "-{a2}", "{a3}"],
    ),
    total("World::TwistAdd", &["{a} + {b}"]),
    total("Rpi::TwistSubtract", &["{a} - {b}"]),
    total("Rpi::TwistNegate", &["-{a}"]),
    total("Rpi::TwistScale", &["{a} * {b0}"]),
    total("Rpi::TwistDivide", &["{a} / {b0}"]),
    total("Rpi::WrenchAdd", &["{a} + {b}"]),
    total("Rpi::WrenchSubtract", &["{a} - {b}"]),
    total("Rpi::WrenchNegate", &["-{a}"]),
    total("Rpi::WrenchScale", &["{a} * {b0}"]),
    total("Rpi::WrenchDivide", &["{a} / {b0}"]),
    total(
        "World::TwistFromVelocities",
        &["{a0}", "{a1}", "{a2}", "{b0}", "{b1}", "{b2}"],
    ),
    total(
        "World::TwistToVelocities",
        &["{a0}", "{a1}", "{a2}", "{a3}", "{a4}", "{a5}"],
    ),
    total("*Conditional", &["{a0} ? {b} : {c}"]),
    optional(
        "Core::BooleanAnd",
        &["{a?} && {b?} && {a} && {b}"],
        "({a?} && {b?}) || ({a?} && !{a}) || ({b?} && !{b})",
    ),
    optional(
        "Core::BooleanOr",
        &["({a?} && {a}) || ({b?} && {b})"],
        "({a?} && {b?}) || ({a?} && {a}) || ({b?} && {b})",
    ),
    optional(
        "*Conditional",
        &["{a0} ? {b} : {c}"],
        "{a?} && ({a} ? {b?} : {c?})",
    ),
    optional("*SetNull", &["{a}"], "{a?} && {b?} && !{b0}"),
    state(
        "Core::Clock",
        &["double"],
        "{s} = ({a} ? 0.0 : {s}) + {b} * {dt};",
        &["{s}"],
    ),
];

/// Returns the C template for a primitive in a form (with or without presences); `None` if it cannot be written as C.
pub(super) fn form(name: &str, form: Form) -> Option<&'static CForm> {
    let is_form_of = |row: &&CForm| {
        row.form == form
            && match row.name.strip_prefix('*') {
                Some(end) => name.ends_with(end) && !name.contains("Array"),
                None => row.name == name,
            }
    };
    FORMS.iter().find(is_form_of)
}

impl CForm {
    /// Returns the C expression for the output slot with index `k`, counted over all outputs of the primitive.
    pub(super) fn cell(&self, k: usize) -> &'static str {
        self.cells.get(k).copied().unwrap_or(self.cells[0])
    }
}

/// C helper functions at the beginning of the generated file: integer arithmetic that sets `fault` and returns 0 on
/// overflow or division by zero.
pub(super) const PRELUDE: &str = "\
static int64_t add_int(int64_t a, int64_t b, bool *fault) {
  bool over = (b > 0 && a > INT64_MAX - b) || (b < 0 && a < INT64_MIN - b);
  *fault |= over;
  return over ? 0 : a + b;
}

static int64_t subtract_int(int64_t a, int64_t b, bool *fault) {
  bool over = (b < 0 && a > INT64_MAX + b) || (b > 0 && a < INT64_MIN + b);
  *fault |= over;
  return over ? 0 : a - b;
}

static int64_t multiply_int(int64_t a, int64_t b, bool *fault) {
  bool over = a != 0 && b != 0 &&
    (a > 0 ? (b > 0 ? a > INT64_MAX / b : b < INT64_MIN / a)
           : (b > 0 ? a < INT64_MIN / b : a < INT64_MAX / b));
  *fault |= over;
  return over ? 0 : a * b;
}

static int64_t divide_int(int64_t a, int64_t b, bool *fault) {
  bool bad = b == 0 || (a == INT64_MIN && b == -1);
  *fault |= bad;
  return bad ? 0 : a / b;
}
";

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_prims::registry;

    #[test]
    fn every_row_belongs_to_a_primitive() {
        for row in FORMS {
            let known = registry()
                .iter()
                .any(|p| form(p.desc.name, row.form).is_some_and(|found| std::ptr::eq(found, row)));
            assert!(known, "{}", row.name);
        }
    }
}
