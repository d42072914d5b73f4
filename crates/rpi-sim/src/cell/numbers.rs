//! The methods of a reader for numbers in SI units and lists of them.

use super::quantity::{self, Dimension};
use super::reader::TableReader;
use super::shape::{ListLength, Sign, ValueShape};
use super::value::{Node, Value, in_unit};
use core::ops::RangeInclusive;

impl<'a> TableReader<'a> {
    /// Reads a finite number in SI units; `None` if the key is missing or invalid.
    pub(super) fn real(&mut self, key: &'static str, dimension: Dimension) -> Option<f64> {
        self.signed(key, dimension, Sign::Any)
    }

    /// Reads a finite number in SI units that is not negative; `None` if the key is missing or invalid.
    pub(super) fn magnitude(&mut self, key: &'static str, dimension: Dimension) -> Option<f64> {
        self.signed(key, dimension, Sign::NotNegative)
    }

    /// Reads a finite number in SI units that is greater than zero; `None` if the key is missing or invalid.
    pub(super) fn positive(&mut self, key: &'static str, dimension: Dimension) -> Option<f64> {
        self.signed(key, dimension, Sign::Positive)
    }

    /// Reads a finite number of a range in SI units; `None` if the key is missing or invalid.
    pub(super) fn real_within(
        &mut self,
        key: &'static str,
        dimension: Dimension,
        range: RangeInclusive<f64>,
    ) -> Option<f64> {
        let value = self.positive(key, dimension)?;
        let is_good = range.contains(&value);
        if !is_good {
            let unit = quantity::unit_suffix(dimension);
            let message = format!("`{key}` is {value}{unit}");
            let help = format!("the range is {} to {}{unit}", range.start(), range.end());
            self.error_at(key, message, Some(help));
        }
        is_good.then_some(value)
    }

    fn signed(&mut self, key: &'static str, dimension: Dimension, sign: Sign) -> Option<f64> {
        let given = self.get(key, || ValueShape::number(&[dimension], sign))?;
        let value = given.number(dimension)?;
        let unit = quantity::unit_suffix(dimension);
        let (is_good, expected) = match sign {
            Sign::Any => (true, String::new()),
            Sign::NotNegative => (value >= 0.0, format!("0{unit} or more")),
            Sign::Positive => (value > 0.0, format!("more than 0{unit}")),
        };
        if !is_good {
            let message = format!("`{key}` is {value}{unit}, expected {expected}");
            given.error(message, None);
        }
        is_good.then_some(value)
    }

    /// Reads a list of exactly `count` numbers in SI units; `None` if the key is missing or invalid.
    pub(super) fn reals(
        &mut self,
        key: &'static str,
        dimension: Dimension,
        count: usize,
    ) -> Option<Vec<f64>> {
        self.list_of(key, &vec![dimension; count])
    }

    /// Reads a list of any number of numbers in SI units; `None` if the key is missing or invalid.
    pub(super) fn reals_of_any_length(
        &mut self,
        key: &'static str,
        dimension: Dimension,
    ) -> Option<Vec<f64>> {
        let number = || ValueShape::number(&[dimension], Sign::Any);
        let given = self.get(key, || ValueShape::list(number(), ListLength::ANY))?;
        let list = given.list("a list of numbers")?;
        let dimensions = vec![dimension; list.len()];
        numbers(&list, &dimensions)
    }

    /// Reads a list with one number in SI units for each of `dimensions`; `None` if the key is missing or invalid.
    pub(super) fn list_of(
        &mut self,
        key: &'static str,
        dimensions: &[Dimension],
    ) -> Option<Vec<f64>> {
        let given = self.get(key, || {
            let number = ValueShape::number(dimensions, Sign::Any);
            ValueShape::list(number, ListLength::exactly(dimensions.len()))
        })?;
        let count = dimensions.len();
        let list = given.list(&format!("a list of {count} numbers{}", in_unit(dimensions)))?;
        if list.len() != count {
            let message = format!("`{key}` has {} entries, expected {count}", list.len());
            given.error(message, Some(quantity::expectation(dimensions)));
            return None;
        }
        numbers(&list, dimensions)
    }

    /// Reads one number, which stands for all `dimensions`, or a list with one number for each of them, in SI units.
    pub(super) fn one_or_list_of(
        &mut self,
        key: &'static str,
        dimensions: &[Dimension],
    ) -> Option<Vec<f64>> {
        let is_list = |node: Node<'a>| node.get_ref().is_array();
        let one = |reader: &mut Self| {
            let given = reader.get(key, || ValueShape::number(dimensions, Sign::Any))?;
            let values = dimensions.iter().map(|dimension| given.number(*dimension));
            values.collect()
        };
        self.either(key, is_list, |reader| reader.list_of(key, dimensions), one)
    }
}

/// Returns the numbers of the entries of a list, one for each of `dimensions`. Reports all invalid entries; then,
/// returns `None`.
fn numbers(list: &[Value<'_>], dimensions: &[Dimension]) -> Option<Vec<f64>> {
    let entries = list.iter().zip(dimensions);
    let values: Vec<Option<f64>> = entries
        .map(|(value, dimension)| value.number(*dimension))
        .collect();
    values.into_iter().collect()
}
