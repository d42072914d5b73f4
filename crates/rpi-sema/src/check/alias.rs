//! Another name for a callable, `node f = g<<3>>;`, as a unit of its own: it is run by itself, or named where a unit is
//! needed. Calls of it are calls of what it stands for.

use super::args::Given;
use super::body::Body;
use super::call::Callable;
use super::header::Port;
use super::types::PortTy;
use crate::typed::{Activation, Equation, FlowId, FlowRole, Place, Target};
use rpi_syntax::Name;
use rpi_syntax::ast::{Callee, Ident};
use std::rc::Rc;

impl<'a> Body<'_, 'a> {
    /// The ports of what the name stands for, as far as nothing fixes them.
    pub(super) fn alias_ports(&mut self, callee: &'a Callee) {
        let callable = self.callable(&callee.name.name, &callee.statics, callee.span);
        let Some(Callable::Unit(id, statics, fixed)) = callable else {
            return;
        };
        let mut statics = (*statics).clone();
        let open = self.c.complete(id, &mut statics);
        let is_fixed = |name: &Name| fixed.iter().any(|(fixed, _)| fixed == name);
        if open.iter().any(|name| !is_fixed(name)) {
            return;
        }
        let Some(header) = self.c.header(id, Rc::new(statics)) else {
            return;
        };
        let given = header.inputs.iter().filter(|port| !is_fixed(&port.name));
        for port in given {
            let flow = self.declare_like(port, FlowRole::Input);
            self.unit.inputs.push(flow);
        }
        for port in &header.outputs {
            let flow = self.declare_like(port, FlowRole::Output);
            self.unit.outputs.push(flow);
        }
    }

    fn declare_like(&mut self, port: &Port, role: FlowRole) -> FlowId {
        let name = Ident {
            name: port.name.clone(),
            span: port.span,
        };
        let ty = PortTy {
            ty: port.ty.clone(),
            optional: false,
        };
        self.declare_flow(&name, &ty, role)
    }

    /// One call, from all in-ports to all out-ports.
    pub(super) fn check_alias(&mut self, callee: &'a Callee) {
        let span = callee.span;
        let callable = self.callable(&callee.name.name, &callee.statics, span);
        let Some(callable) = callable.filter(|_| !self.unit.outputs.is_empty()) else {
            return;
        };
        let args = self.unit.inputs.clone().into_iter();
        let given = args.map(|flow| Given::plain(self.flow_expr(flow, span)));
        let given = given.collect();
        let value = self.apply(&callable, given, Activation::Always, span);
        let targets = self.unit.outputs.iter().map(|id| Target {
            place: Place::Flow { flow: *id, at: 0 },
            ty: self.unit.flow(*id).ty.clone(),
            span,
        });
        let equation = Equation {
            targets: targets.collect(),
            value,
            span,
        };
        self.current().equations.push(equation);
    }
}
