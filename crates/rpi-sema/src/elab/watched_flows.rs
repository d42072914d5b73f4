//! Flows that are exported because a user watches them, although the program does not export them.
//!
//! A flow is named by the path from the command to it: the names of the calls and fragments around it, and its own name, such
//! as `Approach.way.travelled`. A watched flow is absent while its fragment is inactive.

use crate::elab::external_ports::export_port;
use crate::elab::scope::Scope;
use crate::elab::{ElabMode, Elaborator, Position};
use crate::elab::{block, fragment_outputs, outside_flows};
use crate::hash::FastSet;
use crate::ty::Ty;
use crate::typed::{BlockId, FlowId};

/// Maximum number of scalar parts that are watched in a command. More are left out.
pub const MAX_WATCHED: usize = 10_000;

/// Selection of flows by name. A name selects the flow of this name, or a part of it (`pose.position.x`, `joints[2]`), and all
/// flows inside of the call or fragment of this name; the empty name selects all flows.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct FlowSelection {
    names: Vec<String>,
}

impl FlowSelection {
    /// Creates the selection of the flows with these names.
    #[must_use]
    pub fn new(names: Vec<String>) -> FlowSelection {
        FlowSelection { names }
    }

    /// Returns whether no flow is selected.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    fn selects(&self, flow: &str) -> bool {
        let overlaps = |name: &String| contains(name, flow) || contains(flow, name);
        self.names.iter().any(overlaps)
    }

    /// Returns whether a scalar part of a flow is selected; `key` is the name of the flow with its members and indices.
    fn selects_leaf(&self, key: &str) -> bool {
        self.names.iter().any(|name| contains(name, key))
    }
}

/// Returns whether the name `name` of a flow, call or fragment is `inner`, or that of something around it.
#[must_use]
pub fn contains(name: &str, inner: &str) -> bool {
    let rest = inner.strip_prefix(name);
    name.is_empty() || rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// Flows to be watched in one net, and the flows that it has.
#[derive(Default)]
pub(super) struct Watch {
    pub(super) selection: FlowSelection,
    /// Names of all flows of the net, and of the scalar parts of the watched ones, if some are to be watched.
    pub(super) names: Vec<String>,
}

/// Exports the selected flows of a unit whose body has been elaborated at the position `at`.
pub(super) fn export_watched<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>, at: Position) {
    if elab.watch.selection.is_empty() || elab.mode != ElabMode::Net {
        return;
    }
    let at = at.unguarded();
    let around = elab.net.fragment_names(at.fragment).into_iter();
    let around: String = around.map(|name| format!("{name}.")).collect();
    let prefix = format!("{around}{}", scope.prefix);
    for id in (0..).map(FlowId).take(scope.unit.flows.len()) {
        let declared = scope.unit.flow(id);
        // A generated flow has no name that a user could write.
        if matches!(declared.ty, Ty::Device(_)) || !declared.name.starts_with(is_letter) {
            continue;
        }
        let name = format!("{prefix}{}", scope.unit.flow_path(id));
        if elab.watch.selection.selects(&name) {
            export_flow(elab, scope, id, &name, at);
        }
        elab.watch.names.push(name);
    }
}

fn is_letter(sign: char) -> bool {
    sign.is_alphabetic() || sign == '_'
}

fn export_flow<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    flow: FlowId,
    name: &str,
    at: Position,
) {
    let declared = scope.unit.flow(flow);
    let is_inner = declared.block != BlockId::ROOT;
    block::set_node_name(elab, name);
    let wire = fragment_outputs::read_flow(elab, scope, (flow, is_inner), at, declared.span);
    let wire = match is_inner {
        true => wire,
        false => outside_flows::off_clock_absent(elab, scope, flow, &wire, declared.span),
    };
    let mut leaves: Vec<(String, Ty)> = Vec::new();
    declared
        .ty
        .for_each_leaf(&mut |path, ty| leaves.push((format!("{name}{path}"), ty.clone())));
    for ((key, ty), signal) in leaves.into_iter().zip(wire.iter()) {
        if key != name {
            elab.watch.names.push(key.clone());
        }
        if elab.kept_exports.len() < MAX_WATCHED && elab.watch.selection.selects_leaf(&key) {
            let port = export_port(elab, &key, signal, &ty, at, declared.span);
            elab.kept_exports.extend(port);
        }
    }
}

/// Drops the watched flows that the program exports under the same key itself.
pub(super) fn drop_repeated(elab: &mut Elaborator<'_>) {
    if elab.watch.selection.is_empty() {
        return;
    }
    let known: FastSet<&str> = elab
        .net
        .exports
        .iter()
        .map(|port| port.key.as_str())
        .collect();
    let mut kept = std::mem::take(&mut elab.kept_exports);
    kept.retain(|port| !known.contains(port.key.as_str()));
    elab.kept_exports = kept;
}
