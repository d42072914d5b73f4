//! Inputs of the Lustre node: inputs of the net, flows of the control core, and primitives without Lustre equivalent.

use super::translator::Translator;
use super::value::type_name;
use crate::net::{Input, NodeId, PortRef};
use crate::passes::FlowPresence;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::{CommandFlow, PortType, Presence, PrimDesc, Role, Scalar, Type, Value};
use std::collections::BTreeSet;

impl Translator<'_> {
    /// Returns the name of the input of the Lustre node for a key of the net, and adds the input if it does not exist;
    /// `None` for a type without Lustre equivalent.
    pub(super) fn input(&mut self, key: &str, ty: Scalar) -> Option<String> {
        if let Some(name) = self.inputs_by_key.get(key) {
            return Some(name.clone());
        }
        let ty = type_name(ty)?;
        let name = self.node.names.fresh(key);
        self.node.add_input(&name, ty);
        self.inputs_by_key.insert(key.to_owned(), name.clone());
        Some(name)
    }

    /// Returns the name of the input for a flow that the control core supplies, and adds the input if it does not
    /// exist; `None` for a type without Lustre equivalent. All readers of the flow share the input.
    ///
    /// `desc` is the primitive that reads the flow, `reader` the location of its use.
    pub(super) fn core_input(&mut self, desc: &'static PrimDesc, reader: Span) -> Option<String> {
        if let Some(name) = self.core_inputs.get(desc.name) {
            return Some(name.clone());
        }
        let port = desc.outputs.first()?;
        let PortType::Scalar(scalar) = port.ty else {
            return None;
        };
        let ty = type_name(scalar)?;
        let name = self.node.names.fresh(&desc.name.to_lowercase());
        self.node.add_input(&name, ty);
        if port.presence == Presence::Maybe {
            self.node.add_input(&format!("{name}_is"), "bool");
        }
        self.core_inputs.insert(desc.name, name.clone());
        self.diagnostics
            .extend(unconstrained(desc, std::slice::from_ref(&name), reader));
        Some(name)
    }

    /// Records that a flow of the net is the input `name` of the Lustre node.
    pub(super) fn map_to_input(&mut self, port: PortRef, name: String) {
        self.input_nodes.insert(port.node);
        self.flows.insert(port, name);
    }

    /// Adds an input of the Lustre node for each input of the net, with the key as name.
    pub(super) fn add_inputs(&mut self) {
        let read = self.net().nodes.iter().flat_map(|node| &node.inputs);
        let read: BTreeSet<PortRef> = read.filter_map(Input::port).collect();
        for id in self.net().node_ids() {
            let node = self.net().node(id);
            let port = PortRef { node: id, port: 0 };
            let is_total = self.analysis.presences.own(port) == FlowPresence::Total;
            let key = node.params.iter().find_map(Value::as_str);
            let (Role::Input, Some(Type::Scalar(scalar)), Some(key), true) =
                (node.desc().role, node.outputs.first(), key, is_total)
            else {
                continue;
            };
            let (key, scalar) = (key.to_owned(), *scalar);
            let Some(name) = self.input(&key, scalar) else {
                continue;
            };
            // The time of the last update has no Lustre form; its presence says whether the input was updated.
            let updated = PortRef { node: id, port: 1 };
            if read.contains(&updated) {
                self.node.add_input(&format!("{name}_is"), "bool");
                self.map_to_input(updated, name.clone());
            }
            self.map_to_input(port, name);
        }
    }

    /// Adds inputs of the Lustre node for the flows that the control core supplies to a command. The period of a cycle
    /// is a constant and needs no input.
    pub(super) fn add_core_inputs(&mut self) {
        for id in self.net().node_ids() {
            let node = self.net().node(id);
            let (Role::Flow(flow), desc) = (node.desc().role, node.desc()) else {
                continue;
            };
            if matches!(flow, CommandFlow::Period | CommandFlow::PeriodTicks) {
                continue;
            }
            if let Some(name) = self.core_input(desc, node.origin.span) {
                self.map_to_input(PortRef { node: id, port: 0 }, name);
            }
        }
    }

    /// Adds inputs of the Lustre node for the outputs of a primitive without Lustre equivalent, and reports a warning.
    pub(super) fn add_unconstrained_inputs(&mut self, id: NodeId) {
        let node = self.net().node(id);
        let mut names = Vec::new();
        for (ty, k) in node.outputs.iter().zip(0..) {
            let port = PortRef { node: id, port: k };
            let Type::Scalar(scalar) = *ty else {
                continue;
            };
            let Some(type_name) = type_name(scalar) else {
                continue;
            };
            let name = self.flow(port);
            self.node.add_input(&name, type_name);
            if self.analysis.presences.own(port) == FlowPresence::Optional {
                self.node.add_input(&format!("{name}_is"), "bool");
            }
            names.push(name);
        }
        self.diagnostics
            .extend(unconstrained(node.desc(), &names, node.origin.span));
    }
}

/// Returns the warning that the inputs `names` stand for the outputs of a primitive without Lustre equivalent; `None`
/// without inputs.
fn unconstrained(desc: &PrimDesc, names: &[String], reader: Span) -> Option<Diagnostic> {
    if names.is_empty() {
        return None;
    }
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    let message = format!("the primitive `{}` has no Lustre equivalent", desc.name);
    let label = match &names[..] {
        [one] => format!("becomes the input {one} of the emitted node, without a constraint"),
        _ => format!(
            "becomes the inputs {} of the emitted node, without a constraint",
            names.join(", ")
        ),
    };
    let diagnostic = Diagnostic::new(Code::RPI9103, message);
    Some(diagnostic.primary(reader, label).help(
        "a model checker lets such an input take any value: state what is known about it by `assume` in the emitted text",
    ))
}
