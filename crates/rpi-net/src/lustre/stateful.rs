//! Equations of primitives with state: hold, delay and `first`.

use super::observed_flow::PresenceCondition;
use super::operations::Equation;
use super::translator::Translator;
use super::value::{neutral, type_name};
use crate::net::{NodeId, PortRef};
use crate::passes::FlowPresence;
use rpi_image::Scalar;

impl Translator<'_> {
    /// Returns the equation of a primitive that holds a value: the last value of its input that was present, or the
    /// initial value before the first one. `None` if an operand has no Lustre form.
    pub(super) fn hold(&mut self, id: NodeId, scalar: Scalar) -> Option<Equation> {
        let seen = self.operands(id)?;
        let [given, initial] = &seen[..] else {
            return None;
        };
        let (x, start) = (given.value.clone()?, initial.value.clone()?);
        let (fragment, is) = (self.net().node(id).fragment, given.presence.text());
        let like = self.flow(PortRef { node: id, port: 0 });
        let seen_before = |before: &str| format!("({is} or {before})");
        let before = self.add_state(
            fragment,
            &format!("{like}_seen"),
            "bool",
            "false",
            seen_before,
        );
        let last = |last: &str| format!("(if {is} then {x} else {last})");
        let (ty, first) = (type_name(scalar)?, neutral(scalar)?);
        let last = self.add_state(fragment, &format!("{like}_last"), ty, first, last);
        Some(Equation {
            value: format!("if {is} then {x} else if {before} then {last} else {start}"),
            presence: initial.presence.or(&format!("{is} or {before}")),
        })
    }

    pub(super) fn delay(&mut self, id: NodeId, scalar: Scalar) -> Option<Equation> {
        let given = self.operand(id, 0)?;
        let node = self.net().node(id);
        let (fragment, port) = (node.fragment, PortRef { node: id, port: 0 });
        let (ty, first) = (type_name(scalar)?, neutral(scalar)?);
        let value = given.value?;
        let like = self.flow(port);
        let kept = |_: &str| format!("({value})");
        let before = self.add_state(fragment, &format!("{like}_before"), ty, first, kept);
        if self.analysis.presences.own(port) != FlowPresence::Optional {
            let is = PresenceCondition::Always;
            return Some(Equation {
                value: before,
                presence: is,
            });
        }
        let there = given.presence.text();
        let at_first = match node.desc().outputs[0].presence {
            rpi_image::Presence::Maybe => "false",
            _ => "true",
        };
        let there = |_: &str| format!("({there})");
        let is = self.add_state(fragment, &format!("{like}_was"), "bool", at_first, there);
        Some(Equation {
            value: before,
            presence: PresenceCondition::While(vec![is]),
        })
    }

    /// Returns the equation of `first`, which is true in the first cycle in which the fragment is active. `None` is
    /// never returned.
    pub(super) fn first(&mut self, id: NodeId) -> Option<Equation> {
        let fragment = self.net().node(id).fragment;
        let like = self.flow(PortRef { node: id, port: 0 });
        let later = |_: &str| "true".to_owned();
        let seen = self.add_state(fragment, &format!("{like}_seen"), "bool", "false", later);
        Some(Equation {
            value: format!("not {seen}"),
            presence: PresenceCondition::Always,
        })
    }
}
