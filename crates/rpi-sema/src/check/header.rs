//! Headers of callables: the ports, and everything else that a caller needs.

use super::Checker;
use super::body::Body;
use super::instance::{display, key};
use super::statics::{Static, Statics};
use super::types::PortTy;
use crate::hash::Set;
use crate::program::{DeclId, DeclKind, Lookup, Space};
use crate::ty::{Member, Ty};
use crate::typed::{FlowId, FlowRole, Optional, Unit, UnitKind};
use rpi_diag::{Code, Finding, Span};
use rpi_image::{Role, State};
use rpi_prims::PrimId;
use rpi_syntax::Name;
use rpi_syntax::ast::{
    CommandDecl, FragmentDecl, Ident, NodeDecl, NodeDef, NodeKind, PrimitiveDecl, Signature,
    VarDecl,
};
use std::rc::Rc;

/// Header of a callable for one choice of static arguments.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) decl: DeclId,
    pub(super) statics: Rc<Statics>,
    /// Name with the static arguments.
    pub(super) name: Name,
    pub(super) kind: UnitKind,
    pub(super) span: Span,
    /// In-ports and parameters, in the order of [`Unit::inputs`].
    pub(super) inputs: Vec<Port>,
    pub(super) outputs: Vec<Port>,
    /// Frames of the signature without a declaration; each is bound to the frame of an argument.
    pub(super) free_frames: Vec<Name>,
}

impl Header {
    /// Whether this is an instance of a generic callable, chosen by types or values.
    pub(super) fn is_instance(&self) -> bool {
        let mut statics = self.statics.values();
        statics.any(|value| matches!(value, Static::Ty(_) | Static::Value(_)))
    }

    /// Returns the type of the output, or the tuple type of several outputs.
    pub(super) fn result_type(&self) -> Ty {
        if let [one] = &self.outputs[..] {
            return one.ty.clone();
        }
        let member = |port: &Port| Member {
            name: Some(port.name.clone()),
            ty: port.ty.clone(),
        };
        Ty::Tuple(self.outputs.iter().map(member).collect())
    }
}

/// Port of a callable.
#[derive(Debug)]
pub(super) struct Port {
    pub(super) name: Name,
    pub(super) ty: Ty,
    pub(super) role: FlowRole,
    pub(super) has_default: bool,
    /// Whether the port is declared in `<<...>>`.
    pub(super) is_static: bool,
    /// Whether the port decides the clock of another port.
    pub(super) decides: bool,
    /// Port that decides the clock of this port, and the value for which this port is present.
    pub(super) clock: Option<(Name, u32)>,
    /// Whether the port is declared optional (`?`).
    pub(super) optional: bool,
    pub(super) span: Span,
}

impl<'a> Checker<'a> {
    /// Returns the header of a callable. Errors in the signature are reported once; `None` if it is not callable or
    /// nested too deeply.
    pub(super) fn header(&mut self, id: DeclId, statics: Rc<Statics>) -> Option<Rc<Header>> {
        let key = key(id, &statics);
        if let Some(header) = self.headers.get(&key) {
            return header.clone();
        }
        // Headers can nest: a default value may call a unit with default values.
        let is_inside = self.headers_open > 0;
        if is_inside && !self.may_nest("call", self.program.decl(id).span) {
            return None;
        }
        self.headers_open += 1;
        let header = self.new_header(id, statics).map(Rc::new);
        self.headers_open -= 1;
        self.headers.insert(key, header.clone());
        header
    }

    /// Returns the header of a node parameter of `id`, as far as its declaration gives it.
    pub(super) fn open_header(
        &mut self,
        id: DeclId,
        statics: &Statics,
        signature: &'a Signature,
    ) -> Header {
        let mut ports = |decls: &'a Option<Vec<VarDecl>>, role| -> Vec<Port> {
            let decls = decls.as_deref().unwrap_or_default();
            let types = self.types_in(id, statics, decls);
            let names = decls.iter().flat_map(|decl| {
                let has_default = decl.default.is_some();
                decl.names.iter().map(move |name| (name, has_default))
            });
            let ports = names.zip(types);
            ports
                .map(|((name, has_default), ty)| wanted_port(name, ty, role, has_default))
                .collect()
        };
        Header {
            inputs: ports(&signature.inputs, FlowRole::Input),
            outputs: ports(&signature.outputs, FlowRole::Output),
            decl: id,
            statics: Rc::default(),
            name: signature.name.name.clone(),
            kind: UnitKind::Node,
            span: signature.name.span,
            free_frames: Vec::new(),
        }
    }

    fn new_header(&mut self, id: DeclId, statics: Rc<Statics>) -> Option<Header> {
        let decl = self.program.decl(id);
        let (kind, span) = (kind_of(decl.kind)?, decl.span);
        let params = self.params_of(id);
        let name = display(self.program, &decl.name, &params, &statics);
        let unit = Unit::new(name.clone(), kind, span);
        let mut body = Body::new(self, id, statics.clone(), unit);
        body.declare_ports(id);
        let unit = body.leave();
        let params = params.into_iter();
        let params: Vec<Name> = params.map(|param| param.name().name.clone()).collect();
        let clocks = unit.flows.iter().filter_map(|flow| flow.clock);
        let deciding: Set<FlowId> = clocks.map(|on| on.flow).collect();
        let port = |id: &FlowId| Port {
            is_static: params.contains(&unit.flow(*id).name),
            decides: deciding.contains(id),
            ..port(&unit, *id)
        };
        let ports = |ids: &[FlowId]| ids.iter().map(port).collect();
        Some(Header {
            decl: id,
            statics,
            name,
            kind,
            span,
            inputs: ports(&unit.inputs),
            outputs: ports(&unit.outputs),
            free_frames: unit.free_frames.clone(),
        })
    }
}

/// Returns a port of a node parameter.
fn wanted_port(name: &Ident, ty: Ty, role: FlowRole, has_default: bool) -> Port {
    Port {
        name: name.name.clone(),
        ty,
        role,
        has_default,
        is_static: false,
        decides: false,
        clock: None,
        optional: false,
        span: name.span,
    }
}

/// Returns the port of a flow.
fn port(unit: &Unit, id: FlowId) -> Port {
    let flow = unit.flow(id);
    Port {
        name: flow.name.clone(),
        ty: flow.ty.clone(),
        role: flow.role,
        has_default: flow.default.is_some(),
        is_static: false,
        decides: false,
        clock: flow
            .clock
            .map(|on| (unit.flow(on.flow).name.clone(), on.value)),
        optional: flow.optional == Optional::Declared(true),
        span: flow.span,
    }
}

/// Returns the kind of unit that a declaration defines; `None` if it is not callable.
pub(super) fn kind_of(kind: DeclKind<'_>) -> Option<UnitKind> {
    Some(match kind {
        DeclKind::Node(node) => match node.kind {
            NodeKind::Node => UnitKind::Node,
            NodeKind::Function | NodeKind::Contract => UnitKind::Function,
        },
        DeclKind::Primitive(primitive) => primitive_kind(&primitive.signature.name.name),
        DeclKind::Fragment(_) => UnitKind::Fragment,
        DeclKind::Command(_) => UnitKind::Command,
        DeclKind::Test(_) => UnitKind::Test,
        DeclKind::Task(_) => UnitKind::Task,
        _ => return None,
    })
}

/// Returns the kind of a primitive: a stateless computation is a function, anything else a node.
fn primitive_kind(name: &str) -> UnitKind {
    let is_pure = |prim: PrimId| {
        let desc = prim.desc();
        desc.role == Role::Compute && matches!(desc.state, State::None)
    };
    match PrimId::of(name).is_some_and(is_pure) {
        true => UnitKind::Function,
        false => UnitKind::Node,
    }
}

impl<'a> Body<'_, 'a> {
    /// Declares the ports of a callable.
    pub(super) fn declare_ports(&mut self, id: DeclId) {
        self.in_signature = true;
        self.types_are_new(id);
        self.declare_opaque(id);
        match self.c.program.decl(id).kind {
            DeclKind::Node(node) => self.node_ports(node),
            DeclKind::Fragment(fragment) => self.fragment_ports(fragment),
            DeclKind::Primitive(primitive) => self.primitive_ports(primitive),
            DeclKind::Command(command) => self.command_ports(command),
            DeclKind::Task(task) => self.inputs(&task.params, FlowRole::Param),
            _ => {}
        }
        self.in_signature = false;
    }

    /// Reports a Lustre type parameter with the name of a type of the file.
    fn types_are_new(&mut self, id: DeclId) {
        for param in self.c.params_of(id) {
            let super::statics::Param::Type(name, _) = param else {
                continue;
            };
            let found = self
                .c
                .program
                .lookup_in(Space::Type, self.module, &name.name);
            if let Lookup::Found(first) = found
                && !self.is_rpi()
                && matches!(self.c.program.decl(first).kind, DeclKind::Type(_))
            {
                let first = self.c.program.decl(first).span;
                self.report(crate::program::twice(&name.name, name.span, first));
            }
        }
    }

    /// Declares static values that are only known at load time as flows.
    fn declare_opaque(&mut self, id: DeclId) {
        for param in self.c.params_of(id) {
            let super::statics::Param::Value(name, def) = param else {
                continue;
            };
            if !matches!(self.statics.get(&name.name), Some(Static::Opaque)) {
                continue;
            }
            let ty = match &def.ty {
                Some(ty) => self.ty(ty),
                None => self.c.static_ty(id, def, &self.statics.clone()),
            };
            let optional = false;
            let flow = self.declare_flow(name, &PortTy { ty, optional }, FlowRole::Param);
            self.unit.inputs.push(flow);
            if let Some(default) = &def.value {
                self.default_of(flow, default);
            }
        }
    }

    fn node_ports(&mut self, node: &'a NodeDecl) {
        match (&node.definition, &node.signature.outputs) {
            (NodeDef::Alias(callee), None) => self.alias_ports(callee),
            _ if node.kind == NodeKind::Contract => self.contract_ports(&node.signature),
            _ => self.signature_ports(&node.signature),
        }
    }

    fn signature_ports(&mut self, signature: &'a Signature) {
        let inputs = signature.inputs.as_deref().unwrap_or_default();
        let outputs = signature.outputs.as_deref().unwrap_or_default();
        self.inputs(inputs, FlowRole::Input);
        self.outputs(outputs);
        self.state_clocks_of(inputs);
        self.state_clocks_of(outputs);
        self.clocks_come_in();
    }

    /// Reports an in-port whose clock is an out-port: the caller must know when to pass a value.
    fn clocks_come_in(&mut self) {
        for id in self.unit.inputs.clone() {
            let port = self.unit.flow(id).clone();
            let Some(on) = port.clock.filter(|on| self.unit.outputs.contains(&on.flow)) else {
                continue;
            };
            let clock = self.unit.flow(on.flow);
            let message = format!("the clock of the in-port `{}` is an out-port", port.name);
            let finding = Finding::new(Code::RPI3007, message)
                .at(port.span, format!("sampled by `{}`", clock.name))
                .also(clock.span, "an out-port, known only after the call")
                .help("declare the clock as an in-port");
            self.report(finding);
        }
    }

    /// Declares the ports of a contract. A contract reads all of them, so that its out-ports are in-ports, too.
    fn contract_ports(&mut self, signature: &'a Signature) {
        for ports in [&signature.inputs, &signature.outputs] {
            self.inputs(ports.as_deref().unwrap_or_default(), FlowRole::Input);
        }
    }

    fn fragment_ports(&mut self, fragment: &'a FragmentDecl) {
        self.signature_ports(&fragment.signature);
        if fragment.when.is_some() {
            for id in self.unit.outputs.clone() {
                self.unit.flows[id.0 as usize].optional = Optional::Declared(true);
            }
        }
    }

    fn primitive_ports(&mut self, primitive: &'a PrimitiveDecl) {
        self.signature_ports(&primitive.signature);
    }

    fn command_ports(&mut self, command: &'a CommandDecl) {
        self.inputs(&command.params, FlowRole::Param);
        self.inputs(&command.given, FlowRole::Given);
    }

    fn inputs(&mut self, decls: &'a [VarDecl], role: FlowRole) {
        for decl in decls {
            let port = self.port_ty(&decl.ty);
            let role = if decl.is_const { FlowRole::Param } else { role };
            for name in &decl.names {
                // A constant port that decides sizes is a static parameter and has been declared.
                if decl.is_const && self.statics.contains_key(&name.name) {
                    continue;
                }
                let flow = self.declare_flow(name, &port, role);
                self.unit.inputs.push(flow);
                if let Some(default) = &decl.default {
                    self.default_of(flow, default);
                }
            }
        }
    }

    /// Checks the default value of a port.
    fn default_of(&mut self, flow: FlowId, default: &'a rpi_syntax::ast::Expr) {
        let value = self.expr(default);
        let ty = self.unit.flow(flow).ty.clone();
        let span = self.unit.flow(flow).span;
        let text = format!("`{}` is `{ty}`", self.unit.flow(flow).name);
        self.expect(value, &ty, &super::report::Wanted::By(span, text));
        self.unit.flows[flow.0 as usize].default = Some(value);
    }

    fn outputs(&mut self, decls: &'a [VarDecl]) {
        for decl in decls {
            let port = self.port_ty(&decl.ty);
            for name in &decl.names {
                let flow = self.declare_flow(name, &port, FlowRole::Output);
                self.notes_seconds(flow, &decl.ty);
                self.unit.outputs.push(flow);
            }
        }
    }
}
