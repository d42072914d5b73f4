//! Diagnostics about units and dimensions, with suggestions.

use crate::ty::Ty;
use crate::units::{BaseDim, Dimension, Ratio, UnitError};
use rpi_diag::{Code, Diagnostic, Fix, Span};
use rpi_syntax::ops::UnaryOp;

/// Value in a diagnostic about quantities: its dimension, its location, and whether it is a number literal.
#[derive(Clone, Copy)]
pub(crate) struct MeasuredValue {
    pub(crate) dim: Dimension,
    pub(crate) span: Span,
    pub(crate) is_number: bool,
}

/// Returns the description of a dimension: `a length in m`, `a quantity in m^2/s`, `a plain number`.
pub(crate) fn describe_dim(dim: Dimension) -> String {
    match (dim == Dimension::ONE, dim.quantity_literal()) {
        (true, _) => "a plain number".to_owned(),
        (_, Some(name)) => format!("{name} in `{dim}`"),
        (_, None) => format!("a quantity in `{dim}`"),
    }
}

/// Returns the description of a dimension for a label.
fn dim_label(dim: Dimension) -> String {
    match dim == Dimension::ONE {
        true => "this has no unit".to_owned(),
        false => format!("this is {}", describe_dim(dim)),
    }
}

/// Returns the diagnostic for a value whose dimension is not the expected one.
pub(crate) fn dimension_mismatch(expected: Dimension, found: MeasuredValue) -> Diagnostic {
    let message = format!(
        "expected {}, found {}",
        describe_dim(expected),
        describe_dim(found.dim)
    );
    let diagnostic =
        Diagnostic::new(Code::RPI2002, message).primary(found.span, dim_label(found.dim));
    with_suggestion(diagnostic, expected, found)
}

/// Returns the diagnostic for two operands with incompatible dimensions.
pub(crate) fn incompatible_dimensions(
    op: &str,
    left: MeasuredValue,
    right: MeasuredValue,
) -> Diagnostic {
    let message = format!(
        "`{op}` cannot take {} and {}",
        describe_dim(left.dim),
        describe_dim(right.dim)
    );
    let diagnostic = Diagnostic::new(Code::RPI2002, message)
        .primary(right.span, dim_label(right.dim))
        .secondary(left.span, dim_label(left.dim));
    match left.is_number && !right.is_number {
        true => with_suggestion(diagnostic, right.dim, left),
        false => with_suggestion(diagnostic, left.dim, right),
    }
}

/// Returns the diagnostic for a number without a unit where an angle is expected.
pub(crate) fn angle_without_unit(wanted: Dimension, found: MeasuredValue) -> Diagnostic {
    let message = format!(
        "expected {}, found {}",
        describe_dim(wanted),
        describe_dim(found.dim)
    );
    let diagnostic = Diagnostic::new(Code::RPI2004, message);
    match (found.is_number, wanted.divided_by(found.dim)) {
        (true, _) => with_unit_fixes(
            diagnostic.primary(found.span, "degrees or radians?"),
            wanted,
            found.span,
        ),
        (false, Some(Dimension::ANGLE)) if found.dim != Dimension::ONE => diagnostic
            .primary(found.span, "revolutions, degrees or radians?")
            .help("multiply by an angle: `1[rev]`, `1[rad]`"),
        _ => diagnostic
            .primary(found.span, "degrees or radians?")
            .help(format!(
                "declare it with its unit, or multiply by `1[{wanted}]`"
            )),
    }
}

/// Adds to a diagnostic how the value can be given the expected dimension.
fn with_suggestion(diagnostic: Diagnostic, wanted: Dimension, found: MeasuredValue) -> Diagnostic {
    if found.is_number && found.dim == Dimension::ONE {
        return with_unit_fixes(diagnostic, wanted, found.span);
    }
    if wanted.is_dimensionless() {
        return diagnostic.help(format!(
            "divide by a quantity in `{}` to get a plain number",
            found.dim
        ));
    }
    if found.dim.is_dimensionless() {
        return diagnostic.help(format!("multiply by a quantity in `{wanted}`"));
    }
    if found.dim.power(Ratio::HALF) == Some(wanted) {
        return diagnostic.help("its square root has the expected dimension: `sqrt(x)`");
    }
    if is_charge_for_temperature(wanted, found.dim) {
        return diagnostic.help(
            "`C` is the coulomb; temperatures are in kelvin, 20 degrees Celsius are `293.15[K]`",
        );
    }
    match wanted.divided_by(found.dim) {
        Some(factor) => diagnostic.help(format!(
            "{} to get the expected dimension",
            factor_text(factor)
        )),
        None => diagnostic,
    }
}

/// Returns the operation with a factor as text: "divide by a time in `s`", "multiply by ...".
fn factor_text(factor: Dimension) -> String {
    let (word, dim) = match factor.is_reciprocal() {
        true => ("divide", factor.inverse()),
        false => ("multiply", factor),
    };
    format!("{word} by {}", describe_dim(dim))
}

fn is_charge_for_temperature(wanted: Dimension, found: Dimension) -> bool {
    let charge = Dimension::base(BaseDim::Current).times(Dimension::TIME);
    wanted == Dimension::base(BaseDim::Temperature) && Some(found) == charge
}

/// Units that are commonly used for a dimension, by its coherent unit.
const COMMON_UNITS: &[(&str, &[&str])] = &[
    ("m", &["m", "mm"]),
    ("m/s", &["m/s", "mm/s"]),
    ("m/s^2", &["m/s^2", "mm/s^2"]),
    ("s", &["s", "ms"]),
    ("rad", &["deg", "rad"]),
    ("rad/s", &["deg/s", "rad/s"]),
    ("rad/s^2", &["deg/s^2", "rad/s^2"]),
];

/// Adds a fix for each unit that the author may have meant for a number.
pub(crate) fn with_unit_fixes(
    diagnostic: Diagnostic,
    wanted: Dimension,
    number: Span,
) -> Diagnostic {
    let coherent = wanted.to_string();
    let row = COMMON_UNITS.iter().find(|row| row.0 == coherent);
    let units = row.map_or(vec![&*coherent], |row| row.1.to_vec());
    let fixes = units.into_iter().map(|unit| {
        Fix::maybe(format!("use the unit `{unit}`")).insert_after(number, format!("[{unit}]"))
    });
    let mut diagnostic = diagnostic.help("write the unit after the number: `250[mm]`");
    diagnostic.fixes.extend(fixes);
    diagnostic
}

/// Returns the diagnostic for an invalid unit.
pub(crate) fn invalid_unit(fault: &UnitError) -> Diagnostic {
    match fault {
        UnitError::Unknown { name, span, near } => {
            let diagnostic = Diagnostic::new(Code::RPI2003, format!("unknown unit `{name}`"))
                .primary(*span, "not a unit");
            match is_celsius(name) {
                // Kelvin is not suggested: the value would be wrong by 273.15.
                true => {
                    diagnostic.help("temperatures are absolute: 20 degrees Celsius are `293.15[K]`")
                }
                false => diagnostic.did_you_mean(*span, near.clone()),
            }
        }
        UnitError::Exponent { span } => {
            Diagnostic::new(Code::RPI2003, "exponent of a unit out of range")
                .primary(*span, "too large")
        }
    }
}

fn is_celsius(name: &str) -> bool {
    // `C` is the coulomb.
    ["degC", "celsius"]
        .iter()
        .any(|one| one.eq_ignore_ascii_case(name))
}

/// Adds a suggestion for an operand that a unary operator does not accept.
pub(crate) fn with_operand_hint(diagnostic: Diagnostic, op: UnaryOp, ty: &Ty) -> Diagnostic {
    match ty {
        Ty::Int | Ty::Real(_) => {
            diagnostic.help("a condition is a comparison: `x = 0`, `x <= 0.0`")
        }
        Ty::Array(_, n) => diagnostic.help(format!(
            "apply it to each element: `map<<{}, {n}>>(a)`",
            op.spelling()
        )),
        _ => diagnostic,
    }
}
