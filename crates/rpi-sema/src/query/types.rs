//! Types and presence at positions in the source, from the checked units.
//!
//! A declaration that is checked for several choices of static arguments may have several types at one position.

use crate::facts::Facts;
use crate::ty::Ty;
use crate::typed::Expr;
use crate::typed::{ExprId, Flow, FlowId, FlowPresence, Unit};
use rpi_diag::{FileId, Span};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Type of a flow or expression, with whether it may be absent.
#[derive(Clone, PartialEq, Debug)]
pub struct FlowType {
    /// Type of the values while they are present.
    pub ty: Ty,
    /// Whether the value may be absent in some cycles.
    pub optional: bool,
}

impl std::fmt::Display for FlowType {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", self.ty, if self.optional { "?" } else { "" })
    }
}

/// Returns the types of all flows, by the location of the flow's name in its declaration. A flow of a generic node may
/// have several types, one for each instance.
#[must_use]
pub fn flow_types(units: &[Rc<Unit>], facts: &[Rc<Facts>]) -> BTreeMap<Span, Vec<FlowType>> {
    let mut types: BTreeMap<Span, Vec<FlowType>> = BTreeMap::new();
    for (unit, facts) in units.iter().zip(facts) {
        for (id, flow) in (0..).map(FlowId).zip(&unit.flows) {
            if !flow.ty.has_unknown() {
                push_distinct(
                    types.entry(flow.span).or_default(),
                    flow_type(flow, id, facts),
                );
            }
        }
    }
    types
}

fn flow_type(flow: &Flow, id: FlowId, facts: &Facts) -> FlowType {
    let optional = match flow.optional {
        FlowPresence::Declared(optional) => optional,
        FlowPresence::Inferred => facts.flow_absence(id).any(),
    };
    FlowType {
        ty: flow.ty.clone(),
        optional,
    }
}

/// Returns the types of a name at a location where it is read, which are those of the smallest expression that ends
/// with the name. Several instances of a node may give several types. A flow of a fragment is always present inside of
/// the fragment and may be absent outside of it.
#[must_use]
pub fn read_types(units: &[Rc<Unit>], facts: &[Rc<Facts>], name: Span) -> Vec<FlowType> {
    let ends = |e: &Expr| {
        let span = e.span;
        span.file == name.file && span.start <= name.start && span.end == name.end
    };
    let exprs = units.iter().flat_map(|unit| &unit.exprs);
    let found = exprs.filter(|e| ends(e)).map(|e| e.span);
    let smallest = found.min_by_key(|span| span.end - span.start);
    smallest.map_or_else(Vec::new, |span| types_of_span(units, facts, span))
}

/// Returns the span of the smallest expression around a position, given as a byte offset, and its types. Several
/// instances of a node may give several types. `None` if there is no expression.
#[must_use]
pub fn type_at(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    file: FileId,
    offset: u32,
) -> Option<(Span, Vec<FlowType>)> {
    let holds = |e: &Expr| e.span.file == file && e.span.start <= offset && offset < e.span.end;
    let known = |e: &Expr| !e.ty.has_unknown();
    let exprs = units.iter().flat_map(|unit| &unit.exprs);
    let around = exprs.filter(|e| holds(e) && known(e)).map(|e| e.span);
    let smallest = around.min_by_key(|span| span.end - span.start)?;
    Some((smallest, types_of_span(units, facts, smallest)))
}

/// Returns the types of the outermost expression with exactly this span. Several instances of a node may give several
/// types.
fn types_of_span(units: &[Rc<Unit>], facts: &[Rc<Facts>], span: Span) -> Vec<FlowType> {
    let mut types = Vec::new();
    for (unit, facts) in units.iter().zip(facts) {
        let all = (0..).map(ExprId).zip(&unit.exprs);
        // Operands precede their expressions in the table, so the last match is the outermost.
        let last = all.filter(|(_, e)| e.span == span && !e.ty.has_unknown());
        if let Some((id, expr)) = last.last() {
            let optional = facts.absence(id).any();
            let ty = expr.ty.clone();
            push_distinct(&mut types, FlowType { ty, optional });
        }
    }
    types
}

fn push_distinct(types: &mut Vec<FlowType>, one: FlowType) {
    if !types.contains(&one) {
        types.push(one);
    }
}
