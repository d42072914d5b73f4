//! Flows and fragments in Lustre: value and presence of a flow as a reader sees it, and the activation of fragments.

use super::names::Names;
use super::value::{literal, neutral, type_name};
use crate::net::{AbsentPolicy, Activation, FragmentId, Input, Net, NodeId, PortRef, Restart};
use crate::passes::{Analysis, FlowPresence};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::{PortType, Presence, PrimDesc, Scalar, Type};
use std::collections::{BTreeMap, BTreeSet};

/// Lustre program under construction.
pub(super) struct Writer<'n> {
    pub(super) analysis: &'n Analysis,
    /// Period of a cycle in nanoseconds.
    pub(super) period_ns: u64,
    pub(super) names: Names,
    pub(super) node_name: String,
    pub(super) inputs: Vec<String>,
    pub(super) outputs: Vec<String>,
    pub(super) locals: Vec<String>,
    pub(super) equations: Vec<String>,
    /// Boolean expressions that are assumed (`assert`).
    pub(super) assumptions: Vec<String>,
    /// Boolean expressions to prove (`--%PROPERTY`).
    pub(super) properties: Vec<String>,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Lustre name of each flow. The name with the suffix `_is` is its presence.
    flows: BTreeMap<PortRef, String>,
    /// Lustre names of the declared inputs, by key.
    inputs_by_key: BTreeMap<String, String>,
    /// Lustre names of the inputs for flows that the control core supplies, by primitive.
    core_inputs: BTreeMap<&'static str, String>,
    /// Nodes that are represented by inputs.
    pub(super) input_nodes: BTreeSet<NodeId>,
    /// Reserved Lustre names of outputs, by key.
    pub(super) reserved: BTreeMap<String, String>,
    fragments: Vec<FragmentActivation>,
}

/// Expressions for a fragment's activation (`None`: always active) and reset (`None`: never).
#[derive(Clone, Default)]
struct FragmentActivation {
    active: Option<String>,
    reset: Option<String>,
}

/// Value and presence of a flow as a reader sees it.
pub(super) struct ObservedFlow {
    /// Value expression; `None` for a type without Lustre equivalent.
    pub(super) value: Option<String>,
    /// Presence condition.
    pub(super) presence: PresenceCondition,
}

impl ObservedFlow {
    /// Expression that is true if the Boolean is true. `absent` is the meaning of an absent value.
    pub(super) fn holds(&self, absent: AbsentPolicy) -> String {
        let value = self.value.as_deref().unwrap_or("false");
        match (&self.presence, absent) {
            (PresenceCondition::Always, _) => value.to_owned(),
            (is, AbsentPolicy::Inactive) => format!("({} and {value})", is.text()),
            (is, AbsentPolicy::Active) => format!("(not {} or {value})", is.text()),
        }
    }
}

/// Presence condition of a flow.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum PresenceCondition {
    Always,
    Never,
    /// Present while all of these expressions are true.
    While(Vec<String>),
}

impl PresenceCondition {
    /// Conjunction of two presence conditions.
    pub(super) fn and(&self, other: &PresenceCondition) -> PresenceCondition {
        match (self, other) {
            (PresenceCondition::Never, _) | (_, PresenceCondition::Never) => {
                PresenceCondition::Never
            }
            (PresenceCondition::Always, is) | (is, PresenceCondition::Always) => is.clone(),
            (PresenceCondition::While(a), PresenceCondition::While(b)) => {
                let fresh = b.iter().filter(|condition| !a.contains(condition));
                PresenceCondition::While(a.iter().chain(fresh).cloned().collect())
            }
        }
    }

    /// Boolean expression of the condition, in parentheses where needed.
    pub(super) fn text(&self) -> String {
        match self {
            PresenceCondition::Always => "true".to_owned(),
            PresenceCondition::Never => "false".to_owned(),
            PresenceCondition::While(all) => match &all[..] {
                [one] => one.clone(),
                all => format!("({})", all.join(" and ")),
            },
        }
    }
}

impl<'n> Writer<'n> {
    pub(super) fn new(analysis: &'n Analysis, period_ns: u64) -> Self {
        let mut names = Names::default();
        let title = names.fresh(&analysis.net.name);
        Writer {
            analysis,
            period_ns,
            names,
            node_name: title,
            inputs: Vec::new(),
            outputs: Vec::new(),
            locals: Vec::new(),
            equations: Vec::new(),
            assumptions: Vec::new(),
            properties: Vec::new(),
            diagnostics: Vec::new(),
            flows: BTreeMap::new(),
            inputs_by_key: BTreeMap::new(),
            core_inputs: BTreeMap::new(),
            input_nodes: BTreeSet::new(),
            reserved: BTreeMap::new(),
            fragments: Vec::new(),
        }
    }

    pub(super) fn net(&self) -> &'n Net {
        &self.analysis.net
    }

    /// Adds a local flow with this equation and returns its name.
    pub(super) fn local(&mut self, like: &str, ty: &str, value: &str) -> String {
        let name = self.names.fresh(like);
        self.locals.push(format!("{name}: {ty}"));
        self.equations.push(format!("{name} = {value}"));
        name
    }

    /// Declares a local flow, whose equation the caller adds, and returns its name.
    pub(super) fn declared(&mut self, like: &str, ty: &str) -> String {
        let name = self.names.fresh(like);
        self.locals.push(format!("{name}: {ty}"));
        name
    }

    /// Adds an input of the Lustre node unless it exists and returns its name; `None` for a type without Lustre
    /// equivalent.
    pub(super) fn input(&mut self, key: &str, ty: Scalar) -> Option<String> {
        if let Some(name) = self.inputs_by_key.get(key) {
            return Some(name.clone());
        }
        let ty = type_name(ty)?;
        let name = self.names.fresh(key);
        self.inputs.push(format!("{name}: {ty}"));
        self.inputs_by_key.insert(key.to_owned(), name.clone());
        Some(name)
    }

    /// Name of the input for a flow that the control core supplies. All readers share one input.
    pub(super) fn core_input(&mut self, desc: &'static PrimDesc, reader: Span) -> Option<String> {
        if let Some(name) = self.core_inputs.get(desc.name) {
            return Some(name.clone());
        }
        let port = desc.outputs.first()?;
        let PortType::Scalar(scalar) = port.ty else {
            return None;
        };
        let ty = type_name(scalar)?;
        let name = self.names.fresh(&desc.name.to_lowercase());
        self.inputs.push(format!("{name}: {ty}"));
        if port.presence == Presence::Maybe {
            self.inputs.push(format!("{name}_is: bool"));
        }
        self.core_inputs.insert(desc.name, name.clone());
        self.report_unconstrained(desc, std::slice::from_ref(&name), reader);
        Some(name)
    }

    /// Lustre name of a flow, whether or not its equation has been written.
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
        let name = self.names.fresh(&path);
        self.flows.insert(port, name.clone());
        name
    }

    /// Name of the Boolean flow that says whether a flow is present.
    pub(super) fn presence_name(&mut self, port: PortRef) -> String {
        format!("{}_is", self.flow(port))
    }

    /// Maps a flow to an input of the Lustre node.
    pub(super) fn map_to_input(&mut self, port: PortRef, name: String) {
        self.input_nodes.insert(port.node);
        self.flows.insert(port, name);
    }

    /// Presence of a flow in the cycles in which its fragment is active.
    pub(super) fn own_presence(&mut self, port: PortRef) -> PresenceCondition {
        match self.analysis.presences.own(port) {
            FlowPresence::Total => PresenceCondition::Always,
            FlowPresence::Never => PresenceCondition::Never,
            FlowPresence::Optional => PresenceCondition::While(vec![self.presence_name(port)]),
        }
    }

    /// Value and presence of an input's source as a reader in the fragment `reader` sees them.
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
            let on = self.fragments[fragment.index()].active.clone();
            is = is.and(&on.map_or(PresenceCondition::Always, |on| {
                PresenceCondition::While(vec![on])
            }));
        }
        let known = matches!(
            self.net()
                .node(port.node)
                .outputs
                .get(usize::from(port.port)),
            Some(Type::Scalar(_))
        );
        let value = type_name(ty).filter(|_| known).map(|_| self.flow(port));
        ObservedFlow {
            value,
            presence: is,
        }
    }

    /// Adds the activation and reset flows of all fragments. Parents come first.
    pub(super) fn fragments(&mut self) {
        self.fragments = vec![FragmentActivation::default(); self.net().fragments.len()];
        for id in self.net().fragment_ids() {
            let activity = self.activity(id);
            self.fragments[id.index()] = activity;
        }
    }

    fn activity(&mut self, id: FragmentId) -> FragmentActivation {
        let fragment = self.net().fragment(id);
        let Some(parent) = fragment.parent else {
            return FragmentActivation::default();
        };
        let outer = self.fragments[parent.index()].clone();
        let path = self.net().path(parent, &fragment.name);
        let on = match fragment.activation {
            Activation::Always => outer.active.clone(),
            Activation::When {
                condition,
                if_absent: absent,
            } => {
                let holds = self.holds(parent, condition, absent);
                let all = outer.active.iter().cloned().chain([holds]);
                let all: Vec<String> = all.collect();
                Some(self.local(&format!("{path}_on"), "bool", &all.join(" and ")))
            }
        };
        let own = self.reset_condition(id, parent, on.as_deref());
        let again = match (own, &outer.reset) {
            (None, again) => again.clone(),
            (Some(own), None) => Some(self.local(&format!("{path}_again"), "bool", &own)),
            (Some(own), Some(outer)) => {
                let either = format!("{own} or {outer}");
                Some(self.local(&format!("{path}_again"), "bool", &either))
            }
        };
        FragmentActivation {
            active: on,
            reset: again,
        }
    }

    /// Expression for a fragment's own reset condition; `None` if it has none.
    fn reset_condition(
        &mut self,
        id: FragmentId,
        parent: FragmentId,
        on: Option<&str>,
    ) -> Option<String> {
        let fragment = self.net().fragment(id);
        match fragment.restart {
            Restart::Never => None,
            // A cycle in which the enclosing fragment is inactive does not end the activation, so state is kept in
            // `parent`.
            Restart::OnActivation => on.map(|on| {
                let like = format!("{}_was", self.net().path(parent, &fragment.name));
                let was = self.add_state(parent, &like, "bool", "false", |_| on.to_owned());
                format!("({on} and not {was})")
            }),
            // A reset request while the fragment is inactive is ignored.
            Restart::Every(condition) => {
                let asked = self.holds(parent, condition, AbsentPolicy::Inactive);
                Some(match on {
                    Some(on) => format!("({on} and {asked})"),
                    None => asked,
                })
            }
        }
    }

    fn holds(&mut self, reader: FragmentId, condition: PortRef, absent: AbsentPolicy) -> String {
        let seen = self.seen_port(reader, condition, Scalar::Bool);
        seen.holds(absent)
    }

    /// Adds a state variable that is updated in the cycles in which the fragment is active. Returns the name of the
    /// flow with the previous value; `next` maps this name to the expression of the next value.
    pub(super) fn add_state(
        &mut self,
        fragment: FragmentId,
        like: &str,
        ty: &str,
        first: &str,
        next: impl FnOnce(&str) -> String,
    ) -> String {
        let FragmentActivation {
            active: on,
            reset: again,
        } = self.fragments[fragment.index()].clone();
        let before = self.declared(like, ty);
        let next = next(&before);
        let state = match on {
            Some(on) => format!("if {on} then {next} else {before}"),
            None => next,
        };
        let state = self.local(&format!("{like}_next"), ty, &state);
        let last = format!("{first} -> pre {state}");
        self.equations.push(match again {
            Some(again) => format!("{before} = if {again} then {first} else ({last})"),
            None => format!("{before} = {last}"),
        });
        before
    }

    /// Condition under which a fragment is active.
    pub(super) fn active(&self, fragment: FragmentId) -> PresenceCondition {
        let on = self.fragments[fragment.index()].active.clone();
        on.map_or(PresenceCondition::Always, |on| {
            PresenceCondition::While(vec![on])
        })
    }

    /// Expression that is true if a condition holds wherever it is present and its fragment is active.
    pub(super) fn guarded_condition(
        &self,
        fragment: FragmentId,
        condition: &ObservedFlow,
    ) -> Option<String> {
        let value = condition.value.clone()?;
        Some(match self.active(fragment).and(&condition.presence) {
            PresenceCondition::Always => value,
            is => format!("({} => {value})", is.text()),
        })
    }

    /// Replaces a primitive without Lustre equivalent by inputs, and reports it.
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
            self.inputs.push(format!("{name}: {type_name}"));
            if self.analysis.presences.own(port) == FlowPresence::Optional {
                self.inputs.push(format!("{name}_is: bool"));
            }
            names.push(name);
        }
        self.report_unconstrained(node.desc(), &names, node.origin.span);
    }

    fn report_unconstrained(&mut self, desc: &PrimDesc, names: &[String], reader: Span) {
        if names.is_empty() {
            return;
        }
        let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        let message = format!("`{}` has no Lustre equivalent", desc.name);
        let label = format!("unconstrained input: {}", names.join(", "));
        let diagnostic = Diagnostic::new(Code::RPI9103, message);
        self.diagnostics.push(diagnostic.primary(reader, label));
    }
}
