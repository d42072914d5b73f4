//! Translates primitives to Lustre equations, one primitive at a time.

use super::observed_flow::{ObservedFlow, PresenceCondition};
use super::operations::{self, Equation};
use super::operators::{Check, check, fill, guarded, is_partial, operator};
use super::translator::Translator;
use super::value::{literal, neutral, type_name};
use crate::net::{Input, NodeId, PortRef};
use crate::passes::FlowPresence;
use rpi_image::{CommandFlow, Fallback, PortType, Role, Scalar, Type, Value};

impl Translator<'_> {
    /// Writes the Lustre equation of a node. For a primitive that checks a condition, it writes an assertion or a
    /// property instead; for one without Lustre equivalent, an input.
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
        let claimed =
            condition.and_then(|condition| self.fragments.guarded_condition(fragment, &condition));
        match check {
            Check::Assume => self.node.assumptions.extend(claimed),
            Check::Property => self.node.properties.extend(claimed),
        }
    }

    /// Writes the bounds of a subrange check: as an assumption if the checked value is an input, otherwise as a
    /// property that a model checker must prove.
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
            .fragments
            .guarded_condition(fragment, &claim)
            .filter(|_| !ends.is_empty());
        match is_given {
            true => self.node.assumptions.extend(claimed),
            false => self.node.properties.extend(claimed),
        }
    }

    fn define(&mut self, port: PortRef, scalar: Scalar, result: &Equation) {
        let Some(ty) = type_name(scalar) else {
            return;
        };
        let name = self.flow(port);
        self.node.define(&name, ty, &result.value);
        if self.analysis.presences.own(port) == FlowPresence::Optional {
            let presence = result.presence.text();
            self.node.define(&format!("{name}_is"), "bool", &presence);
        }
    }

    fn equation_of(&mut self, id: NodeId, scalar: Scalar) -> Option<Equation> {
        let node = self.net().node(id);
        match node.desc().role {
            Role::Flow(CommandFlow::Period) => {
                let period = Value::real(self.period_ns as f64 / 1e9);
                literal(&period).map(Equation::always_present)
            }
            Role::Flow(CommandFlow::PeriodTicks) => {
                literal(&Value::int(1)).map(Equation::always_present)
            }
            Role::Constant => literal(node.params.first()?).map(Equation::always_present),
            Role::Delay => self.delay(id, scalar),
            Role::First => self.first(id),
            Role::IsAbsent => {
                let seen = self.operand_presence(id, 0)?;
                let value = format!("not {}", seen.presence.text());
                Some(Equation::always_present(value))
            }
            Role::Compute => self.computed(id, scalar),
            _ => None,
        }
    }

    /// Returns the Lustre expressions for the value and presence of in-port `k` of a node; `None` if the value has no
    /// Lustre form, or if the in-port is not connected although it needs a value.
    pub(super) fn operand(&mut self, id: NodeId, k: usize) -> Option<ObservedFlow> {
        let seen = self.operand_presence(id, k)?;
        seen.value.is_some().then_some(seen)
    }

    /// Returns the Lustre expressions for in-port `k` of a node, for primitives that may read only its presence: the
    /// value may have no Lustre form.
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

    pub(super) fn operands(&mut self, id: NodeId) -> Option<Vec<ObservedFlow>> {
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
            "BooleanAnd" => operations::kleene(&self.operands(id)?, "and"),
            "BooleanOr" => operations::kleene(&self.operands(id)?, "or"),
            "BooleanImplies" => operations::kleene(&self.operands(id)?, "=>"),
            "IntEquals" | "DoubleEquals" => self.equals(id),
            _ if plain.ends_with("Conditional") => operations::conditional(&self.operands(id)?),
            _ if plain.ends_with("Coalesce") => operations::coalesce(&self.operands(id)?),
            _ if plain.ends_with("Hold") => self.hold(id, scalar),
            _ if plain.ends_with("SetNull") => operations::set_null(&self.operands(id)?),
            _ => None,
        }
    }

    /// Returns the equation of a constant duration as a number of ticks, rounded as in the control core; `None` if the
    /// duration is not constant.
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

    /// Returns the equation of a primitive whose output is present exactly if all operands are. `template` is its
    /// Lustre expression.
    ///
    /// An operation that may fault is computed only in cycles in which the output is present, and a partial operation,
    /// such as a quotient, only while its fragment is active, too.
    fn strict(&mut self, id: NodeId, scalar: Scalar, template: &str) -> Option<Equation> {
        let seen = self.operands(id)?;
        let is = seen
            .iter()
            .fold(PresenceCondition::Always, |is, seen| is.and(&seen.presence));
        let values: Vec<String> = seen.into_iter().filter_map(|seen| seen.value).collect();
        let value = fill(template, &values);
        let node = self.net().node(id);
        let computed = match is_partial(node.desc().name) {
            true => self.fragments.active(node.fragment).and(&is),
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

    /// Returns the equation of a test for equality, up to the tolerance in the primitive's parameter `Epsilon`.
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
}
