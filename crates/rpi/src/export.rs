//! `rpi export`: writes the values of a recording as a table, one row per tick.

use std::error::Error;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use clap::Args;
use rpi_record::mcap::{Column, ColumnKind, RunData, TopicColumns};

use crate::exit::{CommandResult, Exit};
use crate::output;
use crate::view_args::RecordedRun;

/// Options of `rpi export`.
#[derive(Args, Debug)]
pub(crate) struct ExportArgs {
    #[command(flatten)]
    pub(crate) run: RecordedRun,
    /// File for the table (.csv); default: standard output.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Export only the columns of this topic, or this column, such as `/set_points/arm` or `/set_points/arm/joints[0]`. May be
    /// repeated.
    #[arg(long, value_name = "NAME")]
    pub(crate) column: Vec<String>,
}

/// Carries out `rpi export`.
pub(crate) fn export(args: &ExportArgs) -> CommandResult {
    let run = args.run.load()?;
    let columns = select(&run, &args.column)?;
    let written = match &args.output {
        Some(path) => {
            let file = output::create(path, &[&args.run.recording])?;
            write_csv(&run, &columns, BufWriter::new(file))
                .map_err(|e| format!("{}: {e}", path.display()))?;
            return Ok(Exit::Success);
        }
        None => write_csv(&run, &columns, BufWriter::new(io::stdout().lock())),
    };
    rpi_cli::ignore_broken_pipe(written)?;
    Ok(Exit::Success)
}

/// Column of the table: its name, and where its values are.
struct ExportColumn<'r> {
    name: String,
    topic: &'r TopicColumns,
    column: &'r Column,
}

/// Returns the columns with these names, or all if there are no names.
fn select<'r>(run: &'r RunData, names: &[String]) -> Result<Vec<ExportColumn<'r>>, Box<dyn Error>> {
    let all = run.topics.iter().flat_map(|topic| {
        topic.columns.iter().map(move |column| ExportColumn {
            name: format!("{}/{}", topic.name, column.name),
            topic,
            column,
        })
    });
    let all: Vec<ExportColumn<'r>> = all.collect();
    let selects = |name: &String, column: &ExportColumn<'_>| {
        let rest = column.name.strip_prefix(name.as_str());
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['/', '.', '[']))
    };
    for name in names {
        if !all.iter().any(|column| selects(name, column)) {
            let topics = run.topics.iter().map(|topic| topic.name.as_str());
            let columns = all.iter().map(|column| column.name.as_str());
            let near = rpi_diag::suggest(name, topics.chain(columns));
            let help = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            return Err(format!("the recording has no column `{name}`{help}").into());
        }
    }
    let is_selected = |column: &ExportColumn<'_>| {
        names.is_empty() || names.iter().any(|name| selects(name, column))
    };
    Ok(all.into_iter().filter(is_selected).collect())
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
    fn value(&mut self, of: &ExportColumn<'_>, tick: u64) -> Option<f64> {
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
            false => of.column.values.get(row).copied(),
        }
    }
}

/// Writes the columns as comma-separated values (RFC 4180). The first row has the names with units; a value that is absent is
/// an empty field. Reals have as many digits as are needed to read the same number.
fn write_csv(run: &RunData, columns: &[ExportColumn<'_>], to: impl Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(to);
    let names = columns.iter().map(|column| match column.column.unit {
        "" => column.name.clone(),
        unit => format!("{} [{unit}]", column.name),
    });
    table.write_record(
        ["tick".to_owned(), "time [s]".to_owned()]
            .into_iter()
            .chain(names),
    )?;
    let mut cursors = vec![Cursor::default(); columns.len()];
    for tick in run.ticks.clone() {
        let values: Vec<Option<f64>> = columns
            .iter()
            .zip(&mut cursors)
            .map(|(column, cursor)| cursor.value(column, tick))
            .collect();
        if values.iter().all(Option::is_none) {
            continue;
        }
        let time = tick as f64 * run.tick_ns as f64 * 1e-9;
        table.write_field(tick.to_string())?;
        table.write_field(format!("{time:.9}"))?;
        for (column, value) in columns.iter().zip(values) {
            table.write_field(
                value.map_or_else(String::new, |value| text(column.column.kind, value)),
            )?;
        }
        table.write_record(None::<&[u8]>)?;
    }
    table.flush()
}

fn text(kind: ColumnKind, value: f64) -> String {
    match kind {
        ColumnKind::Bool => (value != 0.0).to_string(),
        ColumnKind::Int | ColumnKind::Real => value.to_string(),
    }
}
