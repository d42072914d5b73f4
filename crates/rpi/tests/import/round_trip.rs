//! Round trip from a net to a program and back.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rpi_diag::{Code, Severity};
use rpi_driver::{AnalysedNet, Input, InputKind, compile, import, read};
use rpi_net::{FragmentId, Net, NodeId};
use rpi_syntax::Dialect;

/// A net, the net of its program, and the correspondence of their nodes.
pub(crate) struct RoundTrip {
    pub(crate) old: AnalysedNet,
    pub(crate) new: AnalysedNet,
    /// New nodes of the original nodes, as far as they remain.
    pub(crate) nodes: BTreeMap<NodeId, NodeId>,
    /// New fragments of the original fragments.
    pub(crate) fragments: BTreeMap<FragmentId, FragmentId>,
}

impl RoundTrip {
    /// Reads a net, writes its program, formats and compiles it.
    pub(crate) fn from_file(path: &Path) -> Result<RoundTrip, String> {
        let old = net_of(path)?;
        let imported = import::import(&old);
        if rpi_syntax::format(&imported.text, Dialect::Rpi).as_ref() != Ok(&imported.text) {
            return Err("what was imported is not formatted".to_owned());
        }
        let new = program(imported.text)?;
        let nodes = nodes(&old, &new, &imported.names);
        Ok(RoundTrip {
            fragments: fragments(&old, &new, &nodes),
            nodes,
            old,
            new,
        })
    }
}

/// Reads a recorded net.
pub(crate) fn net_of(path: &Path) -> Result<AnalysedNet, String> {
    let compiled = read(path).and_then(|input| compile(&input));
    let compiled = compiled.map_err(|e| e.to_string())?;
    match compiled.nets() {
        [net] => Ok(net.clone()),
        _ => Err(format!("{:?}", compiled.diagnostics)),
    }
}

/// Compiles a program of one command, which must have no diagnostic.
pub(crate) fn program(text: String) -> Result<AnalysedNet, String> {
    let input = Input {
        path: PathBuf::from("imported.rpi"),
        kind: InputKind::Rpi,
        bytes: text.into_bytes(),
    };
    let compiled = compile(&input).map_err(|e| e.to_string())?;
    let errors = compiled
        .diagnostics
        .iter()
        .filter(|f| f.severity() <= Severity::Warning)
        // Nets were recorded with longer periods than the default one.
        .filter(|f| f.code != Code::RPI7002);
    let errors: Vec<String> = errors
        .map(|f| format!("{} {}", f.code, f.message))
        .collect();
    match (errors.first(), compiled.nets()) {
        (None, [net]) => Ok(net.clone()),
        (None, _) => Err("there is no command".to_owned()),
        (Some(first), _) => Err(format!("{first} (and {} more)", errors.len() - 1)),
    }
}

fn nodes(old: &Net, new: &Net, names: &[(String, String)]) -> BTreeMap<NodeId, NodeId> {
    let [olds, news] = [old, new].map(|net| {
        let path = |id: NodeId| net.path(net.node(id).fragment, &net.node(id).name);
        let paths = net.node_ids().map(|id| (path(id), id));
        paths.collect::<BTreeMap<String, NodeId>>()
    });
    let pairs = names.iter();
    let pairs = pairs.filter_map(|(a, b)| Some((*olds.get(a)?, *news.get(b)?)));
    pairs.collect()
}

/// Matches the fragments, and those around them, by the nodes in them.
fn fragments(
    old: &Net,
    new: &Net,
    nodes: &BTreeMap<NodeId, NodeId>,
) -> BTreeMap<FragmentId, FragmentId> {
    let pairs = nodes.iter().flat_map(|(a, b)| {
        let (a, b) = (old.node(*a).fragment, new.node(*b).fragment);
        old.ancestors(a).zip(new.ancestors(b)).collect::<Vec<_>>()
    });
    pairs.collect()
}
