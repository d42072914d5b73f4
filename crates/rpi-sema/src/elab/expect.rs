//! Claims of a test: published, so that whoever runs the test sees when one fails and with which values.

use super::Elab;
use super::scope::Scope;
use super::signal::Signal;
use crate::ty::Ty;
use crate::typed::{Claim, ExprId, FlowId, Kind};
use rpi_diag::Span;

/// A claim of a test.
#[derive(Clone, PartialEq, Debug)]
pub struct Expectation {
    /// The export that says whether it holds.
    pub key: String,
    /// Its label, if it has one.
    pub label: Option<String>,
    /// Where it stands.
    pub span: Span,
    /// The exports of the flows that it is about.
    pub reads: Vec<String>,
}

impl<'u> Elab<'u> {
    /// Publishes whether a claim holds and what it reads.
    pub(super) fn expectation(
        &mut self,
        scope: &mut Scope<'u>,
        claim: &'u Claim,
        condition: &Signal,
    ) {
        let key = format!("expectation {}", self.expectations.len() + 1);
        self.export(&key, condition, &Ty::Bool, claim.span);
        let mut parts = Vec::new();
        parts_of(scope, claim.condition, &mut parts);
        let reads = parts
            .iter()
            .flat_map(|part| self.published(scope, part))
            .collect();
        self.expectations.push(Expectation {
            key,
            label: claim.label.as_ref().map(ToString::to_string),
            span: claim.span,
            reads,
        });
    }

    /// Publishes the leaves of a part of a flow; gives their keys.
    fn published(&mut self, scope: &mut Scope<'u>, part: &Part) -> Vec<String> {
        let declared = scope.unit.flow(part.flow);
        let wire = self.flow(scope, part.flow, declared.span);
        let mut leaves: Vec<(String, Ty)> = Vec::new();
        let name = &declared.name;
        declared
            .ty
            .leaves(&mut |path, ty| leaves.push((format!("{name}{path}"), ty.clone())));
        let leaves = leaves.into_iter().zip(wire.iter()).skip(part.first);
        let mut keys = Vec::new();
        for ((key, ty), signal) in leaves.take(part.count) {
            if !self.net.exports.iter().any(|export| export.key == key) {
                self.export(&key, signal, &ty, declared.span);
            }
            keys.push(key);
        }
        keys
    }
}

/// Some leaves of a flow.
#[derive(PartialEq)]
struct Part {
    flow: FlowId,
    first: usize,
    count: usize,
}

/// The parts of flows that an expression names, in the order of the text, each once.
fn parts_of(scope: &Scope<'_>, id: ExprId, parts: &mut Vec<Part>) {
    match part(scope, id) {
        Some(part) if parts.contains(&part) => {}
        Some(part) => parts.push(part),
        None => {
            let kind = &scope.unit.expr(id).kind;
            kind.operands(&mut |operand| parts_of(scope, operand, parts));
        }
    }
}

/// The leaves that `flow` or `flow.part` stands for.
fn part(scope: &Scope<'_>, id: ExprId) -> Option<Part> {
    let expr = scope.unit.expr(id);
    let count = expr.ty.leaf_count();
    match expr.kind {
        Kind::Flow(flow) => Some(Part {
            flow,
            first: 0,
            count,
        }),
        Kind::Part { base, at } => part(scope, base).map(|whole| Part {
            first: whole.first + at as usize,
            count,
            ..whole
        }),
        _ => None,
    }
}
