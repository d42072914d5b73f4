//! Sums of times declared as reals: each addition rounds, so that after thousands of cycles a limit is reached one
//! cycle too late or too early.

use crate::check::bodies::body::Body;
use crate::check::signatures::unit;
use crate::hash::FastMap;
use crate::typed::{ElementwiseOp, PrimCall, TypedKind};
use crate::typed::{ExprId, FlowId, TargetPlace, Unit};
use rpi_diag::{Code, Diagnostic, Fix, Span};
use rpi_net::prim;
use rpi_syntax::ast;

/// Maximum number of expressions examined for one flow in the search for sums of times.
const MAX_EXPRS: usize = 200;

/// Records a flow if it is declared in seconds or in per cent.
pub(crate) fn record_unit(cx: &mut Body<'_, '_>, flow: FlowId, ty: &ast::Type) {
    if cx.unit.flow(flow).ty == crate::ty::machine_types::SECONDS && unit::reads_rpi_syntax(cx) {
        cx.times.declared_seconds.push((flow, ty.span));
    }
    if matches!(&ty.kind, ast::TypeKind::Real(Some(unit)) if unit.is_percent()) {
        cx.inference.per_cent_flows.insert(flow);
    }
}

/// Warns about flows declared in seconds that add an exact time to their previous value, because rounding errors
/// accumulate.
pub(crate) fn check_time_sums(cx: &mut Body<'_, '_>) {
    if cx.times.declared_seconds.is_empty() {
        return;
    }
    let mut sums = TimeSums::new(&cx.unit, &cx.shared.flow_of);
    let mut diagnostics = Vec::new();
    for (flow, declared) in &cx.times.declared_seconds {
        sums.budget = MAX_EXPRS;
        let values = sums.defined.get(flow).cloned().unwrap_or_default();
        let found = values
            .iter()
            .find_map(|value| sums.find_time_sum(*flow, *value));
        diagnostics.extend(found.map(|at| rounding_warning(&cx.unit, *flow, *declared, at)));
    }
    cx.diagnostics.append(&mut diagnostics);
}

fn rounding_warning(unit: &Unit, flow: FlowId, declared: Span, sum: ExprId) -> Diagnostic {
    let flow = unit.flow(flow);
    let message = format!(
        "`{}` accumulates times as reals; each addition is rounded",
        flow.name
    );
    Diagnostic::new(Code::RPI2016, message)
        .primary(unit.expr(sum).span, "a time is added to the previous value")
        .secondary(declared, "declared in seconds")
        .help("use the type `time`, which counts whole ticks and does not round")
        .fix(Fix::maybe("declare it as `time`").replace(declared, "time"))
}

/// Search, in the definitions of flows of a unit, for sums of an exact time and the previous value of the flow. A flow
/// local to a state counts as the flow outside of the automaton that it defines.
struct TimeSums<'u> {
    unit: &'u Unit,
    shared_flow_of: &'u FastMap<FlowId, FlowId>,
    defined: FastMap<FlowId, Vec<ExprId>>,
    /// Number of expressions that may still be examined for the current flow.
    budget: usize,
}

impl<'u> TimeSums<'u> {
    fn new(unit: &'u Unit, shares: &'u FastMap<FlowId, FlowId>) -> Self {
        let mut sums = TimeSums {
            unit,
            shared_flow_of: shares,
            defined: FastMap::default(),
            budget: 0,
        };
        for equation in unit.blocks.iter().flat_map(|block| &block.equations) {
            if let [target] = &equation.targets[..]
                && let TargetPlace::Flow { flow, .. } = target.place
            {
                let flow = sums.outer_flow(flow);
                sums.defined.entry(flow).or_default().push(equation.value);
            }
        }
        sums
    }

    fn outer_flow(&self, flow: FlowId) -> FlowId {
        self.shared_flow_of.get(&flow).copied().unwrap_or(flow)
    }

    /// Returns the sum within `value` that adds an exact time to the previous value of the flow; `None` if there is
    /// none.
    fn find_time_sum(&mut self, flow: FlowId, value: ExprId) -> Option<ExprId> {
        let mut open = vec![value];
        while let Some(id) = open.pop() {
            self.budget = self.budget.checked_sub(1)?;
            match &self.unit.expr(id).kind {
                TypedKind::Prim(call) if self.is_sum(flow, call) => return Some(id),
                TypedKind::Part { base, .. } => open.push(*base),
                TypedKind::Each(ElementwiseOp::If, parts) => open.extend(parts.iter().skip(1)),
                TypedKind::Each(
                    ElementwiseOp::Arrow | ElementwiseOp::Coalesce | ElementwiseOp::Hold,
                    parts,
                ) => open.extend(parts),
                _ => {}
            }
        }
        None
    }

    fn is_sum(&mut self, flow: FlowId, call: &PrimCall) -> bool {
        let [Some(a), Some(b)] = call.inputs[..] else {
            return false;
        };
        let adds = call.prim == prim!("Core::DoubleAdd");
        let takes = adds || call.prim == prim!("Rpi::DoubleSubtract");
        let of = |sums: &mut Self, before, time| {
            sums.is_time(time) && sums.is_previous_value(flow, before)
        };
        takes && (of(self, a, b) || adds && of(self, b, a))
    }

    /// Whether an expression in seconds is an exact time that was converted to seconds.
    fn is_time(&self, id: ExprId) -> bool {
        let TypedKind::Prim(call) = &self.unit.expr(id).kind else {
            return false;
        };
        let times = ["Core::CycleTime", "Rpi::Time", "Rpi::SecondsFromTicks"];
        times.contains(&call.prim.desc().name)
    }

    /// Whether an expression is the value of the flow in an earlier cycle.
    fn is_previous_value(&mut self, flow: FlowId, value: ExprId) -> bool {
        let mut open = vec![(value, false)];
        while let Some((id, delayed)) = open.pop() {
            let Some(left) = self.budget.checked_sub(1) else {
                return false;
            };
            self.budget = left;
            match &self.unit.expr(id).kind {
                TypedKind::Flow(read) if delayed && self.outer_flow(*read) == flow => {
                    return true;
                }
                TypedKind::Flow(read) => {
                    let values = self
                        .defined
                        .get(&self.outer_flow(*read))
                        .into_iter()
                        .flatten();
                    open.extend(values.map(|value| (*value, delayed)));
                }
                TypedKind::Part { base, .. } => open.push((*base, delayed)),
                TypedKind::Each(ElementwiseOp::Pre | ElementwiseOp::Last, parts) => {
                    open.extend(parts.iter().map(|part| (*part, true)));
                }
                TypedKind::Each(ElementwiseOp::If, parts) => {
                    open.extend(parts.iter().skip(1).map(|part| (*part, delayed)));
                }
                TypedKind::Each(
                    ElementwiseOp::Arrow | ElementwiseOp::Coalesce | ElementwiseOp::Hold,
                    parts,
                ) => {
                    open.extend(parts.iter().map(|part| (*part, delayed)));
                }
                _ => {}
            }
        }
        false
    }
}
