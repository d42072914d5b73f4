//! Lowering of nodes whose primitives have code of their own.

use super::links::{Flow, Link};
use super::{Builder, Flows, Links};
use crate::flat::{ScopeId, Work};
use crate::slots::{Region, Slot};
use rpi_image::image::Form;
use rpi_image::operands::Part;
use rpi_image::{ParamType, Presence, PrimDesc, SizeArgs, State, Type, Value};
use rpi_net::passes::Sureness;
use rpi_net::{NodeId, PortRef};
use smallvec::SmallVec;

/// Strict primitives with at least this much work are skipped instead of run on stale values.
const DEAR: u32 = 32;

impl Builder<'_> {
    pub(super) fn compute(&mut self, id: NodeId) {
        let links = self.links(id);
        let desc = self.desc(id);
        if desc.outputs.iter().all(|o| o.presence == Presence::Strict) {
            self.strict(id, &links);
        } else if total(id, self, &links) {
            self.sure(id, &links);
        } else {
            self.optional(id, &links);
        }
    }

    pub(super) fn links(&mut self, id: NodeId) -> Links {
        (0..self.desc(id).inputs.len())
            .map(|k| self.link(id, k))
            .collect()
    }

    /// The scope in which a strict primitive runs and the presence of its outputs; `None` if it never runs. Opens a new
    /// scope for an expensive primitive (`dear`).
    pub(super) fn guarded(
        &mut self,
        id: NodeId,
        links: &[Link],
        dear: bool,
    ) -> Option<(ScopeId, Slot)> {
        let scope = self.scope_of(id);
        let connected = links.iter().filter(|l| !l.open);
        let present = connected.fold(Slot::TRUE, |all, l| {
            self.logic.and(&mut self.flat, scope, all, l.flow.present)
        });
        match present {
            Slot::FALSE => None,
            Slot::TRUE => Some((scope, present)),
            _ if dear => Some((self.flat.open(scope, present), present)),
            _ => Some((scope, present)),
        }
    }

    /// Closes the scope opened by [`Builder::guarded`], if any.
    pub(super) fn unguard(&mut self, id: NodeId, scope: ScopeId) {
        if scope != self.scope_of(id) {
            self.flat.close(scope);
        }
    }

    fn strict(&mut self, id: NodeId, links: &[Link]) {
        let desc = self.desc(id);
        let dear = !matches!(desc.state, State::None) || desc.may_fault || desc.work >= DEAR;
        let Some((scope, present)) = self.guarded(id, links, dear) else {
            return;
        };
        let outputs = self.outputs(id, present);
        self.run(id, Form::Total, scope, links, &outputs);
        self.unguard(id, scope);
    }

    fn sure(&mut self, id: NodeId, links: &[Link]) {
        let outputs = self.outputs(id, Slot::TRUE);
        self.run(id, Form::Total, self.scope_of(id), links, &outputs);
    }

    fn optional(&mut self, id: NodeId, links: &[Link]) {
        let mut outputs = Flows::new();
        for port in ports(id, self.desc(id)) {
            let present = self.flat.slots.add(Region::Value, 1);
            let mut flow = self.output(port, present);
            outputs.push(flow);
            if self.plan.presences.own(port) == Sureness::Total {
                flow.present = Slot::TRUE;
                self.set(port, flow);
            }
        }
        self.run(id, Form::Optional, self.scope_of(id), links, &outputs);
    }

    pub(super) fn outputs(&mut self, id: NodeId, present: Slot) -> Flows {
        let scope = self.scope_of(id);
        let ports = ports(id, self.desc(id));
        ports
            .map(|port| {
                let present = self.forcible(scope, port, present);
                self.output(port, present)
            })
            .collect()
    }

    /// Adds the operation, with words as laid out by [`rpi_image::operands`].
    fn run(&mut self, id: NodeId, form: Form, scope: ScopeId, links: &[Link], outputs: &[Flow]) {
        let node = self.net.node(id);
        let mut words: SmallVec<[u32; 12]> = SmallVec::new();
        let fields = self.fields(node.prim, form);
        for field in fields.iter() {
            let (flow, ty) = match field.part {
                Part::Input(k) => (links[k].flow, links[k].ty),
                Part::Output(k) => (outputs[k], node.outputs[k]),
                Part::Param(k) => self.param(node.desc(), k, &node.params[k]),
                Part::State => self.state(id),
            };
            words.push(flow.value.0);
            words.extend_from_slice(&sizes(ty)[..field.sizes]);
            if field.presence {
                words.push(flow.present.0);
            }
        }
        self.flat
            .push(scope, Work::Run(node.prim, form), &words, id.0);
    }

    fn param(&mut self, desc: &PrimDesc, k: usize, value: &Value) -> (Flow, Type) {
        let flow = Flow {
            value: self.flat.slots.value(value),
            present: Slot::TRUE,
        };
        let declared = match desc.params[k].ty {
            ParamType::One(s) | ParamType::Array(s) => Type::One(s),
            ParamType::Str => Type::One(rpi_image::Scalar::Bool),
        };
        (flow, value.ty().unwrap_or(declared))
    }

    /// A register for the state of a node, with its initial content.
    fn state(&mut self, id: NodeId) -> (Flow, Type) {
        let node = self.net.node(id);
        let args = SizeArgs {
            params: &node.params,
            dt: self.options.dt(),
        };
        let cells = match node.desc().state {
            State::None => 0,
            State::Cells(n) => n,
            State::Sized(size) => size(&args),
        };
        let region = Region::State(node.fragment);
        let value = match node.prim.prim().init {
            None => self.flat.slots.add(region, cells),
            Some(init) => {
                let mut content = vec![0; cells as usize];
                init(&args, &mut content);
                self.flat.slots.add_with(region, &content)
            }
        };
        let flow = Flow {
            value,
            present: Slot::TRUE,
        };
        (flow, Type::Array(rpi_image::Scalar::Int, cells))
    }
}

/// The out-ports of a node.
pub(super) fn ports(id: NodeId, desc: &'static PrimDesc) -> impl Iterator<Item = PortRef> {
    (0..)
        .zip(desc.outputs)
        .map(move |(port, _)| PortRef { node: id, port })
}

/// Length word of an array, or the two shape words of a matrix.
fn sizes(ty: Type) -> [u32; 2] {
    match ty {
        Type::One(_) => [0, 0],
        Type::Array(_, n) => [n, 0],
        Type::Matrix(rows, cols) => [rows, cols],
    }
}

/// True if all inputs are certainly present and the primitive has a form without presences.
fn total(id: NodeId, builder: &Builder<'_>, links: &[Link]) -> bool {
    let there = links.iter().all(|l| l.flow.present == Slot::TRUE);
    there && builder.net.node(id).prim.prim().total.is_some()
}
