//! Sums of times declared as reals: each addition rounds, so that after thousands of cycles a limit is reached one
//! cycle too late or too early.

use crate::check::bodies::body::Body;
use crate::check::signatures::unit;
use crate::hash::Map;
use crate::typed::{Each, Kind, PrimCall};
use crate::typed::{ExprId, FlowId, Place, Unit};
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_net::prim;
use rpi_syntax::ast;

/// Maximum number of expressions examined for one flow.
const EFFORT: usize = 200;

/// Records a flow if it is declared in seconds.
pub(crate) fn record_seconds(cx: &mut Body<'_, '_>, flow: FlowId, ty: &ast::Type) {
    if cx.unit.flow(flow).ty == crate::check::types::exact_time::SECONDS
        && unit::reads_rpi_syntax(cx)
    {
        cx.times.declared_seconds.push((flow, ty.span));
    }
}

/// Warns about flows declared in seconds that add a time to their previous value.
pub(crate) fn check_time_sums(cx: &mut Body<'_, '_>) {
    if cx.times.declared_seconds.is_empty() {
        return;
    }
    let mut sums = Sums::of(&cx.unit, &cx.shared.flow_of);
    let mut findings = Vec::new();
    for (flow, declared) in &cx.times.declared_seconds {
        sums.left = EFFORT;
        let values = sums.defined.get(flow).cloned().unwrap_or_default();
        let found = values
            .iter()
            .find_map(|value| sums.adds_a_time(*flow, *value));
        findings.extend(found.map(|at| rounded(&cx.unit, *flow, *declared, at)));
    }
    cx.findings.append(&mut findings);
}

fn rounded(unit: &Unit, flow: FlowId, declared: Span, sum: ExprId) -> Finding {
    let flow = unit.flow(flow);
    let message = format!(
        "`{}` accumulates times as reals; each addition is rounded",
        flow.name
    );
    Finding::new(Code::RPI2016, message)
        .at(unit.expr(sum).span, "a time is added to the previous value")
        .also(declared, "declared in seconds")
        .help("use the type `time`, which counts whole ticks and does not round")
        .fix(Fix::maybe("declare it as `time`").replace(declared, "time"))
}

/// Defining expressions of the flows of a unit. Flows of states count as the outer flow that they define.
struct Sums<'u> {
    unit: &'u Unit,
    shares: &'u Map<FlowId, FlowId>,
    defined: Map<FlowId, Vec<ExprId>>,
    /// Number of expressions that may still be examined for the current flow.
    left: usize,
}

impl<'u> Sums<'u> {
    fn of(unit: &'u Unit, shares: &'u Map<FlowId, FlowId>) -> Self {
        let mut sums = Sums {
            unit,
            shares,
            defined: Map::default(),
            left: 0,
        };
        for equation in unit.blocks.iter().flat_map(|block| &block.equations) {
            if let [target] = &equation.targets[..]
                && let Place::Flow { flow, .. } = target.place
            {
                let flow = sums.seen(flow);
                sums.defined.entry(flow).or_default().push(equation.value);
            }
        }
        sums
    }

    fn seen(&self, flow: FlowId) -> FlowId {
        self.shares.get(&flow).copied().unwrap_or(flow)
    }

    /// Returns the sum in a value that adds a time to the previous value of the flow.
    fn adds_a_time(&mut self, flow: FlowId, value: ExprId) -> Option<ExprId> {
        let mut open = vec![value];
        while let Some(id) = open.pop() {
            self.left = self.left.checked_sub(1)?;
            match &self.unit.expr(id).kind {
                Kind::Prim(call) if self.is_sum(flow, call) => return Some(id),
                Kind::Part { base, .. } => open.push(*base),
                Kind::Each(Each::If, parts) => open.extend(parts.iter().skip(1)),
                Kind::Each(Each::Arrow | Each::Coalesce | Each::Hold, parts) => open.extend(parts),
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
        let of = |sums: &mut Self, before, time| sums.is_time(time) && sums.is_before(flow, before);
        takes && (of(self, a, b) || adds && of(self, b, a))
    }

    /// Whether a real is a converted time.
    fn is_time(&self, id: ExprId) -> bool {
        let Kind::Prim(call) = &self.unit.expr(id).kind else {
            return false;
        };
        let times = ["Core::CycleTime", "Rpi::Time", "Rpi::SecondsFromTicks"];
        times.contains(&call.prim.desc().name)
    }

    /// Whether a value is the value of a flow in an earlier cycle.
    fn is_before(&mut self, flow: FlowId, value: ExprId) -> bool {
        let mut open = vec![(value, false)];
        while let Some((id, delayed)) = open.pop() {
            let Some(left) = self.left.checked_sub(1) else {
                return false;
            };
            self.left = left;
            match &self.unit.expr(id).kind {
                Kind::Flow(read) if delayed && self.seen(*read) == flow => return true,
                Kind::Flow(read) => {
                    let values = self.defined.get(&self.seen(*read)).into_iter().flatten();
                    open.extend(values.map(|value| (*value, delayed)));
                }
                Kind::Part { base, .. } => open.push((*base, delayed)),
                Kind::Each(Each::Pre | Each::Last, parts) => {
                    open.extend(parts.iter().map(|part| (*part, true)));
                }
                Kind::Each(Each::If, parts) => {
                    open.extend(parts.iter().skip(1).map(|part| (*part, delayed)));
                }
                Kind::Each(Each::Arrow | Each::Coalesce | Each::Hold, parts) => {
                    open.extend(parts.iter().map(|part| (*part, delayed)));
                }
                _ => {}
            }
        }
        false
    }
}
