//! Constants in C.

use rpi_image::Scalar;

/// Returns the C notation of a constant of type `ty` with these 64 bits.
pub(super) fn literal(bits: u64, ty: Scalar) -> String {
    match ty {
        Scalar::Bool => if bits != 0 { "true" } else { "false" }.to_owned(),
        Scalar::Int | Scalar::Time if bits == 1 << 63 => "INT64_MIN".to_owned(),
        Scalar::Int | Scalar::Time => format!("INT64_C({})", bits.cast_signed()),
        _ => real_literal(f64::from_bits(bits)),
    }
}

/// Returns the C notation of a real constant. A negative number is put in parentheses, so that a minus sign can precede
/// it.
pub(super) fn real_literal(v: f64) -> String {
    if v.is_nan() {
        return "NAN".to_owned();
    }
    if v.is_infinite() {
        return if v > 0.0 { "INFINITY" } else { "-INFINITY" }.to_owned();
    }
    let text = format!("{v:?}");
    // Without parentheses, `-{a}` with a negative constant would become the C operator `--`.
    if v.is_sign_negative() {
        format!("({text})")
    } else {
        text
    }
}
