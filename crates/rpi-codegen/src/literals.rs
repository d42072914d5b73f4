//! Constants as C text.

use crate::c_type::CType;

/// Returns a C expression for the value of type `ty` with the given bits.
pub(crate) fn literal(bits: u64, ty: CType) -> String {
    match ty {
        CType::Bool => (bits != 0).to_string(),
        CType::Int => integer(bits.cast_signed()),
        CType::Real => real(f64::from_bits(bits)),
        CType::Word => format!("UINT64_C({bits:#x})"),
    }
}

fn integer(value: i64) -> String {
    match value {
        i64::MIN => "INT64_MIN".to_owned(),
        value if value < 0 => format!("(-INT64_C({}))", -value),
        value => format!("INT64_C({value})"),
    }
}

/// Rust prints the shortest decimal number that is rounded to the value, which C compilers read back exactly.
fn real(value: f64) -> String {
    if value.is_nan() {
        return "rpi_nan()".to_owned();
    }
    let size = match value.is_infinite() {
        true => "rpi_infinity()".to_owned(),
        false => format!("{:?}", value.abs()),
    };
    match value.is_sign_negative() {
        true => format!("(-{size})"),
        false => size,
    }
}
