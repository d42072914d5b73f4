//! Recorded nets and their traces.

use std::collections::BTreeSet;
use std::path::Path;

use rpi_diag::FileId;
use rpi_image::{Role, Scalar, Type};
use rpi_net::Net;
use rpi_record::trace::Trace;

/// A net with its trace and further recordings of the same run.
pub(crate) struct RecordedNet {
    pub(crate) name: String,
    net: String,
    /// Text of the trace.
    pub(crate) text: String,
    more: Option<String>,
}

/// Returns all nets of the corpus, ordered by name.
pub(crate) fn corpus_nets(corpus: &Path) -> Vec<RecordedNet> {
    let nets = corpus.join("nets");
    let load = |name: String| RecordedNet {
        net: read(&nets.join(format!("{name}.rpinet.gz"))),
        text: read(&corpus.join(format!("traces/{name}.trace.gz"))),
        more: None,
        name,
    };
    names(&nets, ".rpinet.gz").map(load).collect()
}

/// Returns the nets with recorded set-points.
pub(crate) fn set_point_nets(folder: &Path) -> Vec<RecordedNet> {
    let load = |name: String| RecordedNet {
        net: read(&folder.join(format!("{name}.rpinet.gz"))),
        text: read(&folder.join(format!("{name}.setpoints.csv.gz"))),
        more: Some(read(&folder.join(format!("{name}.ports.csv.gz")))),
        name,
    };
    names(folder, ".setpoints.csv.gz").map(load).collect()
}

impl RecordedNet {
    pub(crate) fn net(&self) -> Result<Net, String> {
        let (net, diagnostics) = rpi_net::rpinet::parse(&self.name, FileId(0), &self.net);
        net.ok_or_else(|| format!("{diagnostics:?}"))
    }

    pub(crate) fn trace(&self) -> Result<Trace, String> {
        let parse = |text: &str| Trace::parse(text).map_err(|e| e.to_string());
        let trace = parse(&self.text)?;
        match &self.more {
            None => Ok(trace),
            Some(more) => Ok(trace.merged_with(&parse(more)?)),
        }
    }

    /// Returns the last line of the trace with a finite real that an ordinary primitive computed, including the line
    /// end.
    pub(crate) fn last_computed_real(&self) -> Option<String> {
        let computed = computed_reals(&self.net().ok()?);
        let is_one = |line: &&str| {
            let mut fields = line.split('\t').skip(1);
            let name = fields.next().unwrap_or("");
            let value: Option<f64> = fields.next().and_then(|v| v.parse().ok());
            computed.contains(name) && value.is_some_and(f64::is_finite)
        };
        let line = self.text.lines().rev().find(is_one)?;
        Some(format!("{line}\n"))
    }
}

/// Returns a line of a trace with another value.
pub(crate) fn changed(line: &str) -> String {
    let (start, value) = line.trim_end().rsplit_once('\t').unwrap();
    let value: f64 = value.parse().unwrap();
    format!("{start}\t{:?}\n", value + 0.125 * value.abs().max(1.0))
}

fn computed_reals(net: &Net) -> BTreeSet<String> {
    let nodes = net.nodes.iter().filter(|n| n.desc().role == Role::Compute);
    nodes
        .flat_map(|node| {
            let path = net.path(node.fragment, &node.name);
            let outs = node.desc().outputs.iter().zip(&node.outputs);
            let reals = outs.filter(|(_, ty)| **ty == Type::Scalar(Scalar::Real));
            reals.map(move |(out, _)| format!("{path}.{}", out.name))
        })
        .collect()
}

fn names(folder: &Path, ending: &'static str) -> impl Iterator<Item = String> {
    let files = std::fs::read_dir(folder).unwrap();
    let names = files.map(|f| f.unwrap().file_name().into_string().unwrap());
    let names: BTreeSet<String> = names
        .filter_map(|n| Some(n.strip_suffix(ending)?.to_owned()))
        .collect();
    names.into_iter()
}

fn read(path: &Path) -> String {
    rpi_testkit::read_maybe_gz(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}
