//! Check that every flow and actuator port is defined exactly once.

use crate::check::bodies::automaton;
use crate::check::bodies::body::Body;
use crate::typed::{
    self, Block, BlockId, FlowId, FlowPresence, SharedFlow, Target, TargetPlace, Unit,
};
use rpi_diag::{Code, Diagnostic, Span};

/// Reports flows of the body that are not defined, not completely defined, or defined more than once.
pub(crate) fn check_definitions(cx: &mut Body<'_, '_>) {
    let mut parts = defined_parts(cx);
    parts.sort_unstable_by_key(|part| (part.flow, part.at, part.span));
    let mut diagnostics = Vec::new();
    let mut parts = parts.into_iter().peekable();
    for (id, flow) in (0..).map(FlowId).zip(&cx.unit.flows) {
        let own = std::iter::from_fn(|| parts.next_if(|part| part.flow == id));
        let own: Vec<DefinedPart> = own.collect();
        if flow.role.has_equation()
            && !flow.ty.has_unknown()
            && !cx.reported.erroneous_flows.contains(&id)
        {
            diagnostics.extend(definition_error(&cx.unit, id, &own));
        }
    }
    cx.diagnostics.append(&mut diagnostics);
    check_actuator_definitions(cx);
}

/// Reports actuator ports that are defined twice. Conflicts between different ports of one actuator depend on when
/// fragments are active; they are checked after elaboration to a net.
fn check_actuator_definitions(cx: &mut Body<'_, '_>) {
    let mut defined: Vec<((FlowId, u32), Span, BlockId)> = Vec::new();
    let blocks = (0..).map(BlockId).zip(&cx.unit.blocks);
    let equations = blocks.flat_map(|(id, block)| block.equations.iter().map(move |e| (id, e)));
    let targets = equations.flat_map(|(id, e)| e.targets.iter().map(move |t| (id, t)));
    let mut diagnostics = Vec::new();
    for (block, target) in targets {
        let TargetPlace::Port { device, port } = target.place else {
            continue;
        };
        let ports = cx.unit.device_type_instance(device).map(|ty| &ty.ports);
        let Some(name) = ports.and_then(|ports| Some(ports.get(port as usize)?.name.clone()))
        else {
            continue;
        };
        let before = defined.iter().find(|known| known.0 == (device, port));
        match before {
            Some((_, first, other)) => {
                let help = match automaton::is_state(cx, block) && automaton::is_state(cx, *other) {
                    true => {
                        "define one flow in all states, and define the port by that flow outside of the automaton"
                    }
                    false => {
                        "delete one of them, or choose between the two values in one equation: `if ... then ... else ...`"
                    }
                };
                diagnostics
                    .push(duplicate_actuator_definition(&name, target.span, *first).help(help));
            }
            None => defined.push(((device, port), target.span, block)),
        }
    }
    cx.diagnostics.append(&mut diagnostics);
}

/// Returns all parts of flows that equations or automata define.
fn defined_parts(cx: &Body<'_, '_>) -> Vec<DefinedPart> {
    let mut parts = Vec::new();
    for block in &cx.unit.blocks {
        let targets = block.equations.iter().flat_map(|e| &e.targets);
        parts.extend(targets.filter_map(DefinedPart::from_target));
        let shared = block
            .automata
            .iter()
            .flat_map(|automaton| &automaton.shared);
        parts.extend(shared.map(|shared| automaton_part(cx, shared)));
    }
    parts
}

/// Returns the definition of a flow by the states of an automaton. The location is that of the first state that defines
/// the flow.
fn automaton_part(cx: &Body<'_, '_>, shared: &SharedFlow) -> DefinedPart {
    let count = cx.unit.flow(shared.flow).ty.leaf_count();
    let first = shared.states.first().unwrap_or(&shared.flow);
    DefinedPart {
        flow: shared.flow,
        at: 0,
        count: u32::try_from(count).unwrap_or(u32::MAX),
        span: cx.unit.flow(*first).span,
        by_automaton: true,
    }
}

/// Part of a flow that an equation or an automaton defines: `count` leaves (scalar parts) from leaf `at` on.
#[derive(Clone, Copy)]
struct DefinedPart {
    flow: FlowId,
    at: u32,
    count: u32,
    span: Span,
    /// Whether the states of an automaton define the part, and not a single equation.
    by_automaton: bool,
}

impl DefinedPart {
    /// Returns the part of a flow that a target of an equation defines; `None` if the target is not a flow but, for
    /// example, an actuator port.
    fn from_target(target: &Target) -> Option<DefinedPart> {
        let TargetPlace::Flow { flow, at } = target.place else {
            return None;
        };
        Some(DefinedPart {
            flow,
            at,
            count: u32::try_from(target.ty.leaf_count()).unwrap_or(u32::MAX),
            span: target.span,
            by_automaton: false,
        })
    }
}

/// Returns the diagnostic for a flow that is defined twice or not completely; `None` if the definition is correct.
/// `parts` are the defined parts of this flow, sorted by `at`.
fn definition_error(unit: &Unit, id: FlowId, parts: &[DefinedPart]) -> Option<Diagnostic> {
    let flow = unit.flow(id);
    for pair in parts.windows(2) {
        if pair[0].at + pair[0].count > pair[1].at {
            let help = match pair[0].by_automaton && pair[1].by_automaton {
                true => {
                    "states of several automata define it; declare it in the state by `var` if it is local to the state"
                }
                false => {
                    "delete one of them, or choose between the two values in one equation: `if ... then ... else ...`"
                }
            };
            return Some(duplicate_definition(flow, pair[1].span, pair[0].span).help(help));
        }
    }
    let defined: usize = parts.iter().map(|part| part.count as usize).sum();
    (defined < flow.ty.leaf_count()).then(|| undefined_flow(unit, id, parts))
}

fn duplicate_actuator_definition(port: &str, again: Span, first: Span) -> Diagnostic {
    Diagnostic::new(
        Code::RPI6002,
        format!("the actuator port `{port}` is defined twice"),
    )
    .primary(again, "defined again here")
    .secondary(first, "first defined here")
}

fn duplicate_definition(flow: &typed::Flow, again: Span, first: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI1008, format!("`{}` is defined twice", flow.name))
        .primary(again, "defined again here")
        .secondary(first, "first defined here")
}

/// Returns a flow of an inline fragment that has the same name as the undefined flow `id` outside of the fragment, with
/// the fragment's block. The equation of the inner flow was probably meant for the outer flow.
fn shadowing_flow(unit: &Unit, id: FlowId) -> Option<(&typed::Flow, &Block)> {
    let flow = unit.flow(id);
    let alike = unit.flows.iter().filter(|other| other.name == flow.name);
    let mut inside = alike.map(|other| (other, unit.block(other.block)));
    inside.find(|(_, block)| block.when.is_some() && block.parent == Some(flow.block))
}

/// Returns the diagnostic for a flow without a definition, or with a definition of some of its leaves only. `parts` are
/// the defined parts.
fn undefined_flow(unit: &Unit, id: FlowId, parts: &[DefinedPart]) -> Diagnostic {
    let flow = unit.flow(id);
    let diagnostic = Diagnostic::new(Code::RPI1009, format!("`{}` is never defined", flow.name));
    match parts.first() {
        None if let Some((own, block)) = shadowing_flow(unit, id) => {
            let otherwise = match flow.optional {
                FlowPresence::Declared(false) => " ?? ...",
                _ => "",
            };
            diagnostic
                .primary(flow.span, "no equation defines it")
                .secondary(
                    own.span,
                    format!(
                        "local flow of the fragment `{}`, absent while it is inactive",
                        block.name
                    ),
                )
                .help(format!(
                    "use the fragment's flow: `{0} = {1}.{0}{otherwise};`",
                    flow.name, block.name
                ))
        }
        None => diagnostic
            .primary(flow.span, "no equation defines it")
            .help(format!("add an equation `{} = ...;`", flow.name)),
        Some(part) => Diagnostic::new(
            Code::RPI1009,
            format!("a part of `{}` is never defined", flow.name),
        )
        .primary(flow.span, "declared here")
        .secondary(part.span, "only a part of it is defined"),
    }
}
