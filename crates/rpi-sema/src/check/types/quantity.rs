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
        return diagnostic.help(plain_number_help(found.dim));
    }
    if found.dim.is_dimensionless() {
        return diagnostic.help(format!("multiply by {}", describe_dim(wanted)));
    }
    if found.dim.power(Ratio::HALF) == Some(wanted) {
        return diagnostic.help("its square root has the expected dimension: `sqrt(x)`");
    }
    if is_charge_for_temperature(wanted, found.dim) {
        return diagnostic.help(
            "`C` is the coulomb; temperatures are in kelvin, 20 degrees Celsius are `293.15[K]`",
        );
    }
    diagnostic.help(conversion_help(wanted, found.dim))
}

/// Returns the advice to get a plain number from a quantity.
pub(crate) fn plain_number_help(found: Dimension) -> String {
    format!("divide by {} to get a plain number", describe_dim(found))
}

/// Returns the advice to get a quantity of the dimension `wanted` from one of the dimension `found`. A factor is named
/// only if it is a usual quantity: nobody multiplies a force by a quantity in `m/N` because a type asks for it.
fn conversion_help(wanted: Dimension, found: Dimension) -> String {
    let factor = wanted.divided_by(found);
    if let Some(operation) = factor.and_then(|factor| usual_operation(factor, found)) {
        return format!("{operation} to get {}", short_name(wanted, "a"));
    }
    if wanted == found.inverse() {
        return "its reciprocal has the expected dimension: `1.0 / x`".to_owned();
    }
    if wanted.has_free() && found.has_free() {
        return "a call may choose different units for type parameters; give both values the same type parameter".to_owned();
    }
    format!(
        "check which value is meant: no usual factor turns {} into {}",
        short_name(found, "a"),
        short_name(wanted, "a")
    )
}

/// Returns the operation with a factor as text, if the factor is a usual quantity or the square of one: "divide the length
/// by a time in `s`", "multiply ...".
fn usual_operation(factor: Dimension, found: Dimension) -> Option<String> {
    let operation = |word: &str, dim: Dimension, often: &str| {
        let by = dim.quantity_literal().map(|_| describe_dim(dim))?;
        Some(format!(
            "{word} {} {often}by {by}",
            short_name(found, "the")
        ))
    };
    let root = |dim: Dimension| dim.power(Ratio::HALF);
    match factor.is_reciprocal() {
        true => operation("divide", factor.inverse(), "")
            .or_else(|| operation("divide", root(factor.inverse())?, "twice ")),
        false => operation("multiply", factor, "")
            .or_else(|| operation("multiply", root(factor)?, "twice ")),
    }
}

/// Returns the name of a quantity after an article, without its unit: `the time`; for a quantity without a name, its
/// unit: `the value in m*s`.
fn short_name(dim: Dimension, article: &str) -> String {
    match dim.quantity_literal() {
        Some(name) if article == "a" => name.to_owned(),
        Some(name) => {
            let noun = name.split_once(' ').map_or(name, |(_, noun)| noun);
            format!("{article} {noun}")
        }
        None => format!("{article} value in `{dim}`"),
    }
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

/// Returns the diagnostic for a unit in brackets that is unknown or has an exponent out of range.
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
pub(crate) fn with_operand_hint(
    diagnostic: Diagnostic,
    op: UnaryOp,
    ty: &Ty,
    name: &str,
) -> Diagnostic {
    match ty {
        Ty::Int | Ty::Real(_) => diagnostic.help(match ty {
            Ty::Int => format!("a condition is a comparison: `{name} = 0`"),
            _ => format!("a condition is a comparison: `{name} <= 0.0`"),
        }),
        Ty::Array(_, n) => diagnostic.help(format!(
            "apply it to each element: `map<<{}, {n}>>({name})`",
            op.spelling()
        )),
        _ => diagnostic,
    }
}
