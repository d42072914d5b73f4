//! Translator of a net: names, values and presences of flows as their readers see them.

use super::fragment_activations::FragmentActivations;
use super::node::LustreNode;
use super::observed_flow::{ObservedFlow, PresenceCondition};
use super::value::{literal, neutral, type_name};
use crate::net::{FragmentId, Input, Net, NodeId, PortRef};
use crate::passes::{Analysis, FlowPresence};
use rpi_diag::Diagnostic;
use rpi_image::{Scalar, Type};
use std::collections::{BTreeMap, BTreeSet};

/// State of the translation of a net to a Lustre node.
pub(super) struct Translator<'n> {
    pub(super) analysis: &'n Analysis,
    /// Period of a cycle of the command in nanoseconds.
    pub(super) period_ns: u64,
    pub(super) node: LustreNode,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Lustre name of each flow. The name with the suffix `_is` is the Boolean flow that is true while the flow is
    /// present.
    pub(super) flows: BTreeMap<PortRef, String>,
    /// Lustre name of the input for each key of a declared input.
    pub(super) inputs_by_key: BTreeMap<String, String>,
    /// Lustre name of the input for each flow that the control core supplies, by the name of the primitive that reads
    /// it.
    pub(super) core_inputs: BTreeMap<&'static str, String>,
    /// Nodes whose outputs are inputs of the Lustre node, so that they need no equation.
    pub(super) input_nodes: BTreeSet<NodeId>,
    /// Lustre names of the outputs, by the key of the export or the name of the result. They are reserved so that no
    /// other flow gets them.
    pub(super) reserved: BTreeMap<String, String>,
    pub(super) fragments: FragmentActivations,
}

impl<'n> Translator<'n> {
    pub(super) fn new(analysis: &'n Analysis, period_ns: u64) -> Self {
        Translator {
            analysis,
            period_ns,
            node: LustreNode::new(&analysis.net.name),
            diagnostics: Vec::new(),
            flows: BTreeMap::new(),
            inputs_by_key: BTreeMap::new(),
            core_inputs: BTreeMap::new(),
            input_nodes: BTreeSet::new(),
            reserved: BTreeMap::new(),
            fragments: FragmentActivations::new(analysis.net.fragments.len()),
        }
    }

    pub(super) fn net(&self) -> &'n Net {
        &self.analysis.net
    }

    /// Returns the Lustre name of a flow, which is created on first use.
    pub(super) fn flow(&mut self, port: PortRef) -> String {
        if let Some(name) = self.flows.get(&port) {
            return name.clone();
        }
        let node = self.net().node(port.node);
        let several = node.outputs.len() > 1;
        let like = match several {
            true => format!(
                "{}_{}",
                node.name,
                node.desc().outputs[usize::from(port.port)].name
            ),
            false => node.name.clone(),
        };
        let path = self.net().path(node.fragment, &like);
        let name = self.node.names.fresh(&path);
        self.flows.insert(port, name.clone());
        name
    }

    /// Returns the name of the Boolean flow that is true while a flow is present.
    pub(super) fn presence_name(&mut self, port: PortRef) -> String {
        format!("{}_is", self.flow(port))
    }

    /// Returns the condition under which a flow is present in the cycles in which its fragment is active.
    pub(super) fn own_presence(&mut self, port: PortRef) -> PresenceCondition {
        match self.analysis.presences.own(port) {
            FlowPresence::Total => PresenceCondition::Always,
            FlowPresence::Never => PresenceCondition::Never,
            FlowPresence::Optional => PresenceCondition::While(vec![self.presence_name(port)]),
        }
    }

    /// Returns the Lustre expressions for the value and presence of an input's source, as seen by a reader in the
    /// fragment `reader`. `ty` is the type of the input.
    pub(super) fn seen(&mut self, reader: FragmentId, input: &Input, ty: Scalar) -> ObservedFlow {
        match input {
            Input::Unconnected => ObservedFlow {
                value: neutral(ty).map(str::to_owned),
                presence: PresenceCondition::Never,
            },
            Input::Const(value) => ObservedFlow {
                value: literal(value),
                presence: PresenceCondition::Always,
            },
            Input::Port(port) => self.seen_port(reader, *port, ty),
        }
    }

    pub(super) fn seen_port(
        &mut self,
        reader: FragmentId,
        port: PortRef,
        ty: Scalar,
    ) -> ObservedFlow {
        let (presences, tree) = (&self.analysis.presences, &self.analysis.tree);
        let through = presences.view(self.net(), tree, reader, port).through;
        let mut is = self.own_presence(port);
        for fragment in through {
            is = is.and(&self.fragments.active(fragment));
        }
        let outputs = &self.net().node(port.node).outputs;
        let ty_is_scalar = matches!(outputs.get(usize::from(port.port)), Some(Type::Scalar(_)));
        let value = type_name(ty)
            .filter(|_| ty_is_scalar)
            .map(|_| self.flow(port));
        ObservedFlow {
            value,
            presence: is,
        }
    }
}
