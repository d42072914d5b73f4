//! Fields of an Arrow table: the columns of a run, of which elements of a list are one field.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use arrow_array::{ArrayRef, BooleanArray, FixedSizeListArray, Float64Array, Int64Array};
use arrow_buffer::NullBuffer;
use arrow_schema::{DataType, Field};

use super::error::TableError;
use super::rows::{Row, TableValue};
use super::selection::TableColumn;
use crate::mcap::ColumnKind;

/// Field of a table: a number, or a list of numbers of one kind and unit.
pub(super) struct TableField {
    name: String,
    kind: ColumnKind,
    unit: String,
    /// Name of the topic from which the values come.
    topic: String,
    /// Indices of its columns in the selection.
    columns: Range<usize>,
    is_list: bool,
}

/// Returns the fields of the selected columns.
pub(super) fn fields(columns: &[TableColumn<'_>]) -> Vec<TableField> {
    let mut fields: Vec<TableField> = Vec::new();
    for (index, column) in columns.iter().enumerate() {
        let element = element(&column.name);
        if let (Some((list, number)), Some(last)) = (element, fields.last_mut())
            && last.continues(list, number, column)
        {
            last.columns.end += 1;
            continue;
        }
        // A list begins with element 0. One of which only later elements are selected has a field for each.
        let list = element.filter(|(_, number)| *number == 0);
        fields.push(TableField {
            name: list
                .map_or(column.name.as_str(), |(list, _)| list)
                .to_owned(),
            kind: column.column.kind,
            unit: column.column.unit.clone(),
            topic: column.topic.name.clone(),
            columns: index..index + 1,
            is_list: list.is_some(),
        });
    }
    fields
}

/// Splits the name of an element of a list, such as `/set_points/arm/joints[2]`, into the name of the list and the index.
fn element(name: &str) -> Option<(&str, usize)> {
    let (list, index) = name.strip_suffix(']')?.rsplit_once('[')?;
    Some((list, index.parse().ok()?))
}

impl TableField {
    /// Returns whether a column is the next element of this list.
    fn continues(&self, list: &str, number: usize, column: &TableColumn<'_>) -> bool {
        self.is_list
            && self.name == list
            && self.columns.len() == number
            && (self.kind, &self.unit) == (column.column.kind, &column.column.unit)
            && self.topic == column.topic.name
    }

    /// Returns the number of columns of the field.
    fn width(&self) -> i32 {
        i32::try_from(self.columns.len()).unwrap_or(i32::MAX)
    }

    fn number_type(&self) -> DataType {
        match self.kind {
            ColumnKind::Bool => DataType::Boolean,
            ColumnKind::Int => DataType::Int64,
            ColumnKind::Real => DataType::Float64,
        }
    }

    fn item(&self) -> Arc<Field> {
        Arc::new(Field::new("item", self.number_type(), true))
    }

    /// Returns the field with its type, unit and topic for the schema.
    pub(super) fn to_arrow(&self) -> Field {
        let number = self.number_type();
        let kind = match self.is_list {
            true => DataType::FixedSizeList(self.item(), self.width()),
            false => number,
        };
        let metadata = [("source", &self.topic), ("name", &self.name)];
        let metadata = metadata.map(|(key, value)| (key.to_owned(), value.clone()));
        let mut metadata = HashMap::from(metadata);
        if !self.unit.is_empty() {
            metadata.insert("unit".to_owned(), self.unit.clone());
        }
        // Readers take a dot in the name of a list as the way into a structure: `pyarrow` does not find such a column.
        let name = self.name.replace('.', "/");
        Field::new(name, kind, true).with_metadata(metadata)
    }

    /// Returns the values of the field in the rows.
    ///
    /// # Errors
    /// Returns an error if a list is too long for the format.
    pub(super) fn array(&self, rows: &[Row]) -> Result<ArrayRef, TableError> {
        let values = rows
            .iter()
            .flat_map(|row| &row.values[self.columns.clone()]);
        let numbers = numbers(self.kind, values);
        if !self.is_list {
            return Ok(numbers);
        }
        let has_value = |row: &Row| row.values[self.columns.clone()].iter().any(Option::is_some);
        let present = NullBuffer::from_iter(rows.iter().map(has_value));
        let list = FixedSizeListArray::try_new(self.item(), self.width(), numbers, Some(present));
        let list = list.map_err(|error| TableError::Format(error.to_string()))?;
        Ok(Arc::new(list))
    }
}

/// Returns values of one kind as an array; a missing value is null.
fn numbers<'v>(kind: ColumnKind, values: impl Iterator<Item = &'v Option<TableValue>>) -> ArrayRef {
    let values = values.copied();
    match kind {
        ColumnKind::Bool => Arc::new(BooleanArray::from_iter(values.map(|value| match value {
            Some(TableValue::Bool(value)) => Some(value),
            _ => None,
        }))),
        ColumnKind::Int => Arc::new(Int64Array::from_iter(values.map(|value| match value {
            Some(TableValue::Int(value)) => Some(value),
            _ => None,
        }))),
        ColumnKind::Real => Arc::new(Float64Array::from_iter(values.map(|value| match value {
            Some(TableValue::Real(value)) => Some(value),
            _ => None,
        }))),
    }
}
