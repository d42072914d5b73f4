//! Every flow is defined, and once.

use super::body::Body;
use crate::typed::{self, BlockId, FlowId, FlowRole, Place, Target, Unit};
use rpi_diag::{Code, Finding, Span};

impl Body<'_, '_> {
    /// Checks that every flow is defined, and once.
    pub(super) fn check_definitions(&mut self) {
        let mut parts = self.defined_parts();
        parts.sort_unstable_by_key(|part| (part.flow, part.at, part.span));
        let mut findings = Vec::new();
        let mut parts = parts.into_iter().peekable();
        for (id, flow) in (0..).map(FlowId).zip(&self.unit.flows) {
            let own = std::iter::from_fn(|| parts.next_if(|part| part.flow == id));
            let own: Vec<DefinedPart> = own.collect();
            let defined = matches!(flow.role, FlowRole::Output | FlowRole::Local);
            if defined && !flow.ty.has_unknown() && !self.broken.contains(&id) {
                findings.extend(definition_fault(&self.unit, flow, &own));
            }
        }
        self.findings.append(&mut findings);
        self.check_actuators();
    }

    /// A port of an actuator is defined once. That two ports of one actuator are never driven together is for the passes
    /// over the net to prove: it depends on when fragments are active.
    fn check_actuators(&mut self) {
        let mut defined: Vec<((FlowId, u32), Span)> = Vec::new();
        let targets = self
            .unit
            .blocks
            .iter()
            .flat_map(|b| &b.equations)
            .flat_map(|e| &e.targets);
        let mut findings = Vec::new();
        for target in targets {
            let Place::Port { device, port } = target.place else {
                continue;
            };
            let ports = self.unit.device(device).map(|ty| &ty.ports);
            let Some(name) = ports.and_then(|ports| Some(ports.get(port as usize)?.name.clone()))
            else {
                continue;
            };
            match defined.iter().find(|(known, _)| *known == (device, port)) {
                Some((_, first)) => findings.push(actuator_twice(&name, target.span, *first)),
                None => defined.push(((device, port), target.span)),
            }
        }
        self.findings.append(&mut findings);
    }

    fn defined_parts(&self) -> Vec<DefinedPart> {
        let mut parts = Vec::new();
        for (number, block) in (0..).zip(&self.unit.blocks) {
            let targets = block.equations.iter().flat_map(|e| &e.targets);
            let part = |target| DefinedPart::of(target, BlockId(number));
            parts.extend(targets.filter_map(part));
            let shared = block
                .automata
                .iter()
                .flat_map(|automaton| &automaton.shared);
            parts.extend(shared.map(|shared| self.whole(shared.flow, BlockId(number))));
        }
        parts
    }

    fn whole(&self, flow: FlowId, block: BlockId) -> DefinedPart {
        let count = self.unit.flow(flow).ty.leaf_count();
        DefinedPart {
            flow,
            at: 0,
            count: u32::try_from(count).unwrap_or(u32::MAX),
            span: self.unit.flow(flow).span,
            block,
        }
    }
}

/// Leaves of a flow that an equation defines.
#[derive(Clone, Copy)]
struct DefinedPart {
    flow: FlowId,
    at: u32,
    count: u32,
    span: Span,
    /// The block in which it stands.
    block: BlockId,
}

impl DefinedPart {
    fn of(target: &Target, block: BlockId) -> Option<DefinedPart> {
        let Place::Flow { flow, at } = target.place else {
            return None;
        };
        Some(DefinedPart {
            flow,
            at,
            count: u32::try_from(target.ty.leaf_count()).unwrap_or(u32::MAX),
            span: target.span,
            block,
        })
    }
}

/// What is wrong with the definitions of a flow; `parts` are sorted by place.
fn definition_fault(unit: &Unit, flow: &typed::Flow, parts: &[DefinedPart]) -> Option<Finding> {
    for pair in parts.windows(2) {
        let twice = || defined_twice(flow, pair[1].span, pair[0].span);
        if are_states(unit, pair[0].block, pair[1].block) {
            let name = &flow.name;
            let message = format!("`{name}` is defined by its parts in several states");
            return Some(Finding { message, ..twice() }.help(format!(
                "a state defines a flow of its surroundings as a whole: `{name} = ...;`"
            )));
        }
        if pair[0].at + pair[0].count > pair[1].at {
            let help = "a flow has one equation; merge the alternatives by `if` or `??`";
            return Some(twice().help(help));
        }
    }
    let defined: usize = parts.iter().map(|part| part.count as usize).sum();
    (defined < flow.ty.leaf_count()).then(|| undefined(flow, parts))
}

fn actuator_twice(port: &str, again: Span, first: Span) -> Finding {
    Finding::new(
        Code::RPI6002,
        format!("the actuator behind `{port}` is defined twice"),
    )
    .at(again, "defined again here")
    .also(first, "first defined here")
    .help("merge the alternatives into one definition by `??`")
}

fn defined_twice(flow: &typed::Flow, again: Span, first: Span) -> Finding {
    Finding::new(Code::RPI1008, format!("`{}` is defined twice", flow.name))
        .at(again, "defined again here")
        .also(first, "first defined here")
}

/// Whether two blocks are states of one automaton.
fn are_states(unit: &Unit, one: BlockId, other: BlockId) -> bool {
    let automata = unit.blocks.iter().flat_map(|block| &block.automata);
    let is_state = |automaton: &typed::Automaton, block| {
        let mut states = automaton.states.iter();
        states.any(|state| state.block == block)
    };
    let holds =
        |automaton: &typed::Automaton| is_state(automaton, one) && is_state(automaton, other);
    one != other && automata.into_iter().any(holds)
}

fn undefined(flow: &typed::Flow, parts: &[DefinedPart]) -> Finding {
    let finding = Finding::new(Code::RPI1009, format!("`{}` is never defined", flow.name));
    match parts.first() {
        None => finding
            .at(flow.span, "declared here, but no equation defines it")
            .help(format!("add an equation `{} = ...;`", flow.name)),
        Some(part) => Finding::new(
            Code::RPI1009,
            format!("a part of `{}` is never defined", flow.name),
        )
        .at(flow.span, "declared here")
        .also(part.span, "only a part of it is defined"),
    }
}
