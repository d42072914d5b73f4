//! Commands that ignore a cancel request: nothing that they send to a device, and none of their results, depends on
//! `cancel`.
//!
//! A motion of the arm comes to rest on its path when the command is cancelled. But whether the command ends then is up to
//! its results. So what a motion computes counts as independent of `cancel` here.

use super::writers::Writers;
use crate::net::{Activation, FragmentId, Input, Net, Node, NodeId, ResultPort, Termination};
use rpi_diag::{Code, Diagnostic};
use rpi_image::{CommandFlow, Role};
use rustc_hash::FxHashSet;

/// Returns a warning about a command that moves an arm along a path and ignores a cancel request. Imported nets and tests
/// are not checked.
pub(crate) fn check(net: &Net, writers: &Writers) -> Option<Diagnostic> {
    let Termination::Results(results) = &net.termination else {
        return None;
    };
    let device = &writers.by_resource.keys().next()?.device;
    let last = results.last()?;
    let moves = net.node_ids().any(|id| is_motion(net.node(id)));
    let ignores = moves && !net.is_test && !depends_on_cancel(net, writers, results);
    ignores.then(|| diagnostic(net, last, device))
}

/// Whether the diagnostic says that a command ignores a cancel request.
pub fn is_cancel_ignored(diagnostic: &Diagnostic) -> bool {
    diagnostic.code == Code::RPI6202
}

fn diagnostic(net: &Net, last: &ResultPort, device: &str) -> Diagnostic {
    let name = &net.name;
    let message = format!("command `{name}` ignores a cancel request");
    Diagnostic::new(Code::RPI6202, message)
        .primary(last.origin.span, "no result depends on `cancel`")
        .note(format!(
            "cancelled, it drives `{device}` until one of its results happens"
        ))
        .help("end it when the device is at rest after `cancel`: `fail stopped when c`")
}

fn depends_on_cancel(net: &Net, writers: &Writers, results: &[ResultPort]) -> bool {
    let mut search = Search {
        net,
        seen: FxHashSet::default(),
        fragments: FxHashSet::default(),
        open: Vec::new(),
    };
    let conditions = results.iter().map(|result| &result.condition);
    conditions.for_each(|condition| search.input(condition));
    let written = writers.by_resource.values().flatten();
    written.for_each(|writer| search.node(*writer));
    search.finds_cancel()
}

/// Search against the direction of the flows.
struct Search<'a> {
    net: &'a Net,
    seen: FxHashSet<NodeId>,
    fragments: FxHashSet<FragmentId>,
    open: Vec<NodeId>,
}

impl Search<'_> {
    fn finds_cancel(&mut self) -> bool {
        while let Some(id) = self.open.pop() {
            let node = self.net.node(id);
            if node.desc().role == Role::Flow(CommandFlow::Cancel) {
                return true;
            }
            if !is_motion(node) {
                node.inputs.iter().for_each(|input| self.input(input));
            }
            self.fragment(node.fragment);
        }
        false
    }

    fn input(&mut self, input: &Input) {
        if let Input::Port(port) = input {
            self.node(port.node);
        }
    }

    fn node(&mut self, id: NodeId) {
        if self.seen.insert(id) {
            self.open.push(id);
        }
    }

    /// What decides whether a fragment is active.
    fn fragment(&mut self, id: FragmentId) {
        let net = self.net;
        for id in net.ancestors(id) {
            if !self.fragments.insert(id) {
                return;
            }
            if let Activation::When { condition, .. } = net.fragment(id).activation {
                self.node(condition.node);
            }
        }
    }
}

/// Whether a node moves a device along a path, on which it can pause.
fn is_motion(node: &Node) -> bool {
    let desc = node.desc();
    let can_pause = desc.inputs.iter().any(|port| port.name == "inPaused");
    matches!(desc.role, Role::DeviceFunction(_)) && can_pause
}
