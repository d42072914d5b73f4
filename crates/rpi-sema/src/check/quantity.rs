//! Quantities in words: what is wrong with a unit or a dimension, and what would mend it.

use crate::ty::Ty;
use crate::units::{Base, Dim, Ratio, UnitFault};
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_syntax::ops::UnaryOp;

/// A value in a message: what it measures, where it stands, and whether it is a number as it is written.
#[derive(Clone, Copy)]
pub(super) struct Measured {
    pub(super) dim: Dim,
    pub(super) span: Span,
    pub(super) is_number: bool,
}

/// `a length in m`, `a quantity in m^2/s`, `a plain number`
pub(super) fn described(dim: Dim) -> String {
    match (dim == Dim::ONE, dim.quantity()) {
        (true, _) => "a plain number".to_owned(),
        (_, Some(name)) => format!("{name} in `{dim}`"),
        (_, None) => format!("a quantity in `{dim}`"),
    }
}

/// The same in a label.
fn labelled(dim: Dim) -> String {
    match dim == Dim::ONE {
        true => "this has no unit".to_owned(),
        false => format!("this is {}", described(dim)),
    }
}

/// A value of another dimension than its place wants.
pub(super) fn misplaced(expected: Dim, found: Measured) -> Finding {
    let message = format!(
        "expected {}, found {}",
        described(expected),
        described(found.dim)
    );
    let finding = Finding::new(Code::RPI2002, message).at(found.span, labelled(found.dim));
    mended(finding, expected, found)
}

/// Two values that an operator can not bring together.
pub(super) fn apart(op: &str, left: Measured, right: Measured) -> Finding {
    let message = format!(
        "`{op}` can not take {} and {}",
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

/// A number without unit where an angle is wanted.
pub(super) fn plain_angle(wanted: Dim, found: Measured) -> Finding {
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
            .help("multiplied by an angle it fits: `1[rev]`, `1[rad]`"),
        _ => finding.at(found.span, "degrees or radians?").help(format!(
            "give it its unit where it is declared, or multiply by `1[{wanted}]`"
        )),
    }
}

/// Adds what would make a value fit.
fn mended(finding: Finding, wanted: Dim, found: Measured) -> Finding {
    if found.is_number && found.dim == Dim::ONE {
        return with_units(finding, wanted, found.span);
    }
    if wanted.is_plain() {
        return finding.help(format!(
            "divided by a quantity in `{}` it is a plain number",
            found.dim
        ));
    }
    if found.dim.is_plain() {
        return finding.help(format!(
            "multiplied by a quantity in `{wanted}` it would fit"
        ));
    }
    if found.dim.power(Ratio::HALF) == Some(wanted) {
        return finding.help("its square root has the dimension: `sqrt(x)`");
    }
    if is_charge_for_temperature(wanted, found.dim) {
        return finding.help(
            "`C` is the coulomb; temperatures are in kelvin, 20 degrees Celsius are `293.15[K]`",
        );
    }
    match wanted.over(found.dim) {
        Some(factor) => finding.help(format!("{} it would fit", by(factor))),
        None => finding,
    }
}

/// "divided by a quantity in `s`", "multiplied by ..."
fn by(factor: Dim) -> String {
    let (word, dim) = match factor.is_inverse() {
        true => ("divided", factor.inverse()),
        false => ("multiplied", factor),
    };
    format!("{word} by {}", described(dim))
}

fn is_charge_for_temperature(wanted: Dim, found: Dim) -> bool {
    let charge = Dim::base(Base::Current).times(Dim::TIME);
    wanted == Dim::base(Base::Temperature) && Some(found) == charge
}

/// The units that a number of a dimension is often given in, the coherent one first.
const COMMON: &[(&str, &[&str])] = &[
    ("m", &["m", "mm"]),
    ("m/s", &["m/s", "mm/s"]),
    ("m/s^2", &["m/s^2", "mm/s^2"]),
    ("s", &["s", "ms"]),
    ("rad", &["deg", "rad"]),
    ("rad/s", &["deg/s", "rad/s"]),
    ("rad/s^2", &["deg/s^2", "rad/s^2"]),
];

/// Adds the units that may have been meant, each as a fix.
pub(super) fn with_units(finding: Finding, wanted: Dim, number: Span) -> Finding {
    let coherent = wanted.to_string();
    let row = COMMON.iter().find(|row| row.0 == coherent);
    let units = row.map_or(vec![&*coherent], |row| row.1.to_vec());
    let fixes = units.into_iter().map(|unit| {
        Fix::maybe(format!("take it in `{unit}`")).insert_after(number, format!("[{unit}]"))
    });
    let mut finding = finding.help("a number says its unit: `250[mm]`");
    finding.fixes.extend(fixes);
    finding
}

/// What is wrong with a unit, in words.
pub(super) fn unit_fault(fault: &UnitFault) -> Finding {
    match fault {
        UnitFault::Unknown { name, span, near } => {
            let finding = Finding::new(Code::RPI2003, format!("there is no unit `{name}`"))
                .at(*span, "not a unit");
            match is_celsius(name) {
                // The one would be taken for the other, 273.15 apart.
                true => {
                    finding.help("temperatures are absolute: 20 degrees Celsius are `293.15[K]`")
                }
                false => finding.did_you_mean(*span, near.clone()),
            }
        }
        UnitFault::Exponent { span } => {
            Finding::new(Code::RPI2003, "a unit with an exponent out of range")
                .at(*span, "too large")
        }
    }
}

fn is_celsius(name: &str) -> bool {
    // `C` is the coulomb.
    ["degC", "celsius"]
        .iter()
        .any(|one| one.eq_ignore_ascii_case(name))
}

/// Adds what may mend an operand that a unary operator does not take.
pub(super) fn operand_apart(finding: Finding, op: UnaryOp, ty: &Ty) -> Finding {
    match ty {
        Ty::Int | Ty::Real(_) => finding.help("a condition is a comparison: `x = 0`, `x <= 0.0`"),
        Ty::Array(_, n) => finding.help(format!(
            "element by element it is `map<<{}, {n}>>(a)`",
            op.spelling()
        )),
        _ => finding,
    }
}
