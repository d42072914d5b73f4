//! Definitions of a block of equations, by their left sides.

use super::desugar::{previous_value, tuple_of};
use crate::ast::*;
use rpi_diag::Span;
use std::collections::{BTreeMap, BTreeSet};

/// Definitions in one block of equations (Kind 2), stored by the source text of their left sides. That text is the key
/// of a definition.
#[derive(Default)]
pub(super) struct Definitions {
    /// Keys in text order. May contain keys of removed definitions.
    pub(super) key_order: Vec<String>,
    /// Definition whose left side has the source text that is the key.
    pub(super) by_key: BTreeMap<String, Definition>,
    /// For each key, its index in `key_order`.
    pub(super) positions: BTreeMap<String, usize>,
    /// Keys of the definitions of each flow. May contain keys of removed definitions.
    pub(super) keys_by_flow: BTreeMap<Name, Vec<String>>,
}

/// Equation of a block after desugaring: the targets on its left side, its value and its source range.
#[derive(Clone)]
pub(super) struct Definition {
    pub(super) targets: Vec<Target>,
    pub(super) value: Expr,
    pub(super) span: Span,
}

impl Definitions {
    /// Inserts a definition. A new key becomes the last one in `key_order`; a definition with the same key is replaced.
    pub(super) fn insert(&mut self, key: String, definition: Definition) {
        if !self.positions.contains_key(&key) {
            self.positions.insert(key.clone(), self.key_order.len());
            self.key_order.push(key.clone());
        }
        self.insert_unordered(key, definition);
    }

    /// Inserts a definition without adding its key to `key_order`.
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

    /// Returns the definitions with the flow `name`, or a part of it, on their left side.
    pub(super) fn defining(&self, name: &Name) -> impl Iterator<Item = &Definition> {
        let sides = self.keys_by_flow.get(name).into_iter().flatten();
        sides.filter_map(|key| self.by_key.get(key))
    }

    /// Returns the value of several targets: of one definition with exactly these targets, else the tuple of their
    /// separate definitions. `None` if any target is undefined.
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

    /// Returns the definition whose only target is `target`; `None` if no definition has it as its only target.
    pub(super) fn definition_of(&self, target: &Target) -> Option<&Definition> {
        let alone =
            |d: &&Definition| matches!(&d.targets[..], [one] if is_same_target(one, target));
        self.defining(&target.name.name).find(alone)
    }

    /// Removes the definitions that have one of `targets` as their only target, and returns their values: the value
    /// itself for one target, else a tuple.
    ///
    /// A target without such a definition contributes its value in the previous cycle (`last x`).
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

    /// Returns the names of the flows on left sides with several targets: `x, y = ...`.
    pub(super) fn grouped_flows(&self) -> BTreeSet<String> {
        let groups = self.by_key.values().filter(|d| d.targets.len() > 1);
        let targets = groups.flat_map(|d| &d.targets);
        targets.map(|target| target.name.name.to_string()).collect()
    }
}

/// Returns whether two left sides denote the same flow, or the same field or element of a flow.
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
