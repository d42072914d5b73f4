//! What a reader sees of a flow: its value, and when it is there; and when fragments are active.

use super::names::Names;
use super::value::{literal, neutral, type_name};
use crate::net::{Absent, Activation, FragmentId, Input, Net, NodeId, PortRef, Restart};
use crate::passes::{Analysis, Sureness};
use rpi_diag::{Code, Finding};
use rpi_image::{Scalar, Type};
use std::collections::{BTreeMap, BTreeSet};

/// A program in the making.
pub(super) struct Writer<'n> {
    pub(super) analysis: &'n Analysis,
    names: Names,
    pub(super) title: String,
    pub(super) inputs: Vec<String>,
    pub(super) outputs: Vec<String>,
    pub(super) locals: Vec<String>,
    pub(super) equations: Vec<String>,
    pub(super) claims: Vec<String>,
    pub(super) findings: Vec<Finding>,
    /// Of each flow its name; the same with `_is` tells whether it is there.
    flows: BTreeMap<PortRef, String>,
    /// The inputs that have been declared, by key.
    given: BTreeMap<String, String>,
    /// The nodes that stand for them.
    pub(super) inputs_taken: BTreeSet<NodeId>,
    /// The names of outputs, by key.
    reserved: BTreeMap<String, String>,
    fragments: Vec<Activity>,
}

/// When a fragment is active, and when its state starts afresh, as expressions; none: always, never.
#[derive(Clone, Default)]
struct Activity {
    on: Option<String>,
    again: Option<String>,
}

/// A flow as a reader sees it.
pub(super) struct Seen {
    /// Its value; none for a type that Lustre does not have.
    pub(super) value: Option<String>,
    /// When it is there: a condition.
    pub(super) is: Is,
}

/// When something is there.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Is {
    Always,
    Never,
    /// While all of these hold.
    While(Vec<String>),
}

impl Is {
    /// Both are there.
    pub(super) fn and(&self, other: &Is) -> Is {
        match (self, other) {
            (Is::Never, _) | (_, Is::Never) => Is::Never,
            (Is::Always, is) | (is, Is::Always) => is.clone(),
            (Is::While(a), Is::While(b)) => {
                let fresh = b.iter().filter(|condition| !a.contains(condition));
                Is::While(a.iter().chain(fresh).cloned().collect())
            }
        }
    }

    /// As an expression in parentheses where it needs them.
    pub(super) fn text(&self) -> String {
        match self {
            Is::Always => "true".to_owned(),
            Is::Never => "false".to_owned(),
            Is::While(all) => match &all[..] {
                [one] => one.clone(),
                all => format!("({})", all.join(" and ")),
            },
        }
    }
}

impl<'n> Writer<'n> {
    pub(super) fn new(analysis: &'n Analysis) -> Self {
        let mut names = Names::default();
        let title = names.fresh(&analysis.net.name);
        Writer {
            analysis,
            names,
            title,
            inputs: Vec::new(),
            outputs: Vec::new(),
            locals: Vec::new(),
            equations: Vec::new(),
            claims: Vec::new(),
            findings: Vec::new(),
            flows: BTreeMap::new(),
            given: BTreeMap::new(),
            inputs_taken: BTreeSet::new(),
            reserved: BTreeMap::new(),
            fragments: Vec::new(),
        }
    }

    pub(super) fn net(&self) -> &'n Net {
        &self.analysis.net
    }

    /// A local flow of its own with this equation.
    pub(super) fn local(&mut self, like: &str, ty: &str, value: &str) -> String {
        let name = self.names.fresh(like);
        self.locals.push(format!("{name}: {ty}"));
        self.equations.push(format!("{name} = {value}"));
        name
    }

    /// A local flow whose equation follows.
    pub(super) fn declared(&mut self, like: &str, ty: &str) -> String {
        let name = self.names.fresh(like);
        self.locals.push(format!("{name}: {ty}"));
        name
    }

    /// An input of the node.
    pub(super) fn input(&mut self, key: &str, ty: Scalar) -> Option<String> {
        if let Some(name) = self.given.get(key) {
            return Some(name.clone());
        }
        let ty = type_name(ty)?;
        let name = self.names.fresh(key);
        self.inputs.push(format!("{name}: {ty}"));
        self.given.insert(key.to_owned(), name.clone());
        Some(name)
    }

    /// The name of a flow, whether its equation has been written or not.
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

    /// The companion that tells whether a flow is there.
    pub(super) fn companion(&mut self, port: PortRef) -> String {
        format!("{}_is", self.flow(port))
    }

    /// A flow that is an input takes the input's name.
    pub(super) fn is_input(&mut self, port: PortRef, name: String) {
        self.inputs_taken.insert(port.node);
        self.flows.insert(port, name);
    }

    /// Whether a flow is in every cycle in which its fragment is active.
    pub(super) fn own(&mut self, port: PortRef) -> Is {
        match self.analysis.presences.own(port) {
            Sureness::Total => Is::Always,
            Sureness::Never => Is::Never,
            Sureness::Optional => Is::While(vec![self.companion(port)]),
        }
    }

    /// What a reader in a fragment sees of an input's source.
    pub(super) fn seen(&mut self, reader: FragmentId, input: &Input, ty: Scalar) -> Seen {
        match input {
            Input::Open => Seen {
                value: neutral(ty).map(str::to_owned),
                is: Is::Never,
            },
            Input::Const(value) => Seen {
                value: literal(value),
                is: Is::Always,
            },
            Input::Port(port) => self.seen_port(reader, *port, ty),
        }
    }

    pub(super) fn seen_port(&mut self, reader: FragmentId, port: PortRef, ty: Scalar) -> Seen {
        let (presences, tree) = (&self.analysis.presences, &self.analysis.tree);
        let through = presences.view(self.net(), tree, reader, port).through;
        let mut is = self.own(port);
        for fragment in through {
            let on = self.fragments[fragment.index()].on.clone();
            is = is.and(&on.map_or(Is::Always, |on| Is::While(vec![on])));
        }
        let known = matches!(
            self.net()
                .node(port.node)
                .outputs
                .get(usize::from(port.port)),
            Some(Type::One(_))
        );
        let value = type_name(ty).filter(|_| known).map(|_| self.flow(port));
        Seen { value, is }
    }

    /// The flows that say when fragments are active and start afresh. Parents come first.
    pub(super) fn fragments(&mut self) {
        self.fragments = vec![Activity::default(); self.net().fragments.len()];
        for id in self.net().fragment_ids() {
            let activity = self.activity(id);
            self.fragments[id.index()] = activity;
        }
    }

    fn activity(&mut self, id: FragmentId) -> Activity {
        let fragment = self.net().fragment(id);
        let Some(parent) = fragment.parent else {
            return Activity::default();
        };
        let outer = self.fragments[parent.index()].clone();
        let path = self.net().path(parent, &fragment.name);
        let on = match fragment.activation {
            Activation::Always => outer.on.clone(),
            Activation::When { condition, absent } => {
                let holds = self.holds(parent, condition, absent);
                let all = outer.on.iter().cloned().chain([holds]);
                let all: Vec<String> = all.collect();
                Some(self.local(&format!("{path}_on"), "bool", &all.join(" and ")))
            }
        };
        let own = match fragment.restart {
            Restart::Never => None,
            Restart::OnActivation => on
                .as_ref()
                .map(|on| format!("({on} and not (false -> pre {on}))")),
            // Nobody asks while what is around the fragment is not active.
            Restart::Every(condition) => {
                let asked = self.holds(parent, condition, Absent::Inactive);
                Some(match &outer.on {
                    Some(on) => format!("({on} and {asked})"),
                    None => asked,
                })
            }
        };
        let again = match (own, &outer.again) {
            (None, again) => again.clone(),
            (Some(own), None) => Some(self.local(&format!("{path}_again"), "bool", &own)),
            (Some(own), Some(outer)) => {
                let either = format!("{own} or {outer}");
                Some(self.local(&format!("{path}_again"), "bool", &either))
            }
        };
        Activity { on, again }
    }

    fn holds(&mut self, reader: FragmentId, condition: PortRef, absent: Absent) -> String {
        let seen = self.seen_port(reader, condition, Scalar::Bool);
        let value = seen.value.unwrap_or_else(|| "false".to_owned());
        match (&seen.is, absent) {
            (Is::Always, _) => value,
            (is, Absent::Inactive) => format!("({} and {value})", is.text()),
            (is, Absent::Active) => format!("(not {} or {value})", is.text()),
        }
    }

    /// A value of the previous cycle in which the fragment was active: `next` is what it will be, and the name of the
    /// flow that gives it is what is returned.
    pub(super) fn kept(
        &mut self,
        fragment: FragmentId,
        like: &str,
        ty: &str,
        first: &str,
        next: impl FnOnce(&str) -> String,
    ) -> String {
        let Activity { on, again } = self.fragments[fragment.index()].clone();
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

    /// Keeps the name of an output for it.
    pub(super) fn reserve(&mut self, key: &str) {
        let name = self.names.fresh(key);
        self.reserved.insert(key.to_owned(), name);
    }

    /// An output of the node; one that may be absent has a companion.
    pub(super) fn output(&mut self, key: &str, ty: Scalar, source: &Input) {
        let seen = self.seen(FragmentId::ROOT, source, ty);
        let (Some(value), Some(name)) = (seen.value, type_name(ty)) else {
            return;
        };
        let reserved = self.reserved.get(key).cloned();
        let output = reserved.unwrap_or_else(|| self.names.fresh(key));
        self.outputs.push(format!("{output}: {name}"));
        self.equations.push(format!("{output} = {value}"));
        if seen.is != Is::Always {
            let companion = self.names.fresh(&format!("{output}_is"));
            self.outputs.push(format!("{companion}: bool"));
            self.equations
                .push(format!("{companion} = {}", seen.is.text()));
        }
    }

    /// A property: a condition that holds wherever it is there and its fragment is active.
    pub(super) fn property(&mut self, fragment: FragmentId, condition: &Seen) {
        let Some(value) = &condition.value else {
            return;
        };
        let on = self.fragments[fragment.index()].on.clone();
        let on = on.map_or(Is::Always, |on| Is::While(vec![on]));
        self.claims.push(match on.and(&condition.is) {
            Is::Always => value.clone(),
            is => format!("({} => {value})", is.text()),
        });
    }

    /// Inputs in the place of a primitive that has no form here.
    pub(super) fn leave_open(&mut self, id: NodeId) {
        let node = self.net().node(id);
        let mut names = Vec::new();
        for (ty, k) in node.outputs.iter().zip(0..) {
            let port = PortRef { node: id, port: k };
            let Type::One(scalar) = *ty else {
                continue;
            };
            let Some(type_name) = type_name(scalar) else {
                continue;
            };
            let name = self.flow(port);
            self.inputs.push(format!("{name}: {type_name}"));
            if self.analysis.presences.own(port) == Sureness::Optional {
                self.inputs.push(format!("{name}_is: bool"));
            }
            names.push(format!("`{name}`"));
        }
        if !names.is_empty() {
            let message = format!("`{}` has no form in Lustre", node.desc().name);
            let label = format!("{} in the program may be anything", names.join(", "));
            self.findings
                .push(Finding::new(Code::RPI9103, message).at(node.origin.span, label));
        }
    }
}
