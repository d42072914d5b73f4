//! Definitions of a block of equations, by their left sides.

use super::desugar::{previous_value, tuple_of};
use crate::ast::*;
use rpi_diag::Span;
use std::collections::{BTreeMap, BTreeSet};

/// Definitions of a block, by the source text of their left sides (the keys), in text order.
#[derive(Default)]
pub(super) struct Definitions {
    /// Keys in text order.
    pub(super) key_order: Vec<String>,
    /// Equation of each key. A key names the target of the equation.
    pub(super) by_key: BTreeMap<String, Definition>,
    /// Index of each key in `order`.
    pub(super) positions: BTreeMap<String, usize>,
    /// Keys of the definitions of each flow. May contain keys of removed definitions.
    pub(super) keys_by_flow: BTreeMap<Name, Vec<String>>,
}

/// Equation that defines one key of a block after desugaring, with its left side.
#[derive(Clone)]
pub(super) struct Definition {
    pub(super) targets: Vec<Target>,
    pub(super) value: Expr,
    pub(super) span: Span,
}

impl Definitions {
    /// Inserts a definition, as the last one if its key is new.
    pub(super) fn insert(&mut self, key: String, definition: Definition) {
        if !self.positions.contains_key(&key) {
            self.positions.insert(key.clone(), self.key_order.len());
            self.key_order.push(key.clone());
        }
        self.insert_unordered(key, definition);
    }

    /// Inserts a definition without a position in the order.
    pub(super) fn insert_unordered(&mut self, key: String, definition: Definition) {
        for target in &definition.targets {
            let sides = self
                .keys_by_flow
                .entry(target.name.name.clone())
                .or_default();
            sides.push(key.clone());
        }
        self.by_key.insert(key, definition);
    }

    /// Returns the definitions with a flow in their left side.
    pub(super) fn defining(&self, name: &Name) -> impl Iterator<Item = &Definition> {
        let sides = self.keys_by_flow.get(name).into_iter().flatten();
        sides.filter_map(|key| self.by_key.get(key))
    }

    /// Returns the value of targets that are defined together or one by one.
    pub(super) fn value_of(&self, targets: &[Target]) -> Option<Expr> {
        let written = |target: &Target| self.definition_of(target);
        if let [one] = targets {
            return written(one).map(|definition| definition.value.clone());
        }
        let mut of_first = targets
            .iter()
            .take(1)
            .flat_map(|t| self.defining(&t.name.name));
        if let Some(whole) = of_first.find(|d| are_same_targets(&d.targets, targets)) {
            return Some(whole.value.clone());
        }
        let values: Option<Vec<Expr>> = targets
            .iter()
            .map(|t| Some(written(t)?.value.clone()))
            .collect();
        let values = values?;
        let span = values.first().map_or(Span::NONE, |value| value.span);
        let kind = ExprKind::Tuple(values.into());
        Some(Expr { kind, span })
    }

    /// Returns the definition of one target alone.
    pub(super) fn definition_of(&self, target: &Target) -> Option<&Definition> {
        let alone =
            |d: &&Definition| matches!(&d.targets[..], [one] if is_same_target(one, target));
        self.defining(&target.name.name).find(alone)
    }

    /// Removes the single definitions of targets that no definition groups, and returns their values as one.
    ///
    /// A target without a definition keeps its previous value.
    pub(super) fn take_values(&mut self, targets: &[Target]) -> Expr {
        let mut values = Vec::with_capacity(targets.len());
        for target in targets {
            let is_alone = |key: &&String| {
                let definition = self.by_key.get(*key);
                definition
                    .is_some_and(|d| matches!(&d.targets[..], [one] if is_same_target(one, target)))
            };
            let mut sides = self
                .keys_by_flow
                .get(&target.name.name)
                .into_iter()
                .flatten();
            let key = sides.find(is_alone).cloned();
            let definition = key.and_then(|key| self.by_key.remove(&key));
            values.push(definition.map_or_else(|| previous_value(target), |d| d.value));
        }
        match values.len() {
            1 => values.remove(0),
            _ => tuple_of(targets, values),
        }
    }

    /// Returns the flows that are defined together with others in one definition.
    pub(super) fn grouped_flows(&self) -> BTreeSet<String> {
        let groups = self.by_key.values().filter(|d| d.targets.len() > 1);
        let targets = groups.flat_map(|d| &d.targets);
        targets.map(|target| target.name.name.to_string()).collect()
    }
}

/// Returns whether two targets are the same flow or the same part of a flow.
fn is_same_target(a: &Target, b: &Target) -> bool {
    let step = |(a, b): (&Access, &Access)| match (a, b) {
        (Access::Field(a), Access::Field(b)) => a.name == b.name,
        (Access::Index(a), Access::Index(b)) => a.unparen().kind == b.unparen().kind,
        _ => false,
    };
    a.name.name == b.name.name
        && a.path.len() == b.path.len()
        && a.path.iter().zip(&b.path).all(step)
}

fn are_same_targets(a: &[Target], b: &[Target]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same_target(a, b))
}
