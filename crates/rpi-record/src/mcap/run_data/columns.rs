//! Columns of numbers over ticks, from the messages that viewers get in each tick.

use std::ops::Range;
use std::sync::Arc;

use rpi_image::{Scalar, Type};
use rpi_kin::chain::JointType;
use rpi_sim::Cell;
use rpi_sim::cell::DeviceKind;

use crate::mcap::error::RecordingError;
use crate::mcap::names::FlowName;
use crate::mcap::topic_table::{ViewMessage, ViewTopic};
use crate::mcap::value_json::scalar_parts;

/// Maximum number of values of all columns, 512 MiB of memory.
const MAX_VALUES: usize = 1 << 26;

/// Columns of a topic: the flows of a command or ports of a device in the ticks in which there was a message.
#[derive(Clone, PartialEq, Debug)]
pub struct TopicColumns {
    /// Name of the topic, such as `/set_points/arm`.
    pub name: String,
    /// Intervals of ticks with a message, in ascending order. The rows of the columns are the ticks of all intervals.
    pub ticks: Vec<Range<u64>>,
    /// Columns of the topic, one per number.
    pub columns: Vec<Column>,
}

/// Values of one number of a flow or port.
#[derive(Clone, PartialEq, Debug)]
pub struct Column {
    /// Name of the number, such as `joint.commanded_position[2]` or `tcp.commanded_position.position.x`.
    pub name: String,
    /// Kind of the values.
    pub kind: ColumnKind,
    /// Unit of the values, such as `rad`; empty if it is 1 or unknown.
    pub unit: String,
    /// Value in each row; NaN in rows without a value.
    pub values: Vec<f64>,
    /// Exact value in each row of a column of integers, 0 in rows without a value; empty for other kinds.
    pub integers: Vec<i64>,
    /// Intervals of rows without a value, in ascending order.
    pub absent: Vec<Range<usize>>,
}

/// Kind of the values of a column.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ColumnKind {
    /// Boolean: 0 or 1.
    Bool,
    /// Integer. Beyond 2⁵³ the value is rounded in [`Column::values`].
    Int,
    /// Real number.
    Real,
}

/// Builder of the columns of all topics.
#[derive(Default)]
pub(in crate::mcap) struct ColumnBuilder {
    topics: Vec<(Arc<ViewTopic>, TopicColumns)>,
    values: usize,
}

impl TopicColumns {
    /// Returns the number of values.
    pub(in crate::mcap) fn values(&self) -> usize {
        self.columns.iter().map(|column| column.values.len()).sum()
    }

    /// Returns whether another topic has the same name and the same columns.
    pub(in crate::mcap) fn is_like(&self, other: &TopicColumns) -> bool {
        let names = |topic: &TopicColumns| -> Vec<(String, ColumnKind)> {
            let columns = topic.columns.iter();
            columns.map(|c| (c.name.clone(), c.kind)).collect()
        };
        self.name == other.name && names(self) == names(other)
    }

    /// Returns the values from a tick on.
    pub(in crate::mcap) fn since(&self, tick: u64) -> TopicColumns {
        let before = self
            .ticks
            .iter()
            .map(|span| span.end.min(tick).saturating_sub(span.start));
        let first = usize::try_from(before.sum::<u64>()).unwrap_or(usize::MAX);
        let later = self.ticks.iter().filter(|span| span.end > tick);
        TopicColumns {
            name: self.name.clone(),
            ticks: later.map(|span| span.start.max(tick)..span.end).collect(),
            columns: self
                .columns
                .iter()
                .map(|column| column.since(first))
                .collect(),
        }
    }

    /// Adds values of later ticks of the same topic.
    pub(in crate::mcap) fn append(&mut self, more: TopicColumns) {
        for span in more.ticks {
            match self.ticks.last_mut().filter(|last| last.end == span.start) {
                Some(last) => last.end = span.end,
                None => self.ticks.push(span),
            }
        }
        for (column, more) in self.columns.iter_mut().zip(more.columns) {
            let rows = column.values.len();
            column.values.extend(more.values);
            column.integers.extend(more.integers);
            let absent = more.absent.into_iter();
            column
                .absent
                .extend(absent.map(|span| span.start + rows..span.end + rows));
        }
    }
}

impl ColumnBuilder {
    /// Adds the values of the tick with the number `tick`. Returns an error if there are too many values.
    pub(in crate::mcap) fn add(
        &mut self,
        cell: &Cell,
        tick: u64,
        messages: &[ViewMessage<'_>],
    ) -> Result<(), RecordingError> {
        for message in messages {
            let at = self.topic(cell, message.topic());
            let topic = &mut self.topics[at].1;
            // Two commands with the same image have one topic: the first one is shown.
            if topic.ticks.last().is_some_and(|last| last.end > tick) {
                continue;
            }
            match topic.ticks.last_mut().filter(|last| last.end == tick) {
                Some(last) => last.end += 1,
                None => topic.ticks.push(tick..tick + 1),
            }
            let fields = message.topic().fields();
            let mut columns = topic.columns.iter_mut();
            for (field, value) in fields.iter().zip(message.values()) {
                let own = columns.by_ref().take(field.ty.slots() as usize);
                for (k, column) in own.enumerate() {
                    column.push(value.and_then(|words| words.get(k).copied()));
                    self.values += 1;
                }
            }
        }
        match self.values > MAX_VALUES {
            true => Err(RecordingError::TooLong(MAX_VALUES)),
            false => Ok(()),
        }
    }

    /// Returns the index of the columns of a topic, which are created if they do not exist.
    fn topic(&mut self, cell: &Cell, topic: &Arc<ViewTopic>) -> usize {
        let known = self.topics.iter().position(|(t, _)| Arc::ptr_eq(t, topic));
        known.unwrap_or_else(|| {
            let columns = topic.fields().iter().flat_map(|f| columns_of(cell, f));
            let columns = TopicColumns {
                name: topic.encoded.name.clone(),
                ticks: Vec::new(),
                columns: columns.collect(),
            };
            self.topics.push((Arc::clone(topic), columns));
            self.topics.len() - 1
        })
    }

    pub(in crate::mcap) fn finish(self) -> Vec<TopicColumns> {
        self.topics
            .into_iter()
            .map(|(_, columns)| columns)
            .collect()
    }
}

impl Column {
    /// Returns the values from a row on.
    fn since(&self, row: usize) -> Column {
        let absent = self.absent.iter().filter(|span| span.end > row);
        Column {
            name: self.name.clone(),
            kind: self.kind,
            unit: self.unit.clone(),
            values: self.values.get(row..).unwrap_or_default().to_vec(),
            integers: self.integers.get(row..).unwrap_or_default().to_vec(),
            absent: absent
                .map(|span| span.start.max(row) - row..span.end - row)
                .collect(),
        }
    }

    fn push(&mut self, word: Option<u64>) {
        let row = self.values.len();
        if self.kind == ColumnKind::Int {
            self.integers.push(word.map_or(0, u64::cast_signed));
        }
        let Some(word) = word else {
            self.values.push(f64::NAN);
            match self.absent.last_mut().filter(|last| last.end == row) {
                Some(last) => last.end += 1,
                None => self.absent.push(row..row + 1),
            }
            return;
        };
        self.values.push(match self.kind {
            ColumnKind::Bool => f64::from(u8::from(word != 0)),
            ColumnKind::Int => word.cast_signed() as f64,
            ColumnKind::Real => f64::from_bits(word),
        });
    }
}

/// Returns empty columns for the numbers of a flow or port, one per memory word.
fn columns_of(cell: &Cell, field: &FlowName) -> Vec<Column> {
    let column = |suffix: &str, kind, unit: &str| Column {
        name: format!("{}{suffix}", field.name),
        kind,
        unit: unit.to_owned(),
        values: Vec::new(),
        integers: Vec::new(),
        absent: Vec::new(),
    };
    let scalar = |prefix: &str, scalar: Scalar| -> Vec<Column> {
        let kind = match scalar {
            Scalar::Bool => ColumnKind::Bool,
            Scalar::Int | Scalar::Time => ColumnKind::Int,
            _ => ColumnKind::Real,
        };
        let parts = scalar_parts(scalar);
        if parts.is_empty() {
            let unit = match scalar {
                Scalar::Time => "ns",
                Scalar::Real if !field.unit.is_empty() => &field.unit,
                Scalar::Real => joint_unit(cell, field),
                _ => "",
            };
            return vec![column(prefix, kind, unit)];
        }
        let reals = parts.iter().flat_map(|(part, reals)| {
            let dot = if part.is_empty() { "" } else { "." };
            reals
                .iter()
                .map(move |real| (format!("{dot}{part}.{real}"), part_unit(part)))
        });
        reals
            .map(|(suffix, unit)| column(&format!("{prefix}{suffix}"), kind, unit))
            .collect()
    };
    match field.ty {
        Type::Scalar(one) => scalar("", one),
        Type::Array(each, count) => (0..count)
            .flat_map(|k| scalar(&format!("[{k}]"), each))
            .collect(),
        Type::Matrix(rows, columns) => (0..rows)
            .flat_map(|r| (0..columns).map(move |c| (r, c)))
            .map(|(r, c)| column(&format!("[{r}][{c}]"), ColumnKind::Real, ""))
            .collect(),
    }
}

/// Returns the SI unit of a part of a structured value.
fn part_unit(part: &str) -> &'static str {
    match part {
        "position" => "m",
        "linear" => "m/s",
        "angular" => "rad/s",
        "force" => "N",
        "torque" => "N m",
        _ => "",
    }
}

/// Returns the unit of a joint of an arm, by the kind of the joint; empty for other flows and ports.
fn joint_unit(cell: &Cell, field: &FlowName) -> &'static str {
    let is_joint = ["joint.", "joints["]
        .iter()
        .any(|p| field.name.starts_with(p));
    let device = cell.devices.iter().find(|d| d.name == field.owner);
    let (true, Some(DeviceKind::Arm(arm))) = (is_joint, device.map(|d| &d.kind)) else {
        return "";
    };
    let index = field
        .name
        .rsplit_once('[')
        .and_then(|(_, end)| end.strip_suffix(']'));
    let index = index
        .and_then(|index| index.parse::<usize>().ok())
        .unwrap_or(0);
    let zero = vec![0.0; arm.joints.len()];
    let mut axes = arm.model.chain.axes_in_base(&zero);
    let is_linear = axes
        .nth(index)
        .is_some_and(|axis| axis.joint == JointType::Prismatic);
    let units = match field.name.split('[').next().unwrap_or_default() {
        name if name.ends_with("velocity") => ["rad/s", "m/s"],
        name if name.ends_with("acceleration") => ["rad/s²", "m/s²"],
        name if name.ends_with("torque") => ["N m", "N"],
        _ => ["rad", "m"],
    };
    units[usize::from(is_linear)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(name: &str, ty: Type) -> FlowName {
        FlowName {
            owner: "arm".to_owned(),
            name: name.to_owned(),
            ty,
            unit: String::new(),
        }
    }

    fn cell() -> Cell {
        let text = "name = \"c\"\n[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = \"home\"\n";
        Cell::parse("cell.toml", text).unwrap()
    }

    #[test]
    fn every_memory_word_has_a_column_with_its_unit() {
        let cell = cell();
        let names = |field: &FlowName| -> Vec<(String, String)> {
            let columns = columns_of(&cell, field).into_iter();
            columns.map(|c| (c.name, c.unit)).collect()
        };
        let pose = names(&field("tcp", Type::Scalar(Scalar::Pose)));
        assert_eq!(pose.len(), 7);
        assert_eq!(pose[2], ("tcp.position.z".to_owned(), "m".to_owned()));
        assert_eq!(pose[6], ("tcp.orientation.w".to_owned(), String::new()));
        let list = names(&field("a", Type::Array(Scalar::Vector, 2)));
        assert_eq!(list[5], ("a[1].z".to_owned(), String::new()));
        let real = Type::Scalar(Scalar::Real);
        let joint = names(&field("joint.commanded_position[6]", real));
        assert_eq!(
            joint,
            [("joint.commanded_position[6]".to_owned(), "rad".to_owned())]
        );
        assert_eq!(names(&field("speed", real))[0].1, "");
        let with_unit = FlowName {
            unit: "m/s".to_owned(),
            ..field("speed", Type::Array(Scalar::Real, 2))
        };
        assert_eq!(
            names(&with_unit)[1],
            ("speed[1]".to_owned(), "m/s".to_owned())
        );
    }

    #[test]
    fn values_since_a_tick_can_be_appended_to_the_earlier_ones() {
        let values = [Some(1), None, None, Some(4), Some(5)];
        let mut column = columns_of(&cell(), &field("a", Type::Scalar(Scalar::Int))).remove(0);
        values.into_iter().for_each(|word| column.push(word));
        let all = TopicColumns {
            name: "/command/M".to_owned(),
            ticks: vec![10..13, 20..22],
            columns: vec![column],
        };
        for (from, rows) in [(0, 5), (10, 5), (12, 3), (15, 2), (21, 1), (22, 0)] {
            let later = all.since(from);
            assert_eq!(later.values(), rows, "{from}");
            let mut earlier = all.clone();
            earlier.ticks = all
                .ticks
                .iter()
                .map(|s| s.start.min(from)..s.end.min(from))
                .collect();
            earlier.ticks.retain(|span| !span.is_empty());
            let column = &mut earlier.columns[0];
            column.values.truncate(5 - rows);
            column.integers.truncate(5 - rows);
            column.absent = column
                .absent
                .iter()
                .map(|s| s.start.min(5 - rows)..s.end.min(5 - rows))
                .collect();
            column.absent.retain(|span| !span.is_empty());
            assert!(earlier.is_like(&later));
            earlier.append(later);
            let present = |topic: &TopicColumns| {
                topic.columns[0]
                    .absent
                    .iter()
                    .cloned()
                    .flatten()
                    .collect::<Vec<_>>()
            };
            assert_eq!(earlier.ticks, all.ticks, "{from}");
            assert_eq!(present(&earlier), present(&all), "{from}");
            assert_eq!(earlier.columns[0].integers, [1, 0, 0, 4, 5], "{from}");
        }
    }

    #[test]
    fn rows_without_a_value_are_intervals() {
        let mut column = columns_of(&cell(), &field("a", Type::Scalar(Scalar::Int))).remove(0);
        for word in [None, None, Some(3), None, Some(u64::MAX)] {
            column.push(word);
        }
        assert_eq!(column.absent, [0..2, 3..4]);
        assert_eq!((column.values[2], column.values[4]), (3.0, -1.0));
        assert_eq!(column.integers, [0, 0, 3, 0, -1]);
        assert!(column.values[0].is_nan());
    }
}
