//! Definitions at the top level of a file, with their parameters and ports.

use super::bodies;
use crate::program::Source;
use crate::query::build::{
    Body, Builder, DefId, DefKind, DefPosition, Ident, PendingRef, ScopeId, ShapeOrigin,
};
use rpi_syntax::ast::{
    Claim, CommandDecl, ConstDef, Contract, DeclaredKind, DeviceDecl, EnumValue, FragmentDecl,
    FrameDecl, Item, ItemKind, Locals, NodeDecl, NodeDef, NodeKind, Signature, StaticParam,
    StaticParamKind, Step, StepKind, TaskDecl, TestDecl, TypeDef, TypeKind, VarDecl,
};

pub(super) fn index_items<'a>(builder: &mut Builder<'a>, source: &Source<'a>, scope: ScopeId) {
    for file in &source.files {
        builder.mode = file.dialect;
        for item in &file.items {
            index_item(builder, scope, item);
        }
    }
}

fn index_item<'a>(builder: &mut Builder<'a>, scope: ScopeId, item: &'a Item) {
    builder.omits_body = (builder.focus).is_some_and(|focus| !item.span.contains(focus));
    let at = DefPosition {
        scope,
        whole: item.span,
        doc: item.doc.as_ref(),
    };
    match &item.kind {
        ItemKind::Use(names) => names
            .iter()
            .for_each(|name| builder.defer(scope, PendingRef::Module(name))),
        ItemKind::Include(_) => {}
        ItemKind::Const(defs) => defs.iter().for_each(|def| constant(builder, at, def)),
        ItemKind::Type(defs) => defs.iter().for_each(|def| type_def(builder, at, def)),
        ItemKind::Node(node) => index_node(builder, at, node),
        ItemKind::Fragment(fragment) => index_fragment(builder, at, fragment),
        ItemKind::Primitive(primitive) => {
            callable(builder, at, DefKind::Primitive, &primitive.signature);
            builder.exprs(scope, &primitive.budget);
        }
        ItemKind::Device(device) => index_device(builder, at, device),
        ItemKind::Frame(frame) => index_frame(builder, at, frame),
        ItemKind::Command(command) => index_command(builder, at, command),
        ItemKind::Task(task) => index_task(builder, at, task),
        ItemKind::Test(test) => index_test(builder, at, test),
        ItemKind::Error(names) => {
            for declared in names {
                builder.define(at, &declared.name, broken_kind(declared.kind));
            }
        }
    }
}

fn index_command<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, command: &'a CommandDecl) {
    let (kind, name) = (DefKind::Command, &command.name);
    let (def, body) = define_with_params(builder, at, kind, name, &command.statics);
    let results = builder.inner(at, def);
    builder.index.inner_scopes[def.0 as usize].members = Some(results);
    index_vars(builder, body, &command.params, DefKind::Param);
    index_vars(builder, body, &command.given, DefKind::TakenOver);
    builder.exprs(body, &command.budget);
    index_contract(builder, body, command.contract.as_ref());
    bodies::index_body(builder, body, &command.body);
    let scope = results;
    index_results(builder, DefPosition { scope, ..at }, &command.body);
}

fn index_test<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, test: &'a TestDecl) {
    let def = builder.define(at, &test.title, DefKind::Test);
    let scope = builder.inner(at, def);
    let body = builder.inner(at, def);
    if !builder.omits_body {
        bodies::index_body(builder, body, &test.body);
    }
    index_results(builder, DefPosition { scope, ..at }, &test.body);
}

pub(super) fn constant<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, def: &'a ConstDef) {
    constants(
        builder,
        at.with_span(def.span, def.doc.as_ref()),
        def,
        DefKind::Const,
    );
}

fn constants<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, def: &'a ConstDef, kind: DefKind) {
    for name in &def.names {
        let id = builder.define(at, name, kind);
        match (&def.ty, &def.value) {
            (Some(ty), _) => builder.set_type(id, at.scope, ty),
            (None, Some(value)) => builder.shapes.set(id, at.scope, ShapeOrigin::Value(value)),
            (None, None) => {}
        }
    }
    if let Some(ty) = &def.ty {
        builder.defer(at.scope, PendingRef::Type(ty));
    }
    builder.exprs(at.scope, &def.value);
}

fn enum_value<'a>(builder: &mut Builder<'a>, of_type: DefPosition<'a>, value: &'a EnumValue) {
    // The doc comment of the type does not apply to its values.
    let at = DefPosition {
        whole: value.name.span,
        doc: value.doc.as_ref(),
        ..of_type
    };
    builder.define(at, &value.name, DefKind::EnumValue);
}

fn type_def<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, def: &'a TypeDef) {
    let at = at.with_span(def.span, def.doc.as_ref());
    let id = builder.define(at, &def.name, DefKind::Type);
    let Some(ty) = &def.ty else {
        return;
    };
    match &ty.kind {
        TypeKind::Enum(values) => {
            for value in values {
                enum_value(builder, at, value);
            }
        }
        TypeKind::Struct(fields) => {
            let scope = builder.inner(at, id);
            builder.index.inner_scopes[id.0 as usize].members = Some(scope);
            index_vars(builder, scope, fields, DefKind::Field);
        }
        _ => {
            builder.set_type(id, at.scope, ty);
            builder.defer(at.scope, PendingRef::Type(ty));
        }
    }
}

fn index_node<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, node: &'a NodeDecl) {
    let kind = match node.kind {
        NodeKind::Node | NodeKind::Contract => DefKind::Node,
        NodeKind::Function => DefKind::Function,
    };
    let (def, scope) = callable(builder, at, kind, &node.signature);
    index_contract(builder, scope, node.contract.as_ref());
    match &node.definition {
        NodeDef::Body(_) if builder.omits_body => {}
        NodeDef::Body(body) => bodies::index_body(builder, scope, body),
        NodeDef::Alias(callee) => {
            builder
                .shapes
                .set(def, at.scope, ShapeOrigin::Alias(callee));
            builder.defer(scope, PendingRef::Callee(callee));
        }
        NodeDef::Extern => {}
    }
}

fn index_fragment<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, fragment: &'a FragmentDecl) {
    let (_, scope) = callable(builder, at, DefKind::Fragment, &fragment.signature);
    let when = fragment.when.iter().map(|when| &when.condition);
    builder.exprs(scope, when.chain(&fragment.budget));
    index_contract(builder, scope, fragment.contract.as_ref());
    bodies::index_body(builder, scope, &fragment.body);
}

/// Adds definitions for a callable, its static parameters and its ports. Returns the definition and its inner scope.
fn callable<'a>(
    builder: &mut Builder<'a>,
    at: DefPosition<'a>,
    kind: DefKind,
    of: &'a Signature,
) -> (DefId, ScopeId) {
    let (def, scope) = define_with_params(builder, at, kind, &of.name, &of.statics);
    builder.index.inner_scopes[def.0 as usize].members = Some(scope);
    index_vars(
        builder,
        scope,
        of.inputs.as_deref().unwrap_or_default(),
        DefKind::Input,
    );
    index_vars(
        builder,
        scope,
        of.outputs.as_deref().unwrap_or_default(),
        DefKind::Output,
    );
    (def, scope)
}

/// Adds definitions for a declaration and its static parameters. Returns the definition and its inner scope.
fn define_with_params<'a>(
    builder: &mut Builder<'a>,
    at: DefPosition<'a>,
    kind: DefKind,
    name: &'a Ident,
    statics: &'a [StaticParam],
) -> (DefId, ScopeId) {
    let def = builder.define(at, name, kind);
    let scope = builder.inner(at, def);
    builder.index.inner_scopes[def.0 as usize].parameters = Some(scope);
    let at = DefPosition { scope, ..at };
    statics
        .iter()
        .for_each(|param| static_param(builder, at, param));
    (def, scope)
}

fn static_param<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, param: &'a StaticParam) {
    let at = DefPosition {
        whole: param.span,
        doc: param.doc.as_ref(),
        ..at
    };
    match &param.kind {
        StaticParamKind::Type(name, _) => {
            builder.define(at, name, DefKind::StaticParam);
        }
        StaticParamKind::Value(def) => constants(builder, at, def, DefKind::StaticParam),
        StaticParamKind::Node(_, signature) => {
            let def = builder.define(at, &signature.name, DefKind::StaticParam);
            let scope = builder.inner(at, def);
            let ports = [&signature.inputs, &signature.outputs];
            for port in ports.into_iter().flatten().flatten() {
                builder.defer(scope, PendingRef::Type(&port.ty));
            }
        }
    }
}

fn index_device<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, device: &'a DeviceDecl) {
    let (def, scope) =
        define_with_params(builder, at, DefKind::Device, &device.name, &device.statics);
    builder.index.inner_scopes[def.0 as usize].members = Some(scope);
    let ports = device.sections.iter().flat_map(|section| &section.ports);
    for port in ports {
        index_ports(builder, scope, &port.alternatives);
    }
}

/// Adds definitions for the ports of one actuator or sensor. A sensor whose value has several parts gets definitions
/// for the parts as well.
fn index_ports<'a>(builder: &mut Builder<'a>, scope: ScopeId, ports: &'a [VarDecl]) {
    let before = builder.index.defs.len();
    index_vars(builder, scope, ports, DefKind::Port);
    let mut defs = (before..).map(|id| DefId(u32::try_from(id).unwrap_or(u32::MAX)));
    for port in ports {
        let own: Vec<DefId> = defs.by_ref().take(port.names.len()).collect();
        let (TypeKind::Struct(parts), Some(first)) = (&port.ty.kind, own.first()) else {
            continue;
        };
        let at = DefPosition {
            scope,
            whole: port.span,
            doc: port.doc.as_ref(),
        };
        let inner = builder.inner(at, *first);
        for def in own {
            builder.index.inner_scopes[def.0 as usize].members = Some(inner);
        }
        index_vars(builder, inner, parts, DefKind::Field);
    }
}

fn index_frame<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, frame: &'a FrameDecl) {
    for name in &frame.names {
        builder.define(at, name, DefKind::Frame);
    }
    if let Some(parent) = &frame.parent {
        builder.defer(at.scope, PendingRef::Dotted(parent));
    }
    builder.exprs(at.scope, &frame.pose);
}

fn index_task<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, task: &'a TaskDecl) {
    let (def, scope) = define_with_params(builder, at, DefKind::Task, &task.name, &task.statics);
    index_vars(builder, scope, &task.params, DefKind::Param);
    let steps = builder.scope(at.whole, Some(scope), Some(def));
    index_steps(builder, steps, &task.steps);
}

fn index_steps<'a>(builder: &mut Builder<'a>, scope: ScopeId, steps: &'a [Step]) {
    for step in steps {
        let at = DefPosition {
            scope,
            whole: step.span,
            doc: step.doc.as_ref(),
        };
        match &step.kind {
            StepKind::Run(run) => {
                if let Some(label) = &run.label {
                    builder.define(at, label, DefKind::Step);
                }
                builder.defer(scope, PendingRef::Run(run));
            }
            StepKind::Repeat { count, steps } => {
                builder.exprs(scope, count);
                index_steps(builder, scope, steps);
            }
            StepKind::Parallel(strands) => {
                for strand in strands {
                    let own = builder.scope(strand.span, Some(scope), None);
                    index_steps(builder, own, &strand.steps);
                }
            }
            StepKind::Start(name) => builder.defer(scope, PendingRef::Name(name)),
            StepKind::Error(labels) => {
                for label in labels {
                    builder.define(at, label, DefKind::Step);
                }
            }
        }
    }
}

/// Adds definitions of the given kind for declared ports, parameters or fields.
pub(super) fn index_vars<'a>(
    builder: &mut Builder<'a>,
    scope: ScopeId,
    decls: &'a [VarDecl],
    kind: DefKind,
) {
    for decl in decls {
        let at = DefPosition {
            scope,
            whole: decl.span,
            doc: decl.doc.as_ref(),
        };
        for name in &decl.names {
            let def = builder.define(at, name, kind);
            builder.set_type(def, scope, &decl.ty);
        }
        builder.defer(scope, PendingRef::Type(&decl.ty));
        if let Some(clock) = &decl.clock {
            builder.defer(scope, PendingRef::Clock(clock));
        }
        builder.exprs(scope, &decl.default);
    }
}

pub(super) fn index_contract<'a>(
    builder: &mut Builder<'a>,
    scope: ScopeId,
    contract: Option<&'a Contract>,
) {
    let Some(contract) = contract else {
        return;
    };
    locals(builder, scope, contract.span, &contract.locals);
    for together in &contract.ghost_tuples {
        index_vars(builder, scope, &together.vars, DefKind::Local);
        builder.exprs(scope, [&together.equation.value]);
    }
    let modes = contract.modes.iter();
    let of_modes = modes.flat_map(|mode| mode.requires.iter().chain(&mode.ensures));
    let claims = contract.claims.iter().chain(of_modes);
    builder.exprs(scope, claims.map(|claim: &Claim| &claim.condition));
    builder.exprs(scope, contract.imports.iter().map(|import| &import.call));
}

pub(super) fn locals<'a>(
    builder: &mut Builder<'a>,
    scope: ScopeId,
    whole: rpi_diag::Span,
    all: &'a [Locals],
) {
    let at = DefPosition {
        scope,
        whole,
        doc: None,
    };
    for section in all {
        match section {
            Locals::Var(vars) => index_vars(builder, scope, vars, DefKind::Local),
            Locals::Const(defs) => defs.iter().for_each(|def| constant(builder, at, def)),
        }
    }
}

/// Adds definitions for the results with which a command or test can end.
fn index_results<'a>(builder: &mut Builder<'a>, at: DefPosition<'a>, body: &'a Body) {
    for statement in &body.statements {
        if let rpi_syntax::ast::StatementKind::CommandEnd(end) = &statement.kind {
            let at = DefPosition {
                whole: statement.span,
                doc: statement.doc.as_ref(),
                ..at
            };
            builder.define(at, &end.result, DefKind::Result);
        }
    }
}

fn broken_kind(kind: DeclaredKind) -> DefKind {
    match kind {
        DeclaredKind::Const => DefKind::Const,
        DeclaredKind::Type => DefKind::Type,
        DeclaredKind::Callable => DefKind::Node,
        DeclaredKind::Device => DefKind::Device,
        DeclaredKind::Frame => DefKind::Frame,
        DeclaredKind::Command => DefKind::Command,
        DeclaredKind::Task => DefKind::Task,
    }
}
