//! Rows of a table: the values of its columns in each tick.

use std::ops::Range;

use super::selection::TableColumn;
use crate::mcap::{ColumnKind, RunData};

/// Value of a column in a row.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum TableValue {
    /// Boolean.
    Bool(bool),
    /// Integer, or a time in nanoseconds.
    Int(i64),
    /// Real number.
    Real(f64),
}

/// Row of a table.
#[derive(Clone, PartialEq, Debug)]
pub struct Row {
    /// Number of the tick.
    pub tick: u64,
    /// Time since the start of the run in seconds.
    pub time: f64,
    /// Value of each column; `None` where it has none.
    pub values: Vec<Option<TableValue>>,
}

/// Iterator over the rows of a table: the ticks in which a column has a value.
pub struct TableRows<'a, 'r> {
    columns: &'a [TableColumn<'r>],
    cursors: Vec<Cursor>,
    ticks: Range<u64>,
    tick_ns: u64,
}

impl<'a, 'r> TableRows<'a, 'r> {
    /// Creates the iterator over the rows of these columns of a run.
    #[must_use]
    pub fn new(run: &RunData, columns: &'a [TableColumn<'r>]) -> TableRows<'a, 'r> {
        TableRows {
            columns,
            cursors: vec![Cursor::default(); columns.len()],
            ticks: run.ticks.clone(),
            tick_ns: run.tick_ns,
        }
    }
}

impl Iterator for TableRows<'_, '_> {
    type Item = Row;

    fn next(&mut self) -> Option<Row> {
        loop {
            let tick = self.ticks.next()?;
            let cursors = self.columns.iter().zip(&mut self.cursors);
            let values = cursors.map(|(column, cursor)| cursor.value(column, tick));
            let values: Vec<Option<TableValue>> = values.collect();
            if values.iter().any(Option::is_some) {
                return Some(Row {
                    tick,
                    // Divided, and not multiplied by 1e-9, which is rounded: so it is the nearest number.
                    time: tick as f64 * self.tick_ns as f64 / 1e9,
                    values,
                });
            }
        }
    }
}

/// Position in the rows of a topic while the ticks are visited in ascending order.
#[derive(Clone, Copy, Default)]
struct Cursor {
    /// Interval of ticks, and interval of absent rows, that is not yet passed.
    interval: usize,
    absent: usize,
    /// Number of rows in the passed intervals.
    before: usize,
}

impl Cursor {
    /// Returns the value of a column at a tick, which is not smaller than the one of the last call; `None` if it has none.
    fn value(&mut self, of: &TableColumn<'_>, tick: u64) -> Option<TableValue> {
        let ticks = &of.topic.ticks;
        while ticks
            .get(self.interval)
            .is_some_and(|range| range.end <= tick)
        {
            let passed = &ticks[self.interval];
            self.before += usize::try_from(passed.end - passed.start).ok()?;
            self.interval += 1;
        }
        let range = ticks
            .get(self.interval)
            .filter(|range| range.contains(&tick))?;
        let row = self.before + usize::try_from(tick - range.start).ok()?;
        let absent = &of.column.absent;
        while absent
            .get(self.absent)
            .is_some_and(|range| range.end <= row)
        {
            self.absent += 1;
        }
        match absent
            .get(self.absent)
            .is_some_and(|range| range.contains(&row))
        {
            true => None,
            false => value(of, row),
        }
    }
}

fn value(of: &TableColumn<'_>, row: usize) -> Option<TableValue> {
    let column = of.column;
    match column.kind {
        ColumnKind::Int => column.integers.get(row).copied().map(TableValue::Int),
        ColumnKind::Bool => column.values.get(row).map(|v| TableValue::Bool(*v != 0.0)),
        ColumnKind::Real => column.values.get(row).copied().map(TableValue::Real),
    }
}
