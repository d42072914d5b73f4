//! Writes a table as a file of Arrow or Parquet.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::errors::ParquetError;

use super::fields::{TableField, fields};
use super::rows::{Row, TableRows};
use super::{TableColumn, TableError, TableFormat};
use crate::mcap::RunData;

/// Maximum number of rows that are encoded at once. The memory does not depend on the length of the table.
const BATCH_ROWS: usize = 4096;

/// Writes the columns of a run to a file: the number of the tick, its time in seconds, and the selected columns. Elements of a list
/// are one field with a list of fixed size. The names of the fields have `/` in place of each dot. The metadata of a field have its
/// `unit`, the topic (`source`) and the `name` with dots, those of the table the program and the length of a tick.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub fn write_table(
    run: &RunData,
    columns: &[TableColumn<'_>],
    format: TableFormat,
    file: File,
) -> Result<(), TableError> {
    let fields = fields(columns);
    let schema = schema(run, &fields);
    let out = BufWriter::new(file);
    let mut writer: Box<dyn TableWriter> = match format {
        TableFormat::Arrow => Box::new(FileWriter::try_new(out, &schema)?),
        TableFormat::Parquet => Box::new(ArrowWriter::try_new(out, Arc::clone(&schema), None)?),
    };
    let mut rows = TableRows::new(run, columns);
    loop {
        let batch: Vec<Row> = rows.by_ref().take(BATCH_ROWS).collect();
        if batch.is_empty() {
            break;
        }
        writer.write_batch(&record_batch(&schema, &fields, &batch)?)?;
    }
    writer.close()
}

/// Writer of a table in one format.
trait TableWriter {
    fn write_batch(&mut self, batch: &RecordBatch) -> Result<(), TableError>;

    /// Writes the end of the file.
    fn close(self: Box<Self>) -> Result<(), TableError>;
}

impl<W: Write> TableWriter for FileWriter<W> {
    fn write_batch(&mut self, batch: &RecordBatch) -> Result<(), TableError> {
        Ok(self.write(batch)?)
    }

    fn close(mut self: Box<Self>) -> Result<(), TableError> {
        self.finish()?;
        Ok(self.flush()?)
    }
}

impl<W: Write + Send> TableWriter for ArrowWriter<W> {
    fn write_batch(&mut self, batch: &RecordBatch) -> Result<(), TableError> {
        Ok(self.write(batch)?)
    }

    fn close(self: Box<Self>) -> Result<(), TableError> {
        let mut out = (*self).into_inner()?;
        Ok(out.flush()?)
    }
}

fn schema(run: &RunData, fields: &[TableField]) -> SchemaRef {
    let time = HashMap::from([("unit".to_owned(), "s".to_owned())]);
    let own = [
        Field::new("tick", DataType::Int64, false),
        Field::new("time", DataType::Float64, false).with_metadata(time),
    ];
    let all: Vec<Field> = own
        .into_iter()
        .chain(fields.iter().map(TableField::to_arrow))
        .collect();
    let about = [
        ("program".to_owned(), run.program.clone()),
        ("tick_ns".to_owned(), run.tick_ns.to_string()),
    ];
    Arc::new(Schema::new_with_metadata(all, HashMap::from(about)))
}

fn record_batch(
    schema: &SchemaRef,
    fields: &[TableField],
    rows: &[Row],
) -> Result<RecordBatch, TableError> {
    let ticks = rows.iter().map(|row| row.tick.cast_signed());
    let times = rows.iter().map(|row| row.time);
    let mut columns: Vec<ArrayRef> = vec![
        Arc::new(Int64Array::from_iter_values(ticks)),
        Arc::new(Float64Array::from_iter_values(times)),
    ];
    for field in fields {
        columns.push(field.array(rows)?);
    }
    Ok(RecordBatch::try_new(Arc::clone(schema), columns)?)
}

impl From<ArrowError> for TableError {
    fn from(error: ArrowError) -> TableError {
        match error {
            ArrowError::IoError(_, error) => TableError::Io(error),
            other => TableError::Format(other.to_string()),
        }
    }
}

impl From<ParquetError> for TableError {
    fn from(error: ParquetError) -> TableError {
        match error {
            ParquetError::External(error) => match error.downcast::<std::io::Error>() {
                Ok(error) => TableError::Io(*error),
                Err(other) => TableError::Format(other.to_string()),
            },
            other => TableError::Format(other.to_string()),
        }
    }
}
