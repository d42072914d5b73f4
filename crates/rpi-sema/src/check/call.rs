//! Calls: resolution of the callee, static arguments, activation, and instantiation of the called unit.

use super::Constant;
use super::args::Given;
use super::body::Body;
use super::callable::{Callable, Fixed};
use super::header::Header;
use super::locals::Local;
use super::report::not_a;
use super::special::{SPECIALS, Special};
use super::statics::{Param, Static, Statics};
use super::unit::is_callable;
use crate::elab::NotConstant;
use crate::program::{DeclId, DeclKind, Lookup, Space};
use crate::ty::{Subst, Ty};
use crate::typed::{
    self, Activation, Equation, ExprId, FlowRole, Kind, Optional, Place, Target, UnitKind,
};
use rpi_diag::{Code, Finding, Span};
use rpi_prims::{PrimId, registry};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, NodeDef, StaticArg};
use std::rc::Rc;

/// Call whose arguments match the ports of the callee.
pub(super) struct Fitted {
    /// Header of the called instance.
    pub(super) header: Rc<Header>,
    /// Argument of each in-port; `None` for a port that uses its default.
    pub(super) args: Vec<Option<ExprId>>,
    /// Types and frames inferred for the free names of the signature.
    subst: Subst,
}

/// Meaning of the name of a callee.
enum Callee<'a> {
    /// Callable with all its static arguments: a node parameter or an operator.
    Known(Callable),
    /// Declaration.
    Decl(DeclId),
    /// Predeclared operator with its own checks.
    Special(Special),
    /// Registered primitive.
    Prim(PrimId),
    /// Iterator over arrays, by name.
    Iterator(&'static str),
    /// Alternative of a `datatype`: its type and index.
    Constructor(DeclId, u32),
    /// Not callable, which has been reported.
    Nothing(std::marker::PhantomData<&'a ()>),
}

impl<'a> Body<'_, 'a> {
    /// Checks a call.
    pub(super) fn call(&mut self, call: &'a ast::Call, span: Span) -> ExprId {
        let activation = self.activation(&call.activation);
        self.call_activated(call, activation, span)
    }

    /// Checks a call with a given activation.
    pub(super) fn call_activated(
        &mut self,
        call: &'a ast::Call,
        activation: Activation,
        span: Span,
    ) -> ExprId {
        let name = &call.callee.name;
        match self.callee(&name.name, name.span) {
            Callee::Nothing(_) => {
                let given = self.given(&call.args);
                self.meant_elsewhere(call, &given, span);
                self.meant_as_struct(call, span)
            }
            Callee::Special(special) => self.special(special, call, span),
            Callee::Iterator("condact") if call.callee.statics.is_empty() => {
                self.special(Special::Condact, call, span)
            }
            Callee::Iterator("condact") => self.condact_of(call, span),
            Callee::Iterator(name) if call.callee.statics.is_empty() => {
                self.bare_iterator(name, call, span)
            }
            Callee::Iterator(name) => {
                match self.iteration(name, &call.callee.statics, call.callee.span) {
                    Some(iteration) => {
                        let given = self.given(&call.args);
                        self.apply(
                            &Callable::Iteration(Rc::new(iteration)),
                            given,
                            activation,
                            span,
                        )
                    }
                    None => {
                        self.given(&call.args);
                        self.fault(span)
                    }
                }
            }
            Callee::Known(callable) => {
                let given = self.given(&call.args);
                self.apply(&callable, given, activation, span)
            }
            Callee::Prim(prim) => self.registered(prim, call, span),
            Callee::Constructor(ty, index) => {
                let given = self.given(&call.args);
                let values: Vec<ExprId> = given.iter().map(|arg| arg.value).collect();
                self.construct((ty, index), &call.callee.statics, &values, span)
            }
            Callee::Decl(id) => self.call_decl(id, call, activation, span),
        }
    }

    /// Checks a call of a declaration. A call of an alias (`node f = g<<3>>;`) is a call of its target.
    fn call_decl(
        &mut self,
        id: DeclId,
        call: &'a ast::Call,
        activation: Activation,
        span: Span,
    ) -> ExprId {
        self.is_looked_into(call, id, span);
        if let DeclKind::Node(node) = self.c.program.decl(id).kind
            && let NodeDef::Alias(callee) = &node.definition
        {
            let given = self.given(&call.args);
            return match self.alias(id, callee, &call.callee.statics) {
                Some(callable) => self.apply(&callable, given, activation, span),
                None => self.fault(span),
            };
        }
        let mut bound = self.bind(id, &call.callee.statics);
        let args = self.bind_sizes(id, &call.args, &mut bound);
        let (mut given, all_named) = self.given_to(id, &args);
        given.extend(bound.ports);
        if bound.faulty || !all_named {
            return self.fault(span);
        }
        self.apply_unit(id, bound.statics, given, activation, span)
    }

    /// Returns the callable that an alias stands for. The alias may have static parameters.
    fn alias(
        &mut self,
        id: DeclId,
        callee: &'a ast::Callee,
        statics: &'a [StaticArg],
    ) -> Option<Callable> {
        let bound = self.bind(id, statics);
        if bound.faulty {
            return None;
        }
        if self.c.is_ring_of_names(id) || !self.c.may_stand_for(callee.span) {
            return None;
        }
        self.compare_ports(id, &bound.statics);
        self.c.aliases.push(id);
        let mut body = Body::around(self.c, id);
        body.statics = Rc::new(bound.statics);
        let callable = body.callable(&callee.name.name, &callee.statics, callee.span);
        let callable = callable.and_then(|callable| body.leaves_the_body(callable));
        body.leave();
        self.c.aliases.pop();
        callable
    }

    /// Checks the unit of an alias with static parameters and declared ports, so that ports that differ from those of
    /// its target are reported.
    fn compare_ports(&mut self, id: DeclId, statics: &Statics) {
        let DeclKind::Node(node) = self.c.program.decl(id).kind else {
            return;
        };
        let params = self.c.params_of(id);
        let is_given = |param: &super::statics::Param<'_>| statics.contains_key(&param.name().name);
        if node.signature.outputs.is_none() || params.is_empty() || !params.iter().all(is_given) {
            return;
        }
        if let Some(header) = self.c.header(id, Rc::new(statics.clone())) {
            self.c.unit(&header, header.span);
        }
    }

    /// Checks the conditions of an activation.
    fn activation(&mut self, activation: &'a ast::Activation) -> Activation {
        match activation {
            ast::Activation::Always => Activation::Always,
            ast::Activation::Restart { every } => Activation::Restart {
                every: self.condition(every, "a restart"),
            },
            ast::Activation::Activate {
                every,
                restart,
                default,
            } => Activation::Condact {
                every: self.condition(every, "an activation"),
                default: default.as_ref().map(|default| self.held_before(default)),
                restart: restart
                    .as_ref()
                    .map(|restart| self.condition(restart, "a restart")),
            },
        }
    }

    /// Resolves the name of a callee.
    fn callee(&mut self, name: &Name, span: Span) -> Callee<'a> {
        let importing = std::mem::take(&mut self.importing);
        if let Some(Static::Callee(callable, misfit)) = self.statics.get(name).cloned() {
            if let Some(misfit) = misfit {
                self.report((*misfit).clone());
                return Callee::Nothing(std::marker::PhantomData);
            }
            return Callee::Known(callable);
        }
        if let Lookup::Found(id) = self.c.program.lookup_in(Space::Value, self.module, name)
            && let DeclKind::Constructor { ty, index } = self.c.program.decl(id).kind
        {
            return Callee::Constructor(ty, index);
        }
        if let Lookup::Found(id) = self.c.program.lookup_in(Space::Value, self.module, name)
            && let DeclKind::EnumValue { ty, index } = self.c.program.decl(id).kind
            && self.is_datatype(ty)
        {
            return Callee::Constructor(ty, index);
        }
        let space = match importing {
            true => Space::Contract,
            false => Space::Callable,
        };
        match self.c.program.lookup_in(space, self.module, name) {
            Lookup::Found(id) => self.callee_decl(id, name, span),
            Lookup::Missing => self.callee_predeclared(name, span),
        }
    }

    /// Resolves a declaration as a callee; reports one that is not callable.
    fn callee_decl(&mut self, id: DeclId, name: &Name, span: Span) -> Callee<'a> {
        let decl = self.c.program.decl(id).clone();
        if is_callable(decl.kind) {
            return Callee::Decl(id);
        }
        if !matches!(decl.kind, DeclKind::Broken(_)) {
            let finding = not_a("a callable", name, decl.kind.what(), span, decl.span);
            let finding = match decl.kind {
                DeclKind::Command(_) => finding.help("run a command by a task, or by `rpi run`"),
                _ => finding,
            };
            self.report(finding);
        }
        Callee::Nothing(std::marker::PhantomData)
    }

    /// Resolves an iterator, a predeclared operator or a primitive; reports an undefined name.
    fn callee_predeclared(&mut self, name: &Name, span: Span) -> Callee<'a> {
        let plain = name.strip_prefix("Lustre::").unwrap_or(name);
        if let Some(iterator) = super::iterate::NAMES
            .iter()
            .find(|iterator| **iterator == plain)
        {
            return Callee::Iterator(iterator);
        }
        let specials = SPECIALS.iter();
        let is_kind2 =
            |s: &&Special| matches!(s, Special::Any | Special::Choose | Special::Machine(_));
        let is_ours = |s: &&Special| matches!(s, Special::Spatial(_) | Special::Time);
        let is_rpi = self.is_rpi();
        let mut specials = specials.filter(|s| match is_rpi {
            true => !is_kind2(s),
            false => !is_ours(s),
        });
        if let Some(special) = specials.find(|special| special.name() == plain) {
            return Callee::Special(*special);
        }
        if let Some(operator) = super::predef::operator(name) {
            return Callee::Known(operator);
        }
        if let Some(prim) = PrimId::of(name) {
            return Callee::Prim(prim);
        }
        self.unknown_callee(name, span);
        Callee::Nothing(std::marker::PhantomData)
    }

    /// Reports an undefined callee, with a suggestion.
    fn unknown_callee(&mut self, name: &Name, span: Span) {
        if let Some(Local::Flow(flow)) = self.find_local(name) {
            let declared = self.unit.flow(flow).span;
            let finding = not_a("a callable", name, "a flow", span, declared).help(format!(
                "read an array element by `{name}[0]`; write a product as `{name} * x`"
            ));
            return self.report(finding);
        }
        let callable = |id: DeclId| is_callable(self.c.program.decl(id).kind);
        let near = self
            .c
            .suggest(name, self.c.program.visible(self.module, callable));
        // `time` is not suggested: it is also the name of a predeclared flow, which is more likely to be meant.
        let specials = SPECIALS.iter().map(|special| special.name());
        let specials = specials.filter(|special| *special != "time");
        let near = near.or_else(|| rpi_diag::suggest(name, specials));
        let near = near.or_else(|| match name.is_qualified() {
            true => self
                .c
                .suggest(name, registry().iter().map(|prim| prim.desc.name)),
            false => None,
        });
        let what = if name.is_qualified() {
            "primitive"
        } else {
            "node, function or fragment"
        };
        let last = name.rsplit("::").next().unwrap_or_default();
        let is_there = |other: &str| {
            let mut visible = self.c.program.visible(self.module, callable);
            visible.any(|known| known == other) || SPECIALS.iter().any(|s| s.name() == other)
        };
        let here = match name.is_qualified() && is_there(last) {
            true => Some(last),
            false => super::foreign::call_here(name),
        };
        match here {
            Some(here) => self.other_name(what, name, span, here),
            None => self.unknown_name(what, name, span, near),
        }
    }

    /// Resolves a callable with its static arguments, for an iterator or as a static argument.
    pub(super) fn callable(
        &mut self,
        name: &Name,
        statics: &'a [StaticArg],
        span: Span,
    ) -> Option<Callable> {
        match self.callee(name, span) {
            Callee::Nothing(_) => None,
            Callee::Constructor(..) => {
                let finding = not_a(
                    "a callable",
                    name,
                    "an alternative of a datatype",
                    span,
                    span,
                );
                self.report(finding);
                None
            }
            Callee::Known(callable) => Some(callable),
            Callee::Special(special) => Some(Callable::Special(special)),
            Callee::Prim(prim) => Some(Callable::Prim(prim)),
            Callee::Iterator(iterator) => {
                let iteration = self.iteration(iterator, statics, span)?;
                Some(Callable::Iteration(Rc::new(iteration)))
            }
            Callee::Decl(id) => {
                if let DeclKind::Node(node) = self.c.program.decl(id).kind
                    && let NodeDef::Alias(callee) = &node.definition
                {
                    return self.alias(id, callee, statics);
                }
                let bound = self.bind(id, statics);
                let fixed = self.fixed_ports(&bound.ports)?;
                (!bound.faulty).then(|| Callable::Unit(id, Rc::new(bound.statics), fixed))
            }
        }
    }

    /// Returns the values of the ports that static arguments fix.
    fn fixed_ports(&mut self, ports: &[Given<'a>]) -> Option<Rc<[(Name, Fixed)]>> {
        let mut fixed = Vec::new();
        for port in ports {
            let value = match self.try_fold(port.value) {
                Err(NotConstant::Flow(_)) if self.is_fixed(port.value) => Fixed::Loaded(port.value),
                _ => Fixed::Constant(Constant {
                    leaves: self.fold(port.value)?,
                    ty: self.ty_of(port.value).clone(),
                }),
            };
            fixed.push((port.name?.name.clone(), value));
        }
        Some(fixed.into())
    }

    /// Rejects a callable with values that are only known in this body; returns `None` after the error.
    pub(super) fn leaves_the_body(&mut self, callable: Callable) -> Option<Callable> {
        match callable.loaded() {
            None => Some(callable),
            Some(value) => {
                self.fold(value);
                None
            }
        }
    }

    /// Calls a callable with checked arguments.
    pub(super) fn apply(
        &mut self,
        callable: &Callable,
        given: Vec<Given<'a>>,
        activation: Activation,
        span: Span,
    ) -> ExprId {
        match callable {
            Callable::Unit(id, statics, fixed) => {
                self.apply_fixed(*id, statics, fixed, given, activation, span)
            }
            Callable::Prim(prim) => self.registered_plain(*prim, &given, span),
            Callable::Op(op) => self.apply_op(*op, &given, span),
            Callable::Predef(predef) => self.apply_predef(predef, given, span),
            Callable::Special(special) => self.apply_special(*special, &given, span),
            Callable::Iteration(iteration) => self.iterate(iteration, &given, span),
            Callable::Open(header) => self.apply_open(header, given, span),
        }
    }

    /// Calls a declaration with the values of its fixed ports added to the arguments.
    fn apply_fixed(
        &mut self,
        id: DeclId,
        statics: &Rc<Statics>,
        fixed: &Rc<[(Name, Fixed)]>,
        mut given: Vec<Given<'a>>,
        activation: Activation,
        span: Span,
    ) -> ExprId {
        let params = self.c.params_of(id);
        for (name, fixed) in &**fixed {
            let value = match fixed {
                Fixed::Constant(constant) => self.constant_expr(constant, span),
                Fixed::Loaded(value) => *value,
            };
            let param = params.iter().map(Param::name).find(|p| p.name == *name);
            let port = || self.c.port_names(id).find(|port| port.name == *name);
            given.push(Given {
                name: param.or_else(port),
                value,
                is_static: true,
            });
        }
        self.apply_unit(id, (**statics).clone(), given, activation, span)
    }

    /// Calls a declaration with checked arguments.
    fn apply_unit(
        &mut self,
        id: DeclId,
        statics: Statics,
        given: Vec<Given<'a>>,
        activation: Activation,
        span: Span,
    ) -> ExprId {
        match self.fitted(id, statics, given, span) {
            Ok(fitted) => self.call_unit(fitted, activation, span),
            // The type is kept, so that the uses of the outputs are still checked.
            Err(ty) => self.add(Kind::Fault, ty, span),
        }
    }

    /// Matches arguments with the ports of a declaration and infers its open static parameters.
    ///
    /// Returns the type of the result, as far as it is known, after an error.
    pub(super) fn fitted(
        &mut self,
        id: DeclId,
        mut statics: Statics,
        mut given: Vec<Given<'a>>,
        span: Span,
    ) -> Result<Fitted, Ty> {
        if self.is_rpi() {
            given = self.spread_tuples(given);
        }
        if !self.bind_sizes_of_arguments(id, &given, &mut statics) {
            return Err(Ty::Unknown);
        }
        let open = self.c.complete(id, &mut statics);
        if self.c.lacks_sizes(id, &open, &statics, span) {
            // Not reported beside a misspelt argument: that may be the one the size depends on.
            if !self.report_strangers(id, &given) {
                self.report_missing(id, &open, span);
            }
            return Err(Ty::Unknown);
        }
        if !self.satisfies(id, &statics, span) {
            return Err(Ty::Unknown);
        }
        let header = self.c.header(id, Rc::new(statics.clone()));
        let header = header.ok_or(Ty::Unknown)?;
        let free = header.free_frames.iter();
        let mut subst = Subst {
            frames: free.map(|frame| (frame.clone(), None)).collect(),
            ..Subst::default()
        };
        let Some(mut args) = self.match_ports(&header, &given, span) else {
            return Err(match open.is_empty() {
                true => header.result_type().substituted(&subst),
                false => Ty::Unknown,
            });
        };
        let mut sound = self.fit_args(&header, &mut args, &mut subst);
        let of_units = header.inputs.iter().any(|port| port.ty.has_unknown());
        let told = args.iter().flatten();
        let all_told = told.copied().all(|arg| !self.ty_of(arg).has_unknown());
        let told_at = all_told.then_some(span);
        let header = self.instance(&header, statics, &open, &subst, (span, told_at));
        let header = header.ok_or(Ty::Unknown)?;
        // Units that depend on static parameters are known only in the instance, so that the types are checked again.
        sound = sound && (!of_units || self.fit_args(&header, &mut args, &mut subst));
        match sound {
            true => Ok(Fitted {
                header,
                args,
                subst,
            }),
            false => Err(header.result_type().substituted(&subst)),
        }
    }

    /// Adds the call of an instance.
    fn call_unit(&mut self, fitted: Fitted, activation: Activation, span: Span) -> ExprId {
        let Fitted {
            ref header,
            args,
            ref subst,
        } = fitted;
        if header.kind != UnitKind::Function {
            self.has_state(span);
        }
        self.not_extern(header, span);
        let Some(unit) = self.c.unit(header, span) else {
            return self.fault(span);
        };
        let args = self.named_clocks(header, args);
        let ty = header.result_type().substituted(subst);
        if let Activation::Condact {
            default: Some(default),
            ..
        } = activation
        {
            self.expect(default, &ty, &super::report::Wanted::Here);
        }
        let args = args.into();
        let call = typed::Call {
            unit,
            args,
            activation,
        };
        self.add(Kind::Call(Box::new(call)), ty, span)
    }

    /// Gives each argument that decides the clock of another port a flow of its own, as clocks refer to flows by name.
    fn named_clocks(
        &mut self,
        header: &Header,
        mut args: Vec<Option<ExprId>>,
    ) -> Vec<Option<ExprId>> {
        if self.inferring {
            return args;
        }
        let deciding = header.inputs.iter().zip(&mut args);
        for (port, arg) in deciding.filter(|(port, _)| port.decides) {
            let unnamed = |id: &ExprId| !matches!(self.unit.expr(*id).kind, Kind::Flow(_));
            if let Some(value) = arg.filter(unnamed) {
                *arg = Some(self.named(port, value));
            }
        }
        args
    }

    /// Adds a flow with the value of an expression, named after the port with a unique suffix.
    fn named(&mut self, port: &super::header::Port, value: ExprId) -> ExprId {
        let (span, ty) = (self.span_of(value), self.ty_of(value).clone());
        let name = ast::Ident {
            name: format!("{}#{}", port.name, self.unit.flows.len()).into(),
            span,
        };
        let flow = self.add_flow(&name, ty.clone(), Optional::Inferred, FlowRole::Local);
        let place = Place::Flow { flow, at: 0 };
        let equation = Equation {
            targets: vec![Target { place, ty, span }],
            value,
            span,
        };
        self.current().equations.push(equation);
        self.flow_expr(flow, span)
    }

    /// Reports a call of a node without a body.
    fn not_extern(&mut self, header: &Header, span: Span) {
        if let DeclKind::Node(node) = self.c.program.decl(header.decl).kind
            && matches!(node.definition, NodeDef::Extern)
        {
            let finding = Finding::new(Code::RPI1012, format!("`{}` has no body", header.name))
                .at(span, "an external node cannot be executed")
                .also(header.span, "declared without a body");
            self.report(finding);
        }
    }
}
