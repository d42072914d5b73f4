//! `rpi export`: writes the values of a recording as a table, one row per tick.

use std::error::Error;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use rpi_record::mcap::RunData;
use rpi_record::run_table::{TableColumn, TableFormat, TableRows, TableValue, select, write_table};

use crate::exit::{CommandResult, Exit};
use crate::output;
use crate::view_args::RecordedRun;

/// Options of `rpi export`.
#[derive(Args, Debug)]
pub(crate) struct ExportArgs {
    #[command(flatten)]
    pub(crate) run: RecordedRun,
    /// File for the table; default: standard output.
    #[arg(long, short, visible_alias = "out", value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Format of the table; default: by the end of the file name (.csv, .arrow, .feather, .parquet), else CSV.
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<ExportFormat>,
    /// Export only the columns of this topic, or this column, such as `/set_points/arm` or `/set_points/arm/joints[0]`. May be
    /// repeated.
    #[arg(long, value_name = "NAME")]
    pub(crate) column: Vec<String>,
}

/// Format of a table.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ExportFormat {
    /// Comma-separated values.
    Csv,
    /// Arrow IPC file (Feather), with types and units.
    Arrow,
    /// Apache Parquet, with types and units.
    Parquet,
}

impl ExportFormat {
    /// Returns the format of a file by the end of its name; CSV for other ends.
    fn from_path(path: &Path) -> ExportFormat {
        match path.extension().and_then(|end| end.to_str()) {
            Some("arrow" | "feather") => ExportFormat::Arrow,
            Some("parquet") => ExportFormat::Parquet,
            _ => ExportFormat::Csv,
        }
    }

    /// Returns the format of a table that is not text; `None` for CSV.
    fn table(self) -> Option<TableFormat> {
        match self {
            ExportFormat::Csv => None,
            ExportFormat::Arrow => Some(TableFormat::Arrow),
            ExportFormat::Parquet => Some(TableFormat::Parquet),
        }
    }
}

/// Carries out `rpi export`.
pub(crate) fn export(args: &ExportArgs) -> CommandResult {
    let by_name = args.output.as_deref().map(ExportFormat::from_path);
    let format = args.format.or(by_name).unwrap_or(ExportFormat::Csv);
    let run = args.run.load()?;
    let columns = select(&run, &args.column)?;
    match (&args.output, format.table()) {
        (Some(path), format) => write_file(args, (&run, &columns), (path, format))?,
        (None, None) => {
            let written = write_csv(&run, &columns, BufWriter::new(io::stdout().lock()));
            rpi_cli::ignore_broken_pipe(written)?;
        }
        (None, Some(_)) => {
            return Err("Arrow and Parquet are files: name one with --output FILE".into());
        }
    }
    Ok(Exit::Success)
}

/// Writes the table to a file; without a format as CSV.
fn write_file(
    args: &ExportArgs,
    (run, columns): (&RunData, &[TableColumn<'_>]),
    (path, format): (&Path, Option<TableFormat>),
) -> Result<(), Box<dyn Error>> {
    let file = output::create(path, &[&args.run.recording])?;
    let with_name = |error: &dyn Error| format!("{}: {error}", path.display()).into();
    match format {
        Some(format) => write_table(run, columns, format, file).map_err(|error| {
            // An empty file would be no table. The error is what counts, whether the file can be removed or not.
            let _ = std::fs::remove_file(path);
            with_name(&error)
        }),
        None => write_csv(run, columns, BufWriter::new(file)).map_err(|error| with_name(&error)),
    }
}

/// Writes the columns as comma-separated values (RFC 4180). The first row has the names with units; a value that is absent is
/// an empty field. Reals have as many digits as are needed to read the same number.
fn write_csv(run: &RunData, columns: &[TableColumn<'_>], to: impl Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(to);
    let names = columns
        .iter()
        .map(|column| match column.column.unit.as_str() {
            "" => column.name.clone(),
            unit => format!("{} [{unit}]", column.name),
        });
    let names = ["tick".to_owned(), "time [s]".to_owned()]
        .into_iter()
        .chain(names);
    table.write_record(names).map_err(io_error)?;
    for row in TableRows::new(run, columns) {
        let start = [row.tick.to_string(), format!("{:.9}", row.time)];
        let values = row
            .values
            .iter()
            .map(|value| value.map_or_else(String::new, text));
        table
            .write_record(start.into_iter().chain(values))
            .map_err(io_error)?;
    }
    table.flush()
}

/// Returns the error of the output, whose kind would otherwise be lost: a reader may close a pipe at any time.
fn io_error(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

fn text(value: TableValue) -> String {
    match value {
        TableValue::Bool(value) => value.to_string(),
        TableValue::Int(value) => value.to_string(),
        TableValue::Real(value) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_name_is_its_format() {
        let format = |name: &str| ExportFormat::from_path(Path::new(name));
        assert_eq!(format("run.parquet"), ExportFormat::Parquet);
        assert_eq!(format("run.feather"), ExportFormat::Arrow);
        assert_eq!(format("run.arrow"), ExportFormat::Arrow);
        for name in ["run.csv", "run", "parquet"] {
            assert_eq!(format(name), ExportFormat::Csv);
        }
    }
}
