//! Text form of values, as in the reference system: parameters of nets and recorded traces.
//!
//! Booleans are `true` and `false`, reals may be `nan`, `+inf` and `-inf`, structured values are written
//! `{x:1.0,y:2.0,z:3.0}`, arrays `[1,2]`, an absent value `null`. Rotations are Euler angles in radians about z, then
//! y, then x of the turned frame (`{a:..,b:..,c:..}`). Times are milliseconds since the Unix epoch.

use std::fmt;

use rpi_image::{Scalar, SlotBits, Type, Value};
use rpi_prims::geometry;
use rpi_prims::value_types::FlowType;
use smallvec::smallvec;

mod tree;
mod write;

use tree::LiteralTree;
pub use write::{euler_angles, write};

/// Error: a text is not a literal of the expected type.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LiteralError {
    /// Position of the error in the text, in bytes from 0.
    pub offset: usize,
    /// Description of the error, such as `expected an integer`.
    pub message: String,
}

impl LiteralError {
    fn new(at: usize, message: impl Into<String>) -> LiteralError {
        LiteralError {
            offset: at,
            message: message.into(),
        }
    }
}

impl fmt::Display for LiteralError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for LiteralError {}

/// Parses the literal of a value of an element type, such as `{x:1.0,y:2.0,z:3.0}` for a vector. Returns `None` for
/// `null`, the literal of an absent value.
///
/// # Errors
/// Returns an error if the text is not a literal of this type.
pub fn parse_scalar(text: &str, scalar: Scalar) -> Result<Option<Value>, LiteralError> {
    let tree = tree::parse(text, 1)?;
    Ok(element(&tree, scalar)?.map(|cells| Value::Slots {
        ty: Type::Scalar(scalar),
        cells,
    }))
}

/// Parses the literal of an array with about `most` elements or fewer: a text with far more is rejected before it takes
/// memory, and the caller compares the exact number. An element `null` becomes `None`. Returns `None` for `null` in place
/// of the array.
///
/// # Errors
/// Returns an error if the text is not an array of this element type, or has too many elements.
pub fn parse_array(
    text: &str,
    scalar: Scalar,
    most: usize,
) -> Result<Option<Vec<Option<Value>>>, LiteralError> {
    let tree = tree::parse(text, most)?;
    if tree.is_null() {
        return Ok(None);
    }
    let value = |cells| Value::Slots {
        ty: Type::Scalar(scalar),
        cells,
    };
    let elements = tree.elements()?.iter();
    elements
        .map(|tree| Ok(element(tree, scalar)?.map(value)))
        .collect::<Result<_, _>>()
        .map(Some)
}

/// Parses the literal of a value of a flow type. Returns `None` for `null`, and for an array with a `null` element,
/// because a flow cannot have a part of an array absent.
///
/// # Errors
/// Returns an error if the text is not a literal of this type, or is an array of another length.
pub fn parse(text: &str, ty: Type) -> Result<Option<Value>, LiteralError> {
    let (scalar, len) = match ty {
        Type::Scalar(scalar) => return parse_scalar(text, scalar),
        Type::Array(scalar, len) => (scalar, len),
        Type::Matrix(..) => (Scalar::Real, ty.slots()),
    };
    let Some(elements) = parse_array(text, scalar, len as usize)? else {
        return Ok(None);
    };
    if elements.len() != len as usize {
        let message = format!(
            "expected {len} for {ty}, found {}",
            rpi_words::with_noun(elements.len(), "element")
        );
        return Err(LiteralError::new(0, message));
    }
    let elements: Option<Vec<Value>> = elements.into_iter().collect();
    Ok(elements.map(|elements| Value::Slots {
        ty,
        cells: elements.iter().flat_map(Value::slots).copied().collect(),
    }))
}

fn element(tree: &LiteralTree<'_>, scalar: Scalar) -> Result<Option<SlotBits>, LiteralError> {
    if tree.is_null() {
        return Ok(None);
    }
    parse_slots(tree, scalar).map(Some)
}

fn parse_slots(tree: &LiteralTree<'_>, scalar: Scalar) -> Result<SlotBits, LiteralError> {
    Ok(match scalar {
        Scalar::Bool => smallvec![u64::from(tree.word("true or false", parse_bool)?)],
        Scalar::Int => smallvec![tree.word("an integer", parse_int)?.cast_unsigned()],
        Scalar::Time => smallvec![
            tree.word("a time in milliseconds", parse_millis)?
                .cast_unsigned()
        ],
        Scalar::Real => smallvec![parse_real(tree)?.to_bits()],
        Scalar::Vector => parse_reals(tree, &["x", "y", "z"])?,
        Scalar::Rotation => {
            let angles = parse_reals(tree, &["a", "b", "c"])?;
            let [a, b, c] = [0, 1, 2].map(|k| f64::from_bits(angles[k]));
            to_slots(geometry::from_abc(a, b, c))
        }
        Scalar::Pose => parse_pair(tree, ("pos", Scalar::Vector), ("rot", Scalar::Rotation))?,
        Scalar::Twist => parse_pair(tree, ("vel", Scalar::Vector), ("rot", Scalar::Vector))?,
        Scalar::Wrench => parse_pair(tree, ("force", Scalar::Vector), ("torque", Scalar::Vector))?,
    })
}

fn to_slots<T: FlowType>(value: T) -> SlotBits {
    let mut cells: SlotBits = smallvec![0; T::SLOTS];
    value.store(&mut cells, 0);
    cells
}

type Field = (&'static str, Scalar);

fn parse_pair(tree: &LiteralTree<'_>, a: Field, b: Field) -> Result<SlotBits, LiteralError> {
    let [first, second] = tree.fields([a.0, b.0])?;
    let mut all = parse_slots(first, a.1)?;
    all.extend(parse_slots(second, b.1)?);
    Ok(all)
}

fn parse_reals(tree: &LiteralTree<'_>, keys: &[&'static str; 3]) -> Result<SlotBits, LiteralError> {
    let fields = tree.fields(*keys)?;
    fields
        .iter()
        .map(|f| Ok(parse_real(f)?.to_bits()))
        .collect()
}

/// Parses a real number. A number too large for a double is an error; the literal of infinity is `inf`.
fn parse_real(tree: &LiteralTree<'_>) -> Result<f64, LiteralError> {
    let value: f64 = tree.word("a number", |w| w.parse().ok())?;
    let is_meant = |word: &str| value.is_finite() || !word.contains(|c: char| c.is_ascii_digit());
    tree.word("a number that a real can hold, or inf", |word| {
        is_meant(word).then_some(value)
    })
}

fn parse_bool(word: &str) -> Option<bool> {
    word.parse().ok()
}

fn parse_int(word: &str) -> Option<i64> {
    word.parse().ok()
}

/// Parses a time in milliseconds since the Unix epoch, with at most six digits after the point. Returns nanoseconds;
/// `None` for an invalid or too large number.
fn parse_millis(word: &str) -> Option<i64> {
    let (whole, part) = word.split_once('.').unwrap_or((word, ""));
    let digits = part.bytes().all(|b| b.is_ascii_digit());
    let nanos: i64 = format!("{part:0<6}").get(..6)?.parse().ok()?;
    let whole: i64 = whole.parse::<i64>().ok()?.checked_mul(1_000_000)?;
    let signed = if word.starts_with('-') { -nanos } else { nanos };
    digits.then_some(whole)?.checked_add(signed)
}

#[cfg(test)]
mod tests;
