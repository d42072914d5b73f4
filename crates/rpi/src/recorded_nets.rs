//! Graphs of the nets of a recording, for the page that shows it.

use std::path::{Path, PathBuf};

use rpi_debug::{ALL_FLOWS, RecordedProgram};
use rpi_diag::{SourceMap, Span};
use rpi_driver::AnalysedNet;
use rpi_graph::{NetGraph, Place};
use rpi_record::mcap::{Recording, RunData};
use rpi_replay::net_graph;
use rpi_view::ViewContent;

/// Nets of a recording.
pub(crate) struct RecordedNets {
    /// Graphs of the commands that were recorded, in the order of the program, or the reason for the reader of the page why there are none.
    pub(crate) graphs: Result<Vec<NetGraph>, String>,
    /// File of the program that compiles to the recorded commands; `None` for the text in the recording.
    pub(crate) program: Option<PathBuf>,
}

impl RecordedNets {
    /// Compiles the program of a recording again. `file` is the file of the program, if it is known. It may have changed, or may
    /// depend on files that are others here; then the text in the recording is used, which is enough if the program uses only modules of the
    /// library.
    pub(crate) fn new(recording: &Recording, file: Option<&Path>) -> RecordedNets {
        let compiled = compiled_graphs(recording, file);
        let stored = file.filter(|_| compiled.is_err());
        match stored.map(|_| compiled_graphs(recording, None)) {
            Some(Ok(graphs)) => RecordedNets {
                graphs: Ok(graphs),
                program: None,
            },
            _ => RecordedNets {
                graphs: compiled,
                program: file.map(Path::to_path_buf),
            },
        }
    }

    /// Returns what a page shows of a run with these nets.
    pub(crate) fn content<'a>(&'a self, run: &'a RunData) -> ViewContent<'a> {
        ViewContent {
            run,
            nets: self.graphs.as_deref().map_err(String::as_str),
            is_live: false,
        }
    }
}

fn compiled_graphs(recording: &Recording, program: Option<&Path>) -> Result<Vec<NetGraph>, String> {
    let mut own = recording.clone();
    let all = [ALL_FLOWS.to_owned()];
    let lower = rpi_driver::lower_for_observation_in_tick;
    let compiled = RecordedProgram::new(&own, program)
        .and_then(|program| program.compile(&mut own, (&all, None), lower))
        .map_err(|error| error.to_string())?;
    let nets = compiled.compiled.nets();
    let mut indices: Vec<usize> = compiled.images.iter().map(|(net, _)| *net).collect();
    indices.sort_unstable();
    indices.dedup();
    let recorded = indices.into_iter().filter_map(|index| nets.get(index));
    Ok(graphs(recorded, &compiled.compiled.sources))
}

/// Returns the graphs of nets whose places are in these sources.
pub(crate) fn graphs<'n>(
    nets: impl Iterator<Item = &'n AnalysedNet>,
    sources: &SourceMap,
) -> Vec<NetGraph> {
    let place = |span: Span| {
        (!span.is_none()).then(|| Place {
            file: sources.name(span.file).to_owned(),
            line: sources.line_col(span).line,
        })
    };
    nets.map(|net| net_graph(net, &place)).collect()
}
