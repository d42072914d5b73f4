//! Formats a [`Net`] as text.
//!
//! In a net, links run from primitive to primitive; in the text they pass through ports on the borders of fragments.
//! Declared ports are used where they carry the flow, others are added. A net that was parsed from a text is equal
//! after formatting and parsing.

use super::build::{FAIL, RESTART, RESTART_ON_ACTIVATION, TERMINATE};
use super::constants;
use super::text_names::TextNames;
use super::value;
use crate::fragment_tree::{FragmentTree, Item};
use crate::net::Restart;
use crate::net::{FragmentId, Input, Net, NodeId, PortRef, Termination};
use rpi_image::{Fallback, InPort, Value};
use std::fmt::Write;

/// Returns a net as text. The net must end by ports; [`super::results_to_ports`] converts the results of a command to
/// ports.
pub(super) fn write(net: &Net, tree: &FragmentTree) -> String {
    let mut writer = Writer {
        net,
        tree,
        ports: TextNames::new(net, tree),
        out: String::with_capacity(100 * net.nodes.len()),
        comma: false,
    };
    writer.body(FragmentId::ROOT);
    writer.out
}

struct Writer<'a> {
    net: &'a Net,
    tree: &'a FragmentTree,
    ports: TextNames<'a>,
    out: String,
    /// Whether the next entry of the current list needs a comma before it.
    comma: bool,
}

impl Writer<'_> {
    /// Writes the contents of a fragment in braces.
    fn body(&mut self, fragment: FragmentId) {
        self.open('{');
        for item in self.tree.items(fragment) {
            match item {
                Item::Node(node) => self.node(node),
                Item::Fragment(child) => self.fragment(child),
            }
        }
        for (name, source) in self.ports.outputs(fragment).to_vec() {
            self.link(&name, fragment, &source);
        }
        if fragment == FragmentId::ROOT {
            self.driver();
        }
        self.close('}');
    }

    fn fragment(&mut self, id: FragmentId) {
        let scope = self.tree.parent(id).unwrap_or(FragmentId::ROOT);
        self.begin_entry(self.ports.fragment_name(id).to_owned().as_str());
        self.body(id);
        self.open('(');
        for (name, source) in self.ports.inputs(id).to_vec() {
            self.link(&name, scope, &source);
        }
        if matches!(self.net.fragment(id).restart, Restart::OnActivation) {
            self.setting(RESTART, &Value::Str(RESTART_ON_ACTIVATION.into()));
        }
        self.close(')');
    }

    fn node(&mut self, id: NodeId) {
        let (net, node) = (self.net, self.net.node(id));
        self.begin_entry(self.ports.node_name(id).to_owned().as_str());
        self.out.push_str(node.desc().name);
        self.open('(');
        let inputs = || node.desc().inputs.iter().zip(&node.inputs);
        for (port, input) in inputs().filter(|(p, i)| is_linked(p, i)) {
            self.link(port.name, net.node(id).fragment, input);
        }
        for (port, input) in inputs() {
            if let Input::Const(constant) = input {
                self.default_parameters(port, constant);
            }
        }
        for (param, setting) in node.desc().params.iter().zip(&node.params) {
            self.setting(param.name, setting);
        }
        self.close(')');
    }

    /// Writes the parameters that stand for a constant at an in-port.
    fn default_parameters(&mut self, port: &InPort, constant: &Value) {
        match port.fallback {
            _ if lacks_reference_parameter(port) => {}
            Fallback::Required | Fallback::AbsentValue => {}
            Fallback::Param(name, _) => self.setting(name, constant),
            Fallback::ComposedOfParams(parts, make) => {
                let reals = constants::constant_parts(constant, parts.len(), make);
                for ((name, _), real) in parts.iter().zip(reals) {
                    self.setting(name, &Value::real(real));
                }
            }
        }
    }

    fn driver(&mut self) {
        let Termination::Ports { terminate, fail } = &self.net.termination else {
            return;
        };
        for (name, source) in [(TERMINATE, terminate), (FAIL, fail)] {
            if let Some(source) = source {
                self.link(name, FragmentId::ROOT, source);
            }
        }
    }

    /// Writes `name=source` for the source of a port as seen in the fragment `scope`.
    fn link(&mut self, name: &str, scope: FragmentId, source: &Input) {
        match source {
            Input::Unconnected => {}
            Input::Port(port) => {
                self.begin_entry(name);
                self.reference(scope, *port);
            }
            Input::Const(constant) => {
                if let Some(ty) = constants::constant_primitive(constant) {
                    self.begin_entry(name);
                    let text = value::write(constant);
                    // Writing to a string cannot fail.
                    let _ = write!(self.out, "{ty}(Value='{text}').outValue");
                }
            }
        }
    }

    /// Writes the reference to a flow as seen in the fragment `scope`: `node.port`, `fragment.port` or `parent.port`.
    fn reference(&mut self, scope: FragmentId, port: PortRef) {
        let origin = self.net.node(port.node).fragment;
        if origin == scope {
            let output = self.net.node(port.node).desc().outputs[usize::from(port.port)].name;
            self.out.push_str(self.ports.node_name(port.node));
            self.out.push('.');
            self.out.push_str(output);
        } else if self.tree.common_ancestor(scope, origin) == scope {
            let child = self.tree.child_towards(scope, origin).unwrap_or(origin);
            self.out.push_str(self.ports.fragment_name(child));
            self.out.push('.');
            self.out.push_str(self.ports.output(child, port));
        } else {
            self.out.push_str("parent.");
            self.out.push_str(self.ports.input(scope, port));
        }
    }

    fn setting(&mut self, name: &str, setting: &Value) {
        self.begin_entry(name);
        self.out.push('\'');
        self.out.push_str(&value::write(setting));
        self.out.push('\'');
    }

    fn begin_entry(&mut self, name: &str) {
        if std::mem::replace(&mut self.comma, true) {
            self.out.push(',');
        }
        self.out.push_str(name);
        self.out.push('=');
    }

    fn open(&mut self, bracket: char) {
        self.out.push(bracket);
        self.comma = false;
    }

    fn close(&mut self, bracket: char) {
        self.out.push(bracket);
        self.comma = true;
    }
}

/// Returns whether the source of an in-port is written as a link: a flow, or a constant that no parameter can express.
fn is_linked(port: &InPort, input: &Input) -> bool {
    let Input::Const(constant) = input else {
        return input.port().is_some();
    };
    match port.fallback {
        Fallback::Required | Fallback::AbsentValue => true,
        Fallback::Param(..) | Fallback::ComposedOfParams(..) => {
            lacks_reference_parameter(port) && constant.as_bool() == Some(true)
        }
    }
}

/// Returns whether the reference system has no parameter that replaces this in-port, although this system has one.
fn lacks_reference_parameter(port: &InPort) -> bool {
    port.name == "inReset"
}
