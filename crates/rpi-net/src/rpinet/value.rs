//! Parses and formats parameters.

use rpi_image::{ParamType, Type, Value};
use rpi_literal::LiteralError;
use std::borrow::Cow;

/// Parses the text that a net gives to a parameter of a primitive.
///
/// # Errors
/// Returns an error if the text is not a value of the type.
pub(super) fn parse(text: &str, ty: ParamType) -> Result<Value, LiteralError> {
    match ty {
        ParamType::Str => Ok(Value::Str(unescape(text).into_owned())),
        ParamType::Scalar(scalar) => {
            rpi_literal::parse_scalar(text, scalar)?.ok_or_else(absent_error)
        }
        ParamType::Array(scalar) => {
            // The importer bounds the length of the whole text.
            let elements = rpi_literal::parse_array(restore_bracket(text), scalar, text.len())?
                .ok_or_else(absent_error)?;
            let elements: Option<Vec<Value>> = elements.into_iter().collect();
            let elements = elements.ok_or_else(absent_error)?;
            let len = u32::try_from(elements.len()).map_err(|_| absent_error())?;
            Ok(Value::Slots {
                ty: Type::Array(scalar, len),
                cells: elements.iter().flat_map(Value::slots).copied().collect(),
            })
        }
    }
}

/// Returns the text of a parameter's value, which [`parse`] reads back to the same value.
#[must_use]
pub fn write(value: &Value) -> String {
    match value {
        Value::Str(text) => text.replace('\\', "\\\\").replace('\'', "\\'"),
        Value::Slots { ty, cells } => rpi_literal::write(cells, *ty),
    }
}

/// Returns the neutral value of a parameter type: 0, false or empty.
pub(super) fn neutral(ty: ParamType) -> Value {
    match ty {
        ParamType::Str => Value::Str(String::new()),
        ParamType::Scalar(_) | ParamType::Array(_) => Value::neutral(flow_type(ty)),
    }
}

/// Returns the type that a flow with the value of a parameter would have. Arrays have the size 0. A parameter that is a
/// text has no such type; the returned type is not used.
pub(super) fn flow_type(ty: ParamType) -> Type {
    match ty {
        ParamType::Scalar(scalar) => Type::Scalar(scalar),
        ParamType::Array(scalar) => Type::Array(scalar, 0),
        ParamType::Str => Type::Scalar(rpi_image::Scalar::Bool),
    }
}

fn absent_error() -> LiteralError {
    LiteralError {
        offset: 0,
        message: "a parameter cannot be absent".into(),
    }
}

/// Returns the text of an empty array with the `[` that the reference system leaves out; other texts are unchanged.
fn restore_bracket(text: &str) -> &str {
    if text.trim() == "]" { "[]" } else { text }
}

/// Returns the text with the escapes `\'` and `\\` resolved. Other backslashes are literal, as in the texts of the
/// reference system.
fn unescape(text: &str) -> Cow<'_, str> {
    if !text.contains('\\') {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len());
    let mut signs = text.chars().peekable();
    while let Some(sign) = signs.next() {
        match (sign, signs.peek()) {
            ('\\', Some(&escaped @ ('\'' | '\\'))) => {
                plain.push(escaped);
                signs.next();
            }
            _ => plain.push(sign),
        }
    }
    Cow::Owned(plain)
}
