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

/// Returns a warning if a command moves an arm along a path and ignores a cancel request; `None` otherwise. Imported
/// nets and tests are not checked.
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

/// Returns whether the diagnostic reports a command that ignores a cancel request.
pub fn is_cancel_ignored(diagnostic: &Diagnostic) -> bool {
    diagnostic.code == Code::RPI6202
}

fn diagnostic(net: &Net, last: &ResultPort, device: &str) -> Diagnostic {
    let name = &net.name;
    let message = format!("command `{name}` ignores a cancel request");
    Diagnostic::new(Code::RPI6202, message)
        .primary(last.origin.span, "no result depends on `cancel`")
        .note(format!(
            "a cancelled `{name}` drives `{device}` until one of its results happens"
        ))
        .help("after `cancel` a motion comes to rest, and its output `stopped` is true: add a result for this case, `fail stopped when ...;` or `finish stopped when ...;`")
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

/// Search from results and set-points back to their sources, to find out whether they depend on the cancel request.
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

    /// Adds the conditions that decide whether the fragment and those around it are active.
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

/// Returns whether a node moves a device along a path and can pause on it.
fn is_motion(node: &Node) -> bool {
    let desc = node.desc();
    let can_pause = desc.inputs.iter().any(|port| port.name == "inPaused");
    matches!(desc.role, Role::DeviceFunction(_)) && can_pause
}
