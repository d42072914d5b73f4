//! Actions of the grammar: build declarations, statements, contracts and steps.
//!
//! In the methods, `l` and `r` are the byte offsets of the beginning and end of the node.

use crate::ast::*;
use crate::context::ParseContext;
use crate::{Dialect, validation};
use rpi_diag::Span;

/// Returns the list with one more element.
pub(crate) fn with_element<T>(mut list: Vec<T>, element: T) -> Vec<T> {
    list.push(element);
    list
}

/// Returns the list with more elements.
pub(crate) fn with_elements<T>(mut list: Vec<T>, more: impl IntoIterator<Item = T>) -> Vec<T> {
    list.extend(more);
    list
}

/// Builds a section of a device: the ports after `actuator`, `sensor` or `status`.
///
/// A doc comment before the keyword belongs to the first port.
pub(crate) fn device_section(
    cx: &ParseContext<'_>,
    kind: PortKind,
    mut ports: Vec<DevicePort>,
    start: u32,
    end: u32,
) -> DeviceSection {
    let first = ports.first_mut();
    if let Some(first) = first.and_then(|port| port.alternatives.first_mut()) {
        first.doc = first.doc.take().or_else(|| cx.doc(start));
    }
    DeviceSection {
        kind,
        ports,
        span: cx.span(start, end),
    }
}

pub(crate) fn signature(
    name: Ident,
    statics: Vec<StaticParam>,
    inputs: Option<Vec<VarDecl>>,
    outputs: Option<Vec<VarDecl>>,
) -> Signature {
    Signature {
        name,
        statics,
        inputs,
        outputs,
    }
}

pub(crate) fn node(
    modifier: Modifier,
    kind: NodeKind,
    signature: Signature,
    contract: Option<Box<Contract>>,
    definition: NodeDef,
    outside: ExternalForm,
) -> Box<NodeDecl> {
    let sizes = crate::size_ports::size_params(&signature, &definition);
    Box::new(NodeDecl {
        kind,
        size_params: sizes,
        modifier,
        signature,
        contract: contract.map(|c| *c),
        definition,
        external_form: outside,
    })
}

/// Sets the clock of all variables without a clock: `(x: int; y: int) when c`.
pub(crate) fn with_clock(mut vars: Vec<VarDecl>, clock: Clock) -> Vec<VarDecl> {
    for var in &mut vars {
        var.clock.get_or_insert_with(|| clock.clone());
    }
    vars
}

/// Returns the inverse of a unit factor, as after `/`.
pub(crate) fn inverse(factor: UnitFactor) -> UnitFactor {
    UnitFactor {
        power: -factor.power,
        ..factor
    }
}

pub(crate) fn dotted(dotted: Dotted, name: Ident) -> Dotted {
    Dotted {
        span: dotted.span.merge(name.span),
        parts: with_element(dotted.parts, name),
    }
}

pub(crate) fn equation(targets: Vec<Target>, value: Expr) -> StatementKind {
    StatementKind::Equation(Box::new(Equation { targets, value }))
}

pub(crate) fn call(callee: Callee, activation: Activation, args: Vec<Arg>) -> Box<Call> {
    Box::new(Call {
        callee,
        activation,
        args,
    })
}

pub(crate) fn activate(
    every: Expr,
    (default, restart): (Option<Expr>, Option<Expr>),
) -> Activation {
    Activation::Activate {
        every,
        restart,
        default,
    }
}

pub(crate) fn run(
    label: Option<Ident>,
    callee: Callee,
    args: Vec<Arg>,
    branches: Vec<Branch>,
) -> Box<StepKind> {
    Box::new(StepKind::Run(Box::new(Run {
        label,
        callee,
        args,
        branches,
    })))
}

/// Part of a contract, before the parts are sorted by kind.
pub(crate) enum ContractPart {
    Locals(Locals),
    GhostTuple(GhostTuple),
    Claim(Box<Claim>),
    Mode(ContractMode),
    Import(ContractImport),
    Broken,
}

/// Builds ghost variables of a contract. Several names with one value, `var x, y: int = e;`, share one equation.
pub(crate) fn ghost_vars(mut vars: Vec<VarDecl>) -> ContractPart {
    let value = match &mut vars[..] {
        [one] if one.names.len() > 1 => one.default.take(),
        _ => None,
    };
    match value {
        Some(value) => ghost_tuple_from_vars(vars, value),
        None => ContractPart::Locals(Locals::Var(vars)),
    }
}

/// Builds ghost variables of different types with one value: `var x: int, y: bool = e;`.
pub(crate) fn ghost_tuple(first: Box<VarDecl>, rest: Vec<VarDecl>, value: Expr) -> ContractPart {
    ghost_tuple_from_vars(with_elements(vec![*first], rest), value)
}

fn ghost_tuple_from_vars(vars: Vec<VarDecl>, value: Expr) -> ContractPart {
    let names = vars.iter().flat_map(|var| &var.names);
    let targets = names.map(|name| Target {
        name: name.clone(),
        path: Vec::new(),
        span: name.span,
    });
    let equation = Equation {
        targets: targets.collect(),
        value,
    };
    let first = vars.first().map_or(Span::NONE, |var| var.span);
    let span = first.merge(equation.value.span);
    ContractPart::GhostTuple(GhostTuple {
        vars,
        equation,
        span,
    })
}

pub(crate) fn claim(
    kind: ClaimKind,
    label: Option<Ident>,
    condition: Expr,
    provided: Option<Expr>,
) -> Box<Claim> {
    Box::new(Claim {
        kind,
        label,
        condition,
        provided,
    })
}

/// Returns the empty body of a `contract` declaration.
pub(crate) fn contract_body() -> NodeDef {
    let (locals, statements) = (Vec::new(), Vec::new());
    NodeDef::Body(Body { locals, statements })
}

pub(crate) fn mode(name: Ident, parts: Vec<Claim>) -> ContractMode {
    let (requires, ensures) = parts
        .into_iter()
        .partition(|claim| claim.kind == ClaimKind::Assume);
    ContractMode {
        name,
        requires,
        ensures,
    }
}

impl ParseContext<'_> {
    pub(crate) fn item(&self, l: u32, kind: ItemKind, r: u32) -> Item {
        Item {
            doc: self.doc(l),
            kind,
            span: self.span(l, r),
        }
    }

    pub(crate) fn const_def(
        &self,
        l: u32,
        names: Vec<Ident>,
        ty: Option<Type>,
        value: Option<Expr>,
        r: u32,
    ) -> Box<ConstDef> {
        Box::new(ConstDef {
            doc: self.doc(l),
            names,
            ty,
            value,
            span: self.span(l, r),
        })
    }

    pub(crate) fn generic_type(
        &self,
        l: u32,
        name: Ident,
        statics: Vec<StaticParam>,
        ty: Type,
        r: u32,
    ) -> Box<TypeDef> {
        let mut def = self.type_def(l, name, Some(ty), r);
        def.statics = statics;
        def
    }

    pub(crate) fn type_def(&self, l: u32, name: Ident, ty: Option<Type>, r: u32) -> Box<TypeDef> {
        Box::new(TypeDef {
            doc: self.doc(l),
            name,
            statics: Vec::new(),
            ty,
            span: self.span(l, r),
        })
    }

    pub(crate) fn broken_type_def(&self, l: u32, r: u32) -> Box<TypeDef> {
        let span = self.span(l, r);
        let name = self.error_names(l).into_iter().next();
        let name = name.unwrap_or_else(|| self.placeholder_name(span));
        self.type_def(l, name, Some(broken_type(span)), r)
    }

    pub(crate) fn static_param(&self, l: u32, kind: StaticParamKind, r: u32) -> Box<StaticParam> {
        Box::new(StaticParam {
            doc: self.doc(l),
            kind,
            span: self.span(l, r),
        })
    }

    pub(crate) fn var_decl(
        &self,
        l: u32,
        names: Vec<Ident>,
        ty: Type,
        clock: Option<Box<Clock>>,
        default: Option<Expr>,
        r: u32,
    ) -> Box<VarDecl> {
        Box::new(VarDecl {
            doc: self.doc(l),
            is_const: false,
            names,
            ty,
            clock: clock.map(|clock| *clock),
            default,
            span: self.span(l, r),
        })
    }

    /// Builds a declaration with a condition of Kind 2: `x: int | x > 0`, short for `x: subtype { x: int | x > 0 }`.
    pub(crate) fn refined_decl(
        &self,
        l: u32,
        names: Vec<Ident>,
        base: Type,
        condition: Expr,
        r: u32,
    ) -> Box<VarDecl> {
        let Some(name) = names.first().cloned() else {
            return self.var_decl(l, names, base, None, None, r);
        };
        if self.dialect != Dialect::Lustre {
            self.report(validation::unsupported_condition(condition.span));
            return self.var_decl(l, names, base, None, None, r);
        }
        let span = base.span.merge(condition.span);
        let refined = RefinementType {
            name,
            base,
            condition,
        };
        let kind = TypeKind::Refinement(Box::new(refined));
        self.var_decl(l, names, Type { kind, span }, None, None, r)
    }

    pub(crate) fn const_port(&self, l: u32, names: Vec<Ident>, ty: Type, r: u32) -> Box<VarDecl> {
        let mut port = self.var_decl(l, names, ty, None, None, r);
        port.is_const = true;
        port
    }

    /// Builds a constant definition from a broken phrase, without a known type or value.
    pub(crate) fn broken_const_def(&self, l: u32, r: u32) -> Box<ConstDef> {
        let ty = broken_type(self.span(l, r));
        self.const_def(l, self.error_names(l), Some(ty), None, r)
    }

    pub(crate) fn broken_var_decl(&self, l: u32, r: u32) -> Box<VarDecl> {
        let ty = broken_type(self.span(l, r));
        self.var_decl(l, self.error_names(l), ty, None, None, r)
    }

    pub(crate) fn clock(&self, l: u32, tick: ClockValue, flow: Ident, r: u32) -> Box<Clock> {
        let span = self.span(l, r);
        Box::new(Clock {
            value: tick,
            flow,
            span,
        })
    }

    pub(crate) fn contract(&self, l: u32, parts: Vec<ContractPart>, r: u32) -> Box<Contract> {
        let mut contract = Contract {
            locals: Vec::new(),
            ghost_tuples: Vec::new(),
            claims: Vec::new(),
            modes: Vec::new(),
            imports: Vec::new(),
            span: self.span(l, r),
        };
        for part in parts {
            match part {
                ContractPart::Locals(locals) => contract.locals.push(locals),
                ContractPart::GhostTuple(together) => contract.ghost_tuples.push(together),
                ContractPart::Claim(claim) => contract.claims.push(*claim),
                ContractPart::Mode(mode) => contract.modes.push(mode),
                ContractPart::Import(import) => contract.imports.push(import),
                ContractPart::Broken => {}
            }
        }
        Box::new(contract)
    }

    pub(crate) fn import(
        &self,
        l: u32,
        callee: Callee,
        inputs: Vec<Arg>,
        outputs: Vec<Arg>,
        r: u32,
    ) -> ContractPart {
        let count = inputs.len();
        let args = with_elements(inputs, outputs);
        let call = call(callee, Activation::Always, args);
        ContractPart::Import(ContractImport {
            call: self.call(l, call, r),
            input_count: count,
        })
    }

    pub(crate) fn statement(&self, l: u32, kind: StatementKind, r: u32) -> Statement {
        let span = match kind {
            StatementKind::Fragment(_) | StatementKind::Automaton(_) => self.span_to_token(l, r),
            _ => self.span(l, r),
        };
        Statement {
            doc: self.doc(l),
            kind,
            span,
        }
    }

    pub(crate) fn extend_target(&self, mut target: Target, access: Access, r: u32) -> Target {
        target.path.push(access);
        target.span.end = r;
        target
    }

    #[allow(
        clippy::too_many_arguments,
        reason = "one argument per part of the production"
    )]
    pub(crate) fn state(
        &self,
        l: u32,
        initial: bool,
        name: Ident,
        unless: Vec<Transition>,
        body: Option<Box<Body>>,
        until: Vec<Transition>,
        r: u32,
    ) -> Box<State> {
        Box::new(State {
            doc: self.doc(l),
            is_initial: initial,
            name,
            unless,
            body: body.map_or_else(Body::default, |body| *body),
            until,
            span: self.span_to_token(l, r),
        })
    }

    pub(crate) fn transition(
        &self,
        l: u32,
        condition: Option<Expr>,
        resumes: bool,
        target: Ident,
        r: u32,
    ) -> Box<Transition> {
        Box::new(Transition {
            condition,
            resumes,
            target,
            span: self.span(l, r),
        })
    }

    pub(crate) fn step(&self, l: u32, kind: StepKind, r: u32) -> Box<Step> {
        Box::new(Step {
            doc: self.doc(l),
            kind,
            span: self.span_to_token(l, r),
        })
    }

    pub(crate) fn branch(&self, l: u32, on: Vec<Ident>, then: Ident, r: u32) -> Box<Branch> {
        Box::new(Branch {
            results: on.into_iter().map(on_result).collect(),
            next: next(then),
            span: self.span(l, r),
        })
    }

    /// Returns the placeholder name `_` for a node without a name, whose error has been reported.
    fn placeholder_name(&self, span: Span) -> Ident {
        Ident {
            name: self.intern("_"),
            span,
        }
    }
}

fn broken_type(span: Span) -> Type {
    Type {
        kind: TypeKind::Error,
        span,
    }
}

fn on_result(word: Ident) -> ResultPattern {
    match word.name.as_str() {
        "fail" => ResultPattern::Fail(word.span),
        "any" => ResultPattern::Any(word.span),
        _ => ResultPattern::Named(word),
    }
}

fn next(word: Ident) -> NextStep {
    match word.name.as_str() {
        "end" => NextStep::End(word.span),
        _ => NextStep::Step(word),
    }
}
