//! Diagnostics about units and dimensions, with suggestions.

use crate::ty::Ty;
use crate::units::{Base, Dim, Ratio, UnitFault};
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_syntax::ops::UnaryOp;

/// A value in a diagnostic: its dimension, its location, and whether it is a number literal.
#[derive(Clone, Copy)]
pub(crate) struct Measured {
    pub(crate) dim: Dim,
    pub(crate) span: Span,
    pub(crate) is_number: bool,
}

/// Returns the description of a dimension: `a length in m`, `a quantity in m^2/s`, `a plain number`.
pub(crate) fn described(dim: Dim) -> String {
    match (dim == Dim::ONE, dim.quantity()) {
        (true, _) => "a plain number".to_owned(),
        (_, Some(name)) => format!("{name} in `{dim}`"),
        (_, None) => format!("a quantity in `{dim}`"),
    }
}

/// Returns the description of a dimension for a label.
fn labelled(dim: Dim) -> String {
    match dim == Dim::ONE {
        true => "this has no unit".to_owned(),
        false => format!("this is {}", described(dim)),
    }
}

/// Returns the diagnostic for a value whose dimension is not the expected one.
pub(crate) fn misplaced(expected: Dim, found: Measured) -> Finding {
    let message = format!(
        "expected {}, found {}",
        described(expected),
        described(found.dim)
    );
    let finding = Finding::new(Code::RPI2002, message).at(found.span, labelled(found.dim));
    mended(finding, expected, found)
}

/// Returns the diagnostic for two operands with incompatible dimensions.
pub(crate) fn apart(op: &str, left: Measured, right: Measured) -> Finding {
    let message = format!(
        "`{op}` cannot take {} and {}",
        described(left.dim),
        described(right.dim)
    );
    let finding = Finding::new(Code::RPI2002, message)
        .at(right.span, labelled(right.dim))
        .also(left.span, labelled(left.dim));
    match left.is_number && !right.is_number {
        true => mended(finding, right.dim, left),
        false => mended(finding, left.dim, right),
    }
}

/// Returns the diagnostic for a number without a unit where an angle is expected.
pub(crate) fn plain_angle(wanted: Dim, found: Measured) -> Finding {
    let message = format!(
        "expected {}, found {}",
        described(wanted),
        described(found.dim)
    );
    let finding = Finding::new(Code::RPI2004, message);
    match (found.is_number, wanted.over(found.dim)) {
        (true, _) => with_units(
            finding.at(found.span, "degrees or radians?"),
            wanted,
            found.span,
        ),
        (false, Some(Dim::ANGLE)) if found.dim != Dim::ONE => finding
            .at(found.span, "revolutions, degrees or radians?")
            .help("multiply by an angle: `1[rev]`, `1[rad]`"),
        _ => finding.at(found.span, "degrees or radians?").help(format!(
            "declare it with its unit, or multiply by `1[{wanted}]`"
        )),
    }
}

/// Adds a suggestion that gives a value the expected dimension.
fn mended(finding: Finding, wanted: Dim, found: Measured) -> Finding {
    if found.is_number && found.dim == Dim::ONE {
        return with_units(finding, wanted, found.span);
    }
    if wanted.is_plain() {
        return finding.help(format!(
            "divide by a quantity in `{}` to get a plain number",
            found.dim
        ));
    }
    if found.dim.is_plain() {
        return finding.help(format!("multiply by a quantity in `{wanted}`"));
    }
    if found.dim.power(Ratio::HALF) == Some(wanted) {
        return finding.help("its square root has the expected dimension: `sqrt(x)`");
    }
    if is_charge_for_temperature(wanted, found.dim) {
        return finding.help(
            "`C` is the coulomb; temperatures are in kelvin, 20 degrees Celsius are `293.15[K]`",
        );
    }
    match wanted.over(found.dim) {
        Some(factor) => finding.help(format!("{} to get the expected dimension", by(factor))),
        None => finding,
    }
}

/// Returns the operation with a factor: "divide by a time in `s`", "multiply by ...".
fn by(factor: Dim) -> String {
    let (word, dim) = match factor.is_inverse() {
        true => ("divide", factor.inverse()),
        false => ("multiply", factor),
    };
    format!("{word} by {}", described(dim))
}

fn is_charge_for_temperature(wanted: Dim, found: Dim) -> bool {
    let charge = Dim::base(Base::Current).times(Dim::TIME);
    wanted == Dim::base(Base::Temperature) && Some(found) == charge
}

/// Units that are common for a dimension, by its coherent unit.
const COMMON: &[(&str, &[&str])] = &[
    ("m", &["m", "mm"]),
    ("m/s", &["m/s", "mm/s"]),
    ("m/s^2", &["m/s^2", "mm/s^2"]),
    ("s", &["s", "ms"]),
    ("rad", &["deg", "rad"]),
    ("rad/s", &["deg/s", "rad/s"]),
    ("rad/s^2", &["deg/s^2", "rad/s^2"]),
];

/// Adds a fix for each unit that may have been meant.
pub(crate) fn with_units(finding: Finding, wanted: Dim, number: Span) -> Finding {
    let coherent = wanted.to_string();
    let row = COMMON.iter().find(|row| row.0 == coherent);
    let units = row.map_or(vec![&*coherent], |row| row.1.to_vec());
    let fixes = units.into_iter().map(|unit| {
        Fix::maybe(format!("use the unit `{unit}`")).insert_after(number, format!("[{unit}]"))
    });
    let mut finding = finding.help("write the unit after the number: `250[mm]`");
    finding.fixes.extend(fixes);
    finding
}

/// Returns the diagnostic for an invalid unit.
pub(crate) fn unit_fault(fault: &UnitFault) -> Finding {
    match fault {
        UnitFault::Unknown { name, span, near } => {
            let finding = Finding::new(Code::RPI2003, format!("unknown unit `{name}`"))
                .at(*span, "not a unit");
            match is_celsius(name) {
                // Kelvin is not suggested: the value would be wrong by 273.15.
                true => {
                    finding.help("temperatures are absolute: 20 degrees Celsius are `293.15[K]`")
                }
                false => finding.did_you_mean(*span, near.clone()),
            }
        }
        UnitFault::Exponent { span } => {
            Finding::new(Code::RPI2003, "exponent of a unit out of range").at(*span, "too large")
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
pub(crate) fn operand_apart(finding: Finding, op: UnaryOp, ty: &Ty) -> Finding {
    match ty {
        Ty::Int | Ty::Real(_) => finding.help("a condition is a comparison: `x = 0`, `x <= 0.0`"),
        Ty::Array(_, n) => finding.help(format!(
            "apply it to each element: `map<<{}, {n}>>(a)`",
            op.spelling()
        )),
        _ => finding,
    }
}
