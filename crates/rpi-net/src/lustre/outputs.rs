//! Outputs of the Lustre node: exports, and the results of a command.

use super::NodeInterface;
use super::observed_flow::PresenceCondition;
use super::translator::Translator;
use super::value::type_name;
use crate::net::{
    AbsentPolicy, FragmentId, Input, Net, PortRef, ResultKind, ResultPort, Termination,
};
use rpi_image::{CommandFlow, Role, Scalar, Type};
use rpi_prims::registry;

/// Returns the exports that become outputs of the Lustre node, with key, type and source: those of the interface, or
/// all scalar ones if the interface lists no outputs.
pub(super) fn exports(net: &Net, boundary: &NodeInterface<'_>) -> Vec<(String, Scalar, PortRef)> {
    let exported = |key: &str| net.exports.iter().find(|export| export.key == key);
    if !boundary.outputs.is_empty() {
        let requested = boundary.outputs.iter();
        let found = requested.filter_map(|column| Some((column, exported(&column.key)?)));
        let row = found.map(|(column, export)| (column.key.clone(), column.scalar, export.source));
        return row.collect();
    }
    let one = net.exports.iter().filter_map(|export| {
        let source = export.source;
        match net.node(source.node).outputs[usize::from(source.port)] {
            Type::Scalar(scalar) => Some((export.key.clone(), scalar, source)),
            _ => None,
        }
    });
    one.collect()
}

/// Returns the results of a command that become outputs of the Lustre node: all of them, or none if the interface lists
/// the outputs.
pub(super) fn results<'n>(net: &'n Net, boundary: &NodeInterface<'_>) -> &'n [ResultPort] {
    match &net.termination {
        Termination::Results(results) if boundary.outputs.is_empty() => results,
        _ => &[],
    }
}

impl Translator<'_> {
    /// Reserves the Lustre name of the output for a key, so that no local flow gets the name.
    pub(super) fn reserve(&mut self, key: &str) {
        let name = self.node.names.fresh(key);
        self.reserved.insert(key.to_owned(), name);
    }

    /// Adds an output of the Lustre node for a flow. An output that may be absent gets a second, Boolean output that is
    /// true while it is present.
    pub(super) fn output(&mut self, key: &str, ty: Scalar, source: PortRef) {
        let seen = self.seen(FragmentId::ROOT, &Input::Port(source), ty);
        let (Some(value), Some(name)) = (seen.value, type_name(ty)) else {
            return;
        };
        let output = self.reserved_name(key);
        self.node.add_output(&output, name);
        self.node.add_equation(&output, &value);
        if seen.presence != PresenceCondition::Always {
            let companion = self.node.names.fresh(&format!("{output}_is"));
            self.node.add_output(&companion, "bool");
            self.node.add_equation(&companion, &seen.presence.text());
        }
    }

    fn reserved_name(&mut self, key: &str) -> String {
        let reserved = self.reserved.get(key).cloned();
        reserved.unwrap_or_else(|| self.node.names.fresh(key))
    }

    /// Adds a Boolean output for each result of the command. At most one is true in a cycle: `fail` results take
    /// precedence, then the first result in the text.
    pub(super) fn write_results(&mut self, results: &[ResultPort]) {
        let names: Vec<String> = results
            .iter()
            .map(|result| self.reserved_name(&result.name))
            .collect();
        for name in &names {
            self.node.add_output(name, "bool");
        }
        let is_fail = |k: &usize| results[*k].kind == ResultKind::Fail;
        let (fails, others): (Vec<usize>, Vec<usize>) = (0..results.len()).partition(is_fail);
        let mut earlier: Vec<&str> = Vec::new();
        for k in fails.into_iter().chain(others) {
            let condition = self.result_condition(&results[k]);
            let name = &names[k];
            let value = match earlier.is_empty() {
                true => condition,
                false => format!("{condition} and not ({})", earlier.join(" or ")),
            };
            self.node.add_equation(name, &value);
            earlier.push(name);
        }
    }

    /// Returns the Lustre expression that is true if the command may end with the result. A `yield` also needs a
    /// successor.
    fn result_condition(&mut self, result: &ResultPort) -> String {
        let seen = self.seen(FragmentId::ROOT, &result.condition, Scalar::Bool);
        let condition = seen.holds(AbsentPolicy::Inactive);
        if result.kind != ResultKind::Yield {
            return condition;
        }
        let covers = Role::Flow(CommandFlow::Takeover);
        let takeover = registry().iter().find(|prim| prim.desc.role == covers);
        let takeover = takeover.and_then(|prim| self.core_input(&prim.desc, result.origin.span));
        match takeover {
            Some(takeover) => format!("{condition} and {takeover}"),
            None => condition,
        }
    }
}
