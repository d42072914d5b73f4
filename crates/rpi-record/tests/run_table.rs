//! Tables in Arrow and Parquet, read back by the same crates.
#![cfg(feature = "arrow")]

use std::fs::File;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, RecordBatch, RecordBatchReader};
use arrow_ipc::reader::FileReader;
use arrow_schema::{ArrowError, DataType, SchemaRef};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use rpi_record::mcap::{Column, ColumnKind, RunData, TopicColumns};
use rpi_record::run_table::{TableFormat, select, write_table};

/// More rows than are encoded at once.
const ROWS: usize = 9000;

fn column(name: &str, kind: ColumnKind, unit: &str, rows: usize) -> Column {
    Column {
        name: name.to_owned(),
        kind,
        unit: unit.to_owned(),
        values: (0..rows).map(|k| k as f64 * 0.5).collect(),
        integers: match kind {
            // Beyond 2^53, where a float is not exact.
            ColumnKind::Int => (0..rows).map(|k| i64::MAX - k as i64).collect(),
            _ => Vec::new(),
        },
        absent: Vec::new(),
    }
}

/// A topic with values in ticks 0..3 and 5..rows + 2, of which row 1 of the second element of the list is absent.
fn run(rows: usize) -> RunData {
    let (real, int) = (ColumnKind::Real, ColumnKind::Int);
    let mut columns = vec![
        column("joints[0]", real, "rad", rows),
        column("joints[1]", real, "rad", rows),
        column("joints[2]", real, "m", rows),
        column("count", int, "", rows),
        column("tcp.moving", ColumnKind::Bool, "", rows),
    ];
    columns[1].absent.push(1..2);
    let topic = TopicColumns {
        name: "/set_points/arm".to_owned(),
        ticks: vec![0..3, 5..rows as u64 + 2],
        columns,
    };
    RunData {
        tick_ns: 1_000_000,
        ticks: 0..rows as u64 + 2,
        program: "move.rpi".to_owned(),
        source: None,
        cell: String::new(),
        arms: Vec::new(),
        topics: vec![topic],
        activity: Vec::new(),
        events: Vec::new(),
        lost: 0,
        cut: None,
    }
}

fn written(run: &RunData, format: TableFormat) -> File {
    let columns = select(run, &[]).unwrap();
    let file = tempfile::tempfile().unwrap();
    write_table(run, &columns, format, file.try_clone().unwrap()).unwrap();
    file
}

fn check(schema: &SchemaRef, batches: &[RecordBatch], rows: usize) {
    let names: Vec<&str> = schema.fields().iter().map(|f| f.name().as_str()).collect();
    let topic = "/set_points/arm";
    assert_eq!(names[..2], ["tick", "time"]);
    let expected = ["joints", "joints[2]", "count", "tcp/moving"];
    assert_eq!(names[2..], expected.map(|name| format!("{topic}/{name}")));
    assert_eq!(schema.field(2).metadata()["unit"], "rad");
    assert_eq!(schema.field(3).metadata()["unit"], "m");
    assert_eq!(schema.field(4).metadata()["source"], topic);
    assert_eq!(
        schema.field(5).metadata()["name"],
        format!("{topic}/tcp.moving")
    );
    assert_eq!(schema.metadata()["tick_ns"], "1000000");
    assert_eq!(
        batches.iter().map(RecordBatch::num_rows).sum::<usize>(),
        rows
    );
    let first = &batches[0];
    let ticks = first.column(0).as_primitive::<Int64Type>();
    assert_eq!(ticks.values()[..4], [0, 1, 2, 5]);
    let list = first.column(2).as_fixed_size_list();
    let row = list.value(1);
    let row = row.as_primitive::<Float64Type>();
    assert!(row.value(0) == 0.5 && row.is_null(1));
    let count = first.column(4).as_primitive::<Int64Type>();
    assert_eq!(count.value(2), i64::MAX - 2);
    assert!(!first.column(5).as_boolean().value(0) && first.column(5).as_boolean().value(1));
}

#[test]
fn a_table_in_arrow_is_read_as_it_was_written() {
    let rows = ROWS;
    let reader = FileReader::try_new(written(&run(rows), TableFormat::Arrow), None).unwrap();
    let schema = reader.schema();
    let batches: Result<Vec<RecordBatch>, ArrowError> = reader.collect();
    check(&schema, &batches.unwrap(), rows);
}

#[test]
fn a_table_in_parquet_is_read_as_it_was_written() {
    let rows = ROWS;
    let file = written(&run(rows), TableFormat::Parquet);
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
    // The metadata of the table are in those of the file.
    let schema = Arc::clone(reader.schema());
    let reader = reader.with_batch_size(rows).build().unwrap();
    assert_eq!(reader.schema().fields(), schema.fields());
    let batches: Result<Vec<RecordBatch>, ArrowError> = reader.collect();
    check(&schema, &batches.unwrap(), rows);
}

#[test]
fn names_are_different() {
    let mut run = run(4);
    let columns = &mut run.topics[0].columns;
    let (same, mut other) = (columns[3].clone(), columns[3].clone());
    other.integers[0] = 0;
    columns.extend([same, other]);
    let names = ["/set_points/arm/count".to_owned()];
    let columns = select(&run, &names).unwrap();
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["/set_points/arm/count", "/set_points/arm/count#2"]);
}

#[test]
fn only_elements_from_0_on_are_a_list() {
    let run = run(4);
    let names = ["/set_points/arm/joints[1]".to_owned()];
    let columns = select(&run, &names).unwrap();
    let file = tempfile::tempfile().unwrap();
    let copy = file.try_clone().unwrap();
    write_table(&run, &columns, TableFormat::Arrow, copy).unwrap();
    let schema = FileReader::try_new(file, None).unwrap().schema();
    assert_eq!(schema.field(2).name(), &names[0]);
    assert_eq!(schema.field(2).data_type(), &DataType::Float64);
}
