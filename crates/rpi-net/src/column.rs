//! Columns of sample tables: one scalar leaf of an input or output of a net that runs stand-alone.

use crate::column_error::ColumnError;
use rpi_image::{Scalar, Type};

/// Column of a table of samples: the name and the value format of one leaf, which is a scalar part of a flow.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Column {
    /// Name of the flow with the path to the leaf: `x`, `x.field`, `x[2].field`.
    pub key: String,
    /// Machine type of the values in the column.
    pub scalar: Scalar,
    /// Names of the values if the leaf has an enum type, in declaration order; empty for other types.
    pub enum_values: Vec<String>,
    /// Whether the flow may be absent in a cycle.
    pub optional: bool,
    /// Lowest and highest value, for an integer with a subrange type; `None` for other types.
    pub range: Option<[i64; 2]>,
}

impl Column {
    /// Parses the text of a field to the memory slots of the value.
    ///
    /// Accepts `true` or `false`, an integer, a real, an enum value by name or number, or else a literal of the net's
    /// text form.
    ///
    /// # Errors
    /// Returns the expected form if the text is not a value of the column's type.
    pub fn parse(&self, text: &str) -> Result<Vec<u64>, ColumnError> {
        let cell = match self.scalar {
            Scalar::Bool => parse_bool(text).map(u64::from),
            Scalar::Int => self.integer(text).map(i64::cast_unsigned),
            Scalar::Real => parse_real(text).map(f64::to_bits),
            _ => return self.literal(text),
        };
        cell.map(|cell| vec![cell])
            .ok_or_else(|| ColumnError::UnexpectedText {
                text: text.to_owned(),
                expected: self.expected(),
            })
    }

    fn integer(&self, text: &str) -> Option<i64> {
        let named = self.enum_values.iter().position(|value| value == text);
        match named.and_then(|place| i64::try_from(place).ok()) {
            Some(place) => Some(place),
            // Numbers beyond the last enum value are accepted as well: traces of Lustre V6 contain them.
            None => text.parse().ok(),
        }
    }

    fn literal(&self, text: &str) -> Result<Vec<u64>, ColumnError> {
        match rpi_literal::parse(text, Type::Scalar(self.scalar)) {
            Ok(Some(value)) => Ok(value.slots().to_vec()),
            Ok(None) => Err(ColumnError::Null),
            Err(error) => Err(ColumnError::InvalidLiteral {
                text: text.to_owned(),
                type_name: self.scalar.name(),
                reason: error.to_string(),
            }),
        }
    }

    fn expected(&self) -> String {
        match self.scalar {
            Scalar::Bool => "`true` or `false`".to_owned(),
            Scalar::Int if !self.enum_values.is_empty() => {
                format!("one of {}", self.enum_values.join(", "))
            }
            Scalar::Int => "an integer of 64 bits".to_owned(),
            _ => "a real of 64 bits".to_owned(),
        }
    }

    /// Returns the text of a value, given by its memory slots. Reals are written such that they parse to the same bits.
    #[must_use]
    pub fn format(&self, cells: &[u64]) -> String {
        let cell = cells.first().copied().unwrap_or_default();
        match self.scalar {
            Scalar::Bool => (cell != 0).to_string(),
            Scalar::Int => self.enum_text(cell.cast_signed()),
            Scalar::Real => format!("{:?}", f64::from_bits(cell)),
            ty => rpi_literal::write(cells, Type::Scalar(ty)),
        }
    }

    fn enum_text(&self, place: i64) -> String {
        let value = usize::try_from(place)
            .ok()
            .and_then(|k| self.enum_values.get(k));
        value.map_or_else(|| place.to_string(), Clone::clone)
    }
}

/// Parses a real; `None` if the text is no real. Digits that overflow to infinity are rejected; `inf` is accepted.
fn parse_real(text: &str) -> Option<f64> {
    let value: f64 = text.parse().ok()?;
    let is_held = value.is_finite() || !text.contains(|c: char| c.is_ascii_digit());
    is_held.then_some(value)
}

fn parse_bool(text: &str) -> Option<bool> {
    match text {
        "true" | "t" | "1" => Some(true),
        "false" | "f" | "0" => Some(false),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(ty: Scalar, values: &[&str]) -> Column {
        Column {
            key: "x".to_owned(),
            scalar: ty,
            enum_values: values.iter().map(ToString::to_string).collect(),
            optional: false,
            range: None,
        }
    }

    #[test]
    fn reals_read_back_as_the_same_bits() {
        let real = column(Scalar::Real, &[]);
        for value in [0.1, -0.0, 1e300, f64::INFINITY, 5e-324] {
            let text = real.format(&[value.to_bits()]);
            assert_eq!(real.parse(&text), Ok(vec![value.to_bits()]), "{text}");
        }
    }

    #[test]
    fn values_of_an_enum_are_named_and_may_be_numbered() {
        let mode = column(Scalar::Int, &["Off", "On"]);
        assert_eq!(mode.parse("On"), Ok(vec![1]));
        assert_eq!(mode.parse("1"), Ok(vec![1]));
        assert_eq!(mode.format(&[1]), "On");
        assert!(
            mode.parse("Of")
                .unwrap_err()
                .to_string()
                .contains("one of Off, On")
        );
    }

    #[test]
    fn what_is_no_value_is_told() {
        let truth = column(Scalar::Bool, &[]);
        assert!(
            truth
                .parse("yes")
                .unwrap_err()
                .to_string()
                .contains("`true` or `false`")
        );
        assert!(column(Scalar::Int, &[]).parse("1.5").is_err());
        let real = column(Scalar::Real, &[]);
        assert_eq!(
            real.parse("1e400").unwrap_err().to_string(),
            "`1e400` is not a real of 64 bits"
        );
    }
}
