//! Lowering of nodes whose primitives have code of their own.

use super::flows::{Flow, InputFlow};
use super::{Builder, Flows, InputFlows};
use crate::flat_net::{OpKind, ScopeId};
use crate::registers::{Region, Register, Registers};
use rpi_image::image::Form;
use rpi_image::operands::{Operand, OperandRole, operand_layout};
use rpi_image::{ParamType, Presence, PrimDesc, SizeArgs, StateSize, Type, Value};
use rpi_net::passes::FlowPresence;
use rpi_net::{Node, NodeId, PortRef};
use rpi_prims::PrimId;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::rc::Rc;

/// Bound of work, in elementary operations (the addition of two reals is 1), from which a primitive is skipped while
/// its inputs are absent. A primitive with less work runs even then, with old input values, and its result is marked as
/// absent.
const EXPENSIVE_WORK: u32 = 32;

/// Cache of the order and sizes of the operands of primitives, by primitive and form.
#[derive(Default)]
pub(super) struct OperandLayouts {
    by_form: FxHashMap<(PrimId, Form), Rc<[Operand]>>,
}

impl OperandLayouts {
    /// Returns the operands of a primitive in a form, in the order of an operation's words.
    fn get(&mut self, prim: PrimId, form: Form) -> Rc<[Operand]> {
        let layout = self.by_form.entry((prim, form));
        let layout = layout.or_insert_with(|| operand_layout(prim.desc(), form).into());
        Rc::clone(layout)
    }
}

impl Builder<'_> {
    pub(super) fn compute(&mut self, id: NodeId) {
        let links = self.links(id);
        let desc = self.desc(id);
        if desc.outputs.iter().all(|o| o.presence == Presence::Strict) {
            self.strict(id, &links);
        } else if is_total(id, self, &links) {
            self.total(id, &links);
        } else {
            self.optional(id, &links);
        }
    }

    pub(super) fn links(&mut self, id: NodeId) -> InputFlows {
        (0..self.desc(id).inputs.len())
            .map(|k| self.link(id, k))
            .collect()
    }

    /// Returns the scope in which a strict primitive (one that needs all inputs) runs, and the presence register of its
    /// outputs; `None` if an input is never present, so that the primitive never runs.
    ///
    /// If `is_expensive` and the inputs may be absent, a new scope is opened that is skipped while they are.
    pub(super) fn open_guard(
        &mut self,
        id: NodeId,
        links: &[InputFlow],
        is_expensive: bool,
    ) -> Option<(ScopeId, Register)> {
        let scope = self.scope_of(id);
        let connected = links.iter().filter(|l| !l.is_open);
        let present = connected.fold(Register::TRUE, |all, l| {
            self.logic.and(&mut self.flat, scope, all, l.flow.present)
        });
        match present {
            Register::FALSE => None,
            Register::TRUE => Some((scope, present)),
            _ if is_expensive => Some((self.flat.open(scope, present), present)),
            _ => Some((scope, present)),
        }
    }

    /// Closes the scope that [`Builder::open_guard`] returned for a node. Has no effect if that scope is the one of the
    /// node's fragment.
    pub(super) fn close_guard(&mut self, id: NodeId, scope: ScopeId) {
        if scope != self.scope_of(id) {
            self.flat.close(scope);
        }
    }

    fn strict(&mut self, id: NodeId, links: &[InputFlow]) {
        let desc = self.desc(id);
        let is_expensive =
            !matches!(desc.state, StateSize::None) || desc.may_fault || desc.work >= EXPENSIVE_WORK;
        let Some((scope, present)) = self.open_guard(id, links, is_expensive) else {
            return;
        };
        let outputs = self.outputs(id, present);
        self.run(id, Form::Total, scope, links, &outputs);
        self.close_guard(id, scope);
    }

    fn total(&mut self, id: NodeId, links: &[InputFlow]) {
        let outputs = self.outputs(id, Register::TRUE);
        self.run(id, Form::Total, self.scope_of(id), links, &outputs);
    }

    fn optional(&mut self, id: NodeId, links: &[InputFlow]) {
        let mut outputs = Flows::new();
        for port in ports(id, self.desc(id)) {
            let present = self.flat.registers.add(Region::Value, 1);
            let mut flow = self.output(port, present);
            outputs.push(flow);
            if self.plan.presences.own(port) == FlowPresence::Total {
                flow.present = Register::TRUE;
                self.flows.set(port, flow);
            }
        }
        self.run(id, Form::Optional, self.scope_of(id), links, &outputs);
    }

    pub(super) fn outputs(&mut self, id: NodeId, present: Register) -> Flows {
        let scope = self.scope_of(id);
        let ports = ports(id, self.desc(id));
        ports
            .map(|port| {
                let present = self.forcible_presence(scope, port, present);
                self.output(port, present)
            })
            .collect()
    }

    /// Adds the operation that calls the primitive of a node to `scope`. `links` are the flows at the in-ports,
    /// `outputs` the registers of the out-ports; the operand words have the order of [`rpi_image::operands`].
    fn run(
        &mut self,
        id: NodeId,
        form: Form,
        scope: ScopeId,
        links: &[InputFlow],
        outputs: &[Flow],
    ) {
        let node = self.net.node(id);
        let mut words: SmallVec<[u32; 12]> = SmallVec::new();
        let fields = self.layouts.get(node.prim, form);
        for field in fields.iter() {
            let (flow, ty) = match field.role {
                OperandRole::Input(k) => (links[k].flow, links[k].ty),
                OperandRole::Output(k) => (outputs[k], node.outputs[k]),
                OperandRole::Param(k) => {
                    param(&mut self.flat.registers, node.desc(), k, &node.params[k])
                }
                OperandRole::State => state(&mut self.flat.registers, node, self.options.dt()),
            };
            words.push(flow.value.0);
            words.extend_from_slice(&sizes(ty)[..field.size_words]);
            if field.has_presence {
                words.push(flow.present.0);
            }
        }
        self.flat
            .push(scope, OpKind::Run(node.prim, form), &words, id.0);
    }
}

/// Returns references to the out-ports of a node, in the order of their declaration in the primitive.
pub(super) fn ports(id: NodeId, desc: &'static PrimDesc) -> impl Iterator<Item = PortRef> {
    (0..)
        .zip(desc.outputs)
        .map(move |(port, _)| PortRef { node: id, port })
}

/// Returns the register of the constant that the parameter with index `k` of a primitive has as value, and its type. A
/// text parameter has the register for false.
fn param(registers: &mut Registers, desc: &PrimDesc, k: usize, value: &Value) -> (Flow, Type) {
    let flow = Flow::total(registers.value(value));
    let declared = match desc.params[k].ty {
        ParamType::Scalar(s) | ParamType::Array(s) => Type::Scalar(s),
        ParamType::Str => Type::Scalar(rpi_image::Scalar::Bool),
    };
    (flow, value.ty().unwrap_or(declared))
}

/// Adds a register for the state of a node, with the initial content that the primitive prescribes, and returns it.
/// `dt` is the period of the command in seconds, on which the size of the state may depend.
fn state(registers: &mut Registers, node: &Node, dt: f64) -> (Flow, Type) {
    let args = SizeArgs {
        params: &node.params,
        dt,
    };
    let cells = match node.desc().state {
        StateSize::None => 0,
        StateSize::Fixed(n) => n,
        StateSize::Computed(size) => size(&args),
    };
    let region = Region::State(node.fragment);
    let value = match node.prim.prim().init {
        None => registers.add(region, cells),
        Some(init) => {
            let mut content = vec![0; cells as usize];
            init(&args, &mut content);
            registers.add_with_initial(region, &content)
        }
    };
    (
        Flow::total(value),
        Type::Array(rpi_image::Scalar::Int, cells),
    )
}

/// Returns the size words of an operand: (length, 0) for an array, (rows, columns) for a matrix, zeros for a scalar.
fn sizes(ty: Type) -> [u32; 2] {
    match ty {
        Type::Scalar(_) => [0, 0],
        Type::Array(_, n) => [n, 0],
        Type::Matrix(rows, cols) => [rows, cols],
    }
}

/// Returns true if all inputs of a node are present in every cycle and its primitive has a variant of its code without
/// presences.
fn is_total(id: NodeId, builder: &Builder<'_>, links: &[InputFlow]) -> bool {
    let are_present = links.iter().all(|l| l.flow.present == Register::TRUE);
    are_present && builder.net.node(id).prim.prim().total.is_some()
}
