//! Diagnostics about units and dimensions, with suggestions.

use crate::ty::Ty;
use crate::units::{BaseDim, Dimension, Ratio, UnitError};
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};
use rpi_syntax::ops::UnaryOp;

/// Value in a diagnostic about physical quantities: its dimension, its location, and whether it is a number literal.
#[derive(Clone, Copy)]
pub(crate) struct MeasuredValue {
    pub(crate) dim: Dimension,
    pub(crate) span: Span,
    pub(crate) is_number: bool,
}

/// Returns a description of a dimension, such as `a length in m`, `a quantity in m^2/s` or `a plain number`.
pub(crate) fn describe_dim(dim: Dimension) -> String {
    match (dim == Dimension::ONE, dim.quantity_literal()) {
        (true, _) => "a plain number".to_owned(),
        (_, Some(name)) => format!("{name} in `{dim}`"),
        (_, None) => format!("a quantity in `{dim}`"),
    }
}

/// Returns the text "this is ..." with a description of a dimension, for the label of a value.
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

/// Returns the diagnostic for an operator `op` whose two operands have incompatible dimensions.
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

/// Returns the diagnostic for a value without an angle unit where the dimension `wanted` contains an angle.
pub(crate) fn angle_without_unit(wanted: Dimension, found: MeasuredValue) -> Diagnostic {
    let message = format!(
        "expected {}, found {}",
        describe_dim(wanted),
        describe_dim(found.dim)
    );
    let diagnostic = Diagnostic::new(Code::RPI2004, message);
    let lacks_unit = found.is_number && found.dim == Dimension::ONE;
    match (lacks_unit, wanted.divided_by(found.dim)) {
        (true, _) => with_unit_fixes(
            diagnostic.primary(found.span, "degrees or radians?"),
            wanted,
            found.span,
        ),
        (false, Some(Dimension::ANGLE)) if found.dim != Dimension::ONE => diagnostic
            .primary(found.span, "revolutions, degrees or radians?")
            .help(format!(
                "multiply it by the angle of one unit: `{0} * 1[rev]`, `{0} * 1[rad]`",
                Quote::operand(found.span)
            )),
        _ => diagnostic
            .primary(found.span, "degrees or radians?")
            .help(format!(
                "declare it with its unit, or multiply by `1[{wanted}]`"
            )),
    }
}

/// Adds help on how the value `found` can be given the dimension `wanted`.
fn with_suggestion(diagnostic: Diagnostic, wanted: Dimension, found: MeasuredValue) -> Diagnostic {
    if found.is_number && found.dim == Dimension::ONE {
        return with_unit_fixes(diagnostic, wanted, found.span);
    }
    if wanted.is_dimensionless() && found.dim.has_free() {
        return diagnostic.help(SAME_PARAMETER_HELP);
    }
    if wanted.is_dimensionless() {
        return diagnostic.help(plain_value_help(found));
    }
    if found.dim.is_dimensionless() {
        return diagnostic.help(format!("multiply by {}", describe_dim(wanted)));
    }
    if found.dim.power(Ratio::HALF) == Some(wanted) {
        return diagnostic.help(format!(
            "its square root has the expected dimension: `sqrt({})`",
            Quote::text(found.span)
        ));
    }
    if is_charge_for_temperature(wanted, found.dim) {
        return diagnostic.help(
            "`C` is the coulomb; temperatures are in kelvin, 20 degrees Celsius are `293.15[K]`",
        );
    }
    diagnostic.help(conversion_help(wanted, found))
}

/// Help for values of different type parameters.
const SAME_PARAMETER_HELP: &str = "a call may choose different units for type parameters; give both values the same type parameter";

/// Returns the help text on how a plain number is obtained from a quantity of this dimension.
pub(crate) fn plain_number_help(found: Dimension) -> String {
    format!("divide by {} to get a plain number", describe_dim(found))
}

/// Returns the advice to get a plain number from this value.
fn plain_value_help(value: MeasuredValue) -> String {
    match value.is_number {
        true => "write the number without a unit".to_owned(),
        false => format!(
            "divide it by one unit to get a plain number: `({} / 1[{}])`",
            Quote::operand(value.span),
            value.dim
        ),
    }
}

/// Returns the help text on how a quantity of the dimension `wanted` is obtained from `value`, which has another
/// dimension. A factor is suggested only if it is a usual quantity, such as a time, and not one in `m/N`.
fn conversion_help(wanted: Dimension, value: MeasuredValue) -> String {
    let found = value.dim;
    if value.is_number && !wanted.has_free() {
        return format!(
            "correct the unit of the number: {} has the unit `{wanted}`",
            wanted.quantity_literal().unwrap_or("the expected value")
        );
    }
    let factor = wanted.divided_by(found);
    if let Some(operation) = factor.and_then(|factor| usual_operation(factor, found)) {
        return format!("{operation} to get {}", short_name(wanted, "a"));
    }
    if wanted == found.inverse() {
        return format!(
            "its reciprocal has the expected dimension: `1.0 / {}`",
            Quote::operand(value.span)
        );
    }
    if wanted.has_free() && found.has_free() {
        return SAME_PARAMETER_HELP.to_owned();
    }
    format!(
        "check which value is meant: no usual factor turns {} into {}",
        short_name(found, "a"),
        short_name(wanted, "a")
    )
}

/// Returns a text such as "divide the length by a time in `s`" for multiplying a quantity of the dimension `found` by
/// `factor`. `None` unless the factor, its reciprocal, or the square root of one of them is a usual quantity.
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

/// Returns the name of a quantity with an article and without its unit, such as `the time`. A quantity without a name
/// is described by its unit: `the value in m*s`.
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

/// Units that are commonly used for a dimension, each row with the coherent SI unit of the dimension first.
const COMMON_UNITS: &[(&str, &[&str])] = &[
    ("m", &["m", "mm"]),
    ("m/s", &["m/s", "mm/s"]),
    ("m/s^2", &["m/s^2", "mm/s^2"]),
    ("s", &["s", "ms"]),
    ("rad", &["deg", "rad"]),
    ("rad/s", &["deg/s", "rad/s"]),
    ("rad/s^2", &["deg/s^2", "rad/s^2"]),
];

/// Adds a fix for each common unit of the dimension `wanted` that the author may have meant for the number at `number`.
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
    let mut diagnostic = diagnostic
        .help("a number without a unit in brackets is a plain number: add the unit that is meant");
    diagnostic.fixes.extend(fixes);
    diagnostic
}

/// Returns the diagnostic for a unit in brackets that is unknown or has an exponent that is out of range.
pub(crate) fn invalid_unit(fault: &UnitError) -> Diagnostic {
    match fault {
        UnitError::Unknown { name, span, near } => {
            let diagnostic = Diagnostic::new(Code::RPI2003, format!("unknown unit `{name}`"))
                .primary(*span, "not a unit");
            match is_celsius(name) {
                // Kelvin is not suggested: the value would be wrong by 273.15.
                true => diagnostic
                    .help("temperatures are in kelvin, `K`: 20 degrees Celsius are `293.15[K]`"),
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

/// Adds help for an operand of the type `ty` that the unary operator `op` does not accept.
pub(crate) fn with_operand_hint(
    diagnostic: Diagnostic,
    op: UnaryOp,
    ty: &Ty,
    operand: Span,
) -> Diagnostic {
    let name = Quote::operand(operand);
    match ty {
        Ty::Int => diagnostic.help(format!("a condition is a comparison, such as `{name} = 0`")),
        Ty::Real(_) | Ty::Duration => diagnostic.help(format!(
            "a condition is a comparison, such as `{name} <= {}`",
            ty.zero_literal().unwrap_or("0".to_owned())
        )),
        Ty::Array(_, n) => diagnostic.help(format!(
            "apply it to each element: `map<<{}, {n}>>({name})`",
            op.spelling()
        )),
        _ => diagnostic,
    }
}
