//! Translates primitives to Lustre equations, one primitive at a time.

use super::flows::{ObservedFlow, PresenceCondition, Writer};
use super::operators::{Check, check, fill, guarded, is_partial, operator};
use super::value::{literal, neutral, type_name};
use crate::net::{Input, NodeId, PortRef};
use crate::passes::FlowPresence;
use rpi_image::{CommandFlow, Fallback, PortType, Role, Scalar, Type, Value};
use std::collections::BTreeSet;

/// Lustre expressions of a flow's value and presence.
struct Equation {
    value: String,
    presence: PresenceCondition,
}

impl Writer<'_> {
    /// Writes the equation of a primitive, its assertion, or an input if the primitive has no Lustre equivalent.
    pub(super) fn write_primitive(&mut self, id: NodeId) {
        let node = self.net().node(id);
        if let Some(check) = check(node.desc().name) {
            return self.check(id, check);
        }
        if self.input_nodes.contains(&id) {
            return;
        }
        let [Type::Scalar(scalar)] = node.outputs[..] else {
            return match node.outputs.is_empty() {
                true => {}
                false => self.add_unconstrained_inputs(id),
            };
        };
        if node.desc().name == "Rpi::IntWithin" {
            self.subrange(id);
        }
        let port = PortRef { node: id, port: 0 };
        match self.equation_of(id, scalar) {
            Some(result) => self.define(port, scalar, &result),
            None => self.add_unconstrained_inputs(id),
        }
    }

    fn check(&mut self, id: NodeId, check: Check) {
        let condition = self.operand(id, 0);
        let fragment = self.net().node(id).fragment;
        let claimed = condition.and_then(|condition| self.guarded_condition(fragment, &condition));
        match check {
            Check::Assume => self.assumptions.extend(claimed),
            Check::Property => self.properties.extend(claimed),
        }
    }

    /// Adds the bounds of a subrange check: as an assumption if the value comes from an input, otherwise as a property
    /// to prove.
    fn subrange(&mut self, id: NodeId) {
        let node = self.net().node(id);
        let source = node.inputs.get(1).and_then(Input::port);
        let is_given =
            source.is_some_and(|port| self.net().node(port.node).desc().role == Role::Input);
        let bound = |k: usize| match node.inputs.get(k) {
            Some(Input::Const(value)) => value.as_int(),
            _ => None,
        };
        let [from, to] = [
            bound(2).filter(|end| *end != i64::MIN),
            bound(3).filter(|end| *end != i64::MAX),
        ];
        let fragment = node.fragment;
        let (Some(active), Some(value)) = (self.operand(id, 0), self.operand(id, 1)) else {
            return;
        };
        let (Some(guard), Some(text)) = (&active.value, &value.value) else {
            return;
        };
        let from = from.map(|from| format!("{text} >= {from}"));
        let to = to.map(|to| format!("{text} <= {to}"));
        let ends: Vec<String> = from.into_iter().chain(to).collect();
        let claim = ObservedFlow {
            value: Some(format!("({guard} => {})", ends.join(" and "))),
            presence: active.presence.and(&value.presence),
        };
        let claimed = self
            .guarded_condition(fragment, &claim)
            .filter(|_| !ends.is_empty());
        match is_given {
            true => self.assumptions.extend(claimed),
            false => self.properties.extend(claimed),
        }
    }

    fn define(&mut self, port: PortRef, scalar: Scalar, result: &Equation) {
        let Some(ty) = type_name(scalar) else {
            return;
        };
        let name = self.flow(port);
        self.locals.push(format!("{name}: {ty}"));
        self.equations.push(format!("{name} = {}", result.value));
        if self.analysis.presences.own(port) == FlowPresence::Optional {
            self.locals.push(format!("{name}_is: bool"));
            self.equations
                .push(format!("{name}_is = {}", result.presence.text()));
        }
    }

    /// Adds an input of the Lustre node for each input of the net, named by its key.
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
                self.inputs.push(format!("{name}_is: bool"));
                self.map_to_input(updated, name.clone());
            }
            self.map_to_input(port, name);
        }
    }

    /// Adds inputs for the flows that the control core supplies to a command, except the period, which is a constant.
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

    fn equation_of(&mut self, id: NodeId, scalar: Scalar) -> Option<Equation> {
        let node = self.net().node(id);
        match node.desc().role {
            Role::Flow(CommandFlow::Period) => Some(Equation {
                value: literal(&Value::real(self.period_ns as f64 / 1e9))?,
                presence: PresenceCondition::Always,
            }),
            Role::Flow(CommandFlow::PeriodTicks) => Some(Equation {
                value: literal(&Value::int(1))?,
                presence: PresenceCondition::Always,
            }),
            Role::Constant => Some(Equation {
                value: literal(node.params.first()?)?,
                presence: PresenceCondition::Always,
            }),
            Role::Delay => self.delay(id, scalar),
            Role::First => self.first(id),
            Role::IsAbsent => {
                let seen = self.operand_presence(id, 0)?;
                let value = format!("not {}", seen.presence.text());
                let is = PresenceCondition::Always;
                Some(Equation {
                    value,
                    presence: is,
                })
            }
            Role::Compute => self.computed(id, scalar),
            _ => None,
        }
    }

    /// Value and presence of an in-port as its primitive sees it; `None` if the value has no Lustre form, or if an
    /// unconnected in-port has a default.
    fn operand(&mut self, id: NodeId, k: usize) -> Option<ObservedFlow> {
        let seen = self.operand_presence(id, k)?;
        seen.value.is_some().then_some(seen)
    }

    /// Like [`Writer::operand`], for primitives that may read only the presence: the value may have no Lustre form.
    fn operand_presence(&mut self, id: NodeId, k: usize) -> Option<ObservedFlow> {
        let node = self.net().node(id);
        let declared = node.desc().inputs.get(k)?;
        let PortType::Scalar(scalar) = declared.ty else {
            return None;
        };
        let input = node.inputs.get(k)?.clone();
        if input == Input::Unconnected && !matches!(declared.fallback, Fallback::AbsentValue) {
            return None;
        }
        let fragment = node.fragment;
        Some(self.seen(fragment, &input, scalar))
    }

    fn operands(&mut self, id: NodeId) -> Option<Vec<ObservedFlow>> {
        let count = self.net().node(id).inputs.len();
        (0..count).map(|k| self.operand(id, k)).collect()
    }

    fn computed(&mut self, id: NodeId, scalar: Scalar) -> Option<Equation> {
        let name = self.net().node(id).desc().name;
        let plain = name.rsplit("::").next().unwrap_or(name);
        if let Some(template) = operator(name) {
            return self.strict(id, scalar, template);
        }
        if let Some((template, otherwise)) = guarded(name) {
            let template = format!("if {{0}} then {template} else {otherwise}");
            return self.strict(id, scalar, &template);
        }
        match plain {
            "WholeTicks" => self.constant_ticks(id),
            "SecondsFromTicks" => {
                let tick = literal(&Value::real(self.period_ns as f64))?;
                self.strict(id, scalar, &format!("real {{0}} * {tick} / 1000000000.0"))
            }
            "BooleanAnd" => self.kleene(id, "and"),
            "BooleanOr" => self.kleene(id, "or"),
            "BooleanImplies" => self.kleene(id, "=>"),
            "IntEquals" | "DoubleEquals" => self.equals(id),
            _ if plain.ends_with("Conditional") => self.conditional(id),
            _ if plain.ends_with("Coalesce") => self.coalesce(id),
            _ if plain.ends_with("Hold") => self.hold(id, scalar),
            _ if plain.ends_with("SetNull") => self.set_null(id),
            _ => None,
        }
    }

    /// Constant duration in whole ticks of one period each.
    fn constant_ticks(&mut self, id: NodeId) -> Option<Equation> {
        let Input::Const(value) = self.net().node(id).inputs.first()? else {
            return None;
        };
        let ticks = rpi_prims::whole_ticks(value.as_real()?, self.period_ns);
        Some(Equation {
            value: literal(&Value::int(ticks))?,
            presence: PresenceCondition::Always,
        })
    }

    /// Equation of a strict primitive: present if all operands are. An operation that may fault is computed only then.
    /// A partial operation, such as a quotient, is computed only if its fragment is active, too.
    fn strict(&mut self, id: NodeId, scalar: Scalar, template: &str) -> Option<Equation> {
        let seen = self.operands(id)?;
        let is = seen
            .iter()
            .fold(PresenceCondition::Always, |is, seen| is.and(&seen.presence));
        let values: Vec<String> = seen.into_iter().filter_map(|seen| seen.value).collect();
        let value = fill(template, &values);
        let node = self.net().node(id);
        let computed = match is_partial(node.desc().name) {
            true => self.active(node.fragment).and(&is),
            false => is.clone(),
        };
        let value = match (&computed, node.desc().may_fault) {
            (PresenceCondition::While(_), true) => {
                format!(
                    "if {} then {value} else {}",
                    computed.text(),
                    neutral(scalar)?
                )
            }
            _ => value,
        };
        Some(Equation {
            value,
            presence: is,
        })
    }

    /// Strong Kleene logic for `and`, `or` and `=>` (`not a or b`): one operand may decide the result alone.
    fn kleene(&mut self, id: NodeId, op: &str) -> Option<Equation> {
        let seen = self.operands(id)?;
        let [a, b] = &seen[..] else {
            return None;
        };
        let (x, y) = (a.value.clone()?, b.value.clone()?);
        let both = a.presence.and(&b.presence);
        if both == PresenceCondition::Always {
            let value = format!("{x} {op} {y}");
            return Some(Equation {
                value,
                presence: both,
            });
        }
        let (x, op) = match op {
            "=>" => (format!("(not {x})"), "or"),
            _ => (x, op),
        };
        // An absent operand counts as the neutral element, which does not decide.
        let neutral = |value: &str, is: &PresenceCondition| match op {
            "and" => format!("(not {} or {value})", is.text()),
            _ => format!("({} and {value})", is.text()),
        };
        let decides = |value: &str, is: &PresenceCondition| match op {
            "and" => format!("({} and not {value})", is.text()),
            _ => format!("({} and {value})", is.text()),
        };
        let value = format!(
            "{} {op} {}",
            neutral(&x, &a.presence),
            neutral(&y, &b.presence)
        );
        let [by_x, by_y] = [decides(&x, &a.presence), decides(&y, &b.presence)];
        let any = format!("({} or {by_x} or {by_y})", both.text());
        let is = PresenceCondition::While(vec![any]);
        Some(Equation {
            value,
            presence: is,
        })
    }

    /// Equality up to the primitive's `Epsilon`.
    fn equals(&mut self, id: NodeId) -> Option<Equation> {
        let node = self.net().node(id);
        let epsilon = node.params.first().cloned();
        let exact = epsilon
            .as_ref()
            .is_none_or(|e| e.as_int() == Some(0) || e.as_real() == Some(0.0));
        if exact {
            return self.strict(id, Scalar::Bool, "{0} = {1}");
        }
        let epsilon = literal(&epsilon?)?;
        let template = format!("({{0}} - {{1}} <= {epsilon}) and ({{1}} - {{0}} <= {epsilon})");
        self.strict(id, Scalar::Bool, &template)
    }

    /// Conditional: the branch that is not selected may be absent.
    fn conditional(&mut self, id: NodeId) -> Option<Equation> {
        let seen = self.operands(id)?;
        let [condition, yes, no] = &seen[..] else {
            return None;
        };
        let (c, a, b) = (
            condition.value.clone()?,
            yes.value.clone()?,
            no.value.clone()?,
        );
        let chosen = match (&yes.presence, &no.presence) {
            (a, b) if a == b => a.clone(),
            (a, b) => PresenceCondition::While(vec![format!(
                "(if {c} then {} else {})",
                a.text(),
                b.text()
            )]),
        };
        Some(Equation {
            value: format!("if {c} then {a} else {b}"),
            presence: condition.presence.and(&chosen),
        })
    }

    /// First operand if it is present, otherwise the second.
    fn coalesce(&mut self, id: NodeId) -> Option<Equation> {
        let seen = self.operands(id)?;
        let [first, second] = &seen[..] else {
            return None;
        };
        let (a, b) = (first.value.clone()?, second.value.clone()?);
        Some(match (&first.presence, &second.presence) {
            (PresenceCondition::Always, _) => Equation {
                value: a,
                presence: PresenceCondition::Always,
            },
            (PresenceCondition::Never, is) => Equation {
                value: b,
                presence: is.clone(),
            },
            (is, other) => Equation {
                value: format!("if {} then {a} else {b}", is.text()),
                presence: match other {
                    PresenceCondition::Always => PresenceCondition::Always,
                    other => PresenceCondition::While(vec![format!(
                        "({} or {})",
                        is.text(),
                        other.text()
                    )]),
                },
            },
        })
    }

    /// Last value that was present; the initial value before the first one.
    fn hold(&mut self, id: NodeId, scalar: Scalar) -> Option<Equation> {
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
            presence: match &initial.presence {
                PresenceCondition::Always => PresenceCondition::Always,
                other => PresenceCondition::While(vec![format!(
                    "({is} or {before} or {})",
                    other.text()
                )]),
            },
        })
    }

    /// Operand that is present unless the second operand is true or absent.
    fn set_null(&mut self, id: NodeId) -> Option<Equation> {
        let seen = self.operands(id)?;
        let [given, null] = &seen[..] else {
            return None;
        };
        let kept = PresenceCondition::While(vec![format!("(not {})", null.value.clone()?)]);
        Some(Equation {
            value: given.value.clone()?,
            presence: given.presence.and(&null.presence).and(&kept),
        })
    }

    fn delay(&mut self, id: NodeId, scalar: Scalar) -> Option<Equation> {
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

    /// Boolean that is true in the first cycle of the fragment.
    fn first(&mut self, id: NodeId) -> Option<Equation> {
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
