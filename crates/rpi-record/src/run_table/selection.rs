//! Selection of the columns of a table by their names.

use std::collections::BTreeMap;

use super::error::TableError;
use crate::mcap::{Column, RunData, TopicColumns};

/// Column of a table: its name, and where its values are.
#[derive(Clone, Debug)]
pub struct TableColumn<'r> {
    /// Name of the topic and of the number in it, such as `/set_points/arm/joints[0]`.
    pub name: String,
    /// Topic to which the column belongs.
    pub topic: &'r TopicColumns,
    /// Values, by row of the topic.
    pub column: &'r Column,
}

/// Returns the columns with these names, or all if there are no names. The name of a topic, list or object stands for all columns
/// inside.
///
/// # Errors
/// Returns an error if a name selects nothing.
pub fn select<'r>(run: &'r RunData, names: &[String]) -> Result<Vec<TableColumn<'r>>, TableError> {
    let all = run.topics.iter().flat_map(|topic| {
        topic.columns.iter().map(move |column| TableColumn {
            name: format!("{}/{}", topic.name, column.name),
            topic,
            column,
        })
    });
    let all: Vec<TableColumn<'r>> = all.collect();
    let selects = |name: &String, column: &TableColumn<'_>| {
        let rest = column.name.strip_prefix(name.as_str());
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['/', '.', '[']))
    };
    for name in names {
        if !all.iter().any(|column| selects(name, column)) {
            let topics = run.topics.iter().map(|topic| topic.name.as_str());
            let columns = all.iter().map(|column| column.name.as_str());
            let near = rpi_diag::suggest(name, topics.chain(columns));
            return Err(TableError::UnknownColumn(name.clone(), near));
        }
    }
    let is_selected = |column: &TableColumn<'_>| {
        names.is_empty() || names.iter().any(|name| selects(name, column))
    };
    Ok(unique(all.into_iter().filter(is_selected)))
}

/// Makes the names of columns different. The value of a call and the output of the called node have the same name and values: one
/// of them is left out. Other columns, such as those of two commands with the same name, get a number.
fn unique<'r>(columns: impl Iterator<Item = TableColumn<'r>>) -> Vec<TableColumn<'r>> {
    let mut known: BTreeMap<String, Vec<TableColumn<'r>>> = BTreeMap::new();
    let mut unique = Vec::new();
    for mut column in columns {
        let same_name = known.entry(column.name.clone()).or_default();
        if same_name
            .iter()
            .any(|other| has_same_values(other, &column))
        {
            continue;
        }
        same_name.push(column.clone());
        if same_name.len() > 1 {
            column.name = format!("{}#{}", column.name, same_name.len());
        }
        unique.push(column);
    }
    unique
}

/// Returns whether two columns have the same bits in the same ticks.
fn has_same_values(one: &TableColumn<'_>, other: &TableColumn<'_>) -> bool {
    let (a, b) = (one.column, other.column);
    one.topic.ticks == other.topic.ticks
        && (a.kind, &a.unit, &a.absent, &a.integers) == (b.kind, &b.unit, &b.absent, &b.integers)
        && a.values
            .iter()
            .map(|v| v.to_bits())
            .eq(b.values.iter().map(|v| v.to_bits()))
}
