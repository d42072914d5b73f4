//! Resolves references, after all names are defined.

use super::shapes;
use crate::query::build::{
    Builder, Callee, Clock, DefId, Dotted, Expr, Ident, PendingRef, Run, ScopeId, Target, Type,
    Update,
};
use crate::query::def::DefKind;
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::{
    Access, Activation, Arg, Branch, Call, ClockValue, ExprKind, Match, NamedType, NextStep,
    Pattern, Quantified, ResultPattern, SliceBounds, StaticArg, StaticValue, StructExpr, TypeKind,
    Unit,
};

/// Resolves all names that have been recorded for resolution, and determines for each definition which members it has.
pub(super) fn resolve_pending(builder: &mut Builder<'_>) {
    for (scope, work) in std::mem::take(&mut builder.pending) {
        match work {
            PendingRef::Expr(expr) => index_expr(builder, scope, expr),
            PendingRef::Type(ty) => index_ty(builder, scope, ty),
            PendingRef::Clock(clock) => index_clock(builder, scope, clock),
            PendingRef::Target(target) => target_part(builder, scope, target),
            PendingRef::Dotted(dotted) => index_dotted(builder, scope, dotted),
            PendingRef::Callee(callee) => index_callee(builder, scope, callee),
            PendingRef::Run(run) => index_run(builder, scope, run),
            PendingRef::Name(name) => {
                elementwise_array_name(builder, scope, &name.name, name.span);
            }
            PendingRef::Module(name) => {
                if let Some(def) = builder.modules.get(&name.name).copied() {
                    builder.refer(name.span, def);
                }
            }
        }
    }
    for id in (0..builder.index.defs.len()).filter_map(|k| u32::try_from(k).ok()) {
        let shape = shapes::index_shape(builder, DefId(id));
        builder.index.defs[id as usize].shape = shape;
    }
}

fn elementwise_array_name(
    builder: &mut Builder<'_>,
    scope: ScopeId,
    name: &Name,
    span: Span,
) -> Option<DefId> {
    let def = builder.index.lookup(scope, name)?;
    builder.refer(span, def);
    Some(def)
}

fn exprs_in<'a>(
    builder: &mut Builder<'a>,
    scope: ScopeId,
    exprs: impl IntoIterator<Item = &'a Expr>,
) {
    exprs
        .into_iter()
        .for_each(|expr| index_expr(builder, scope, expr));
}

fn index_expr<'a>(builder: &mut Builder<'a>, scope: ScopeId, expr: &'a Expr) {
    match &expr.kind {
        ExprKind::Bool(_) | ExprKind::Number(_) | ExprKind::Str(_) => {}
        ExprKind::Quantity(quantity) => index_unit(builder, scope, &quantity.unit),
        ExprKind::Name(name) => {
            elementwise_array_name(builder, scope, name, expr.span);
        }
        ExprKind::Field(field) => {
            index_expr(builder, scope, &field.base);
            let owner = shapes::owner_of(builder, scope, &field.base);
            index_member(builder, owner, &field.field);
        }
        ExprKind::Index(index) => exprs_in(builder, scope, [&index.base, &index.index]),
        ExprKind::Slice(of) => {
            index_expr(builder, scope, &of.base);
            index_slice(builder, scope, &of.slice);
        }
        ExprKind::BitRange(of) => exprs_in(builder, scope, [&of.base, &of.high, &of.low]),
        ExprKind::Unary(_, inner) | ExprKind::Paren(inner) => index_expr(builder, scope, inner),
        ExprKind::Binary(binary) => exprs_in(builder, scope, [&binary.lhs, &binary.rhs]),
        ExprKind::When(when) => {
            index_expr(builder, scope, &when.value);
            index_clock(builder, scope, &when.clock);
        }
        ExprKind::If(choice) => exprs_in(
            builder,
            scope,
            [&choice.condition, &choice.then_value, &choice.else_value],
        ),
        ExprKind::Call(call) => index_call(builder, scope, call),
        ExprKind::BoolList(_, all) | ExprKind::Tuple(all) | ExprKind::Array(all) => {
            exprs_in(builder, scope, &**all);
        }
        ExprKind::Merge(merge) => {
            index_expr(builder, scope, &merge.selector);
            for case in &merge.cases {
                elementwise_array_name(builder, scope, &case.value.name, case.value.span);
                index_expr(builder, scope, &case.then);
            }
        }
        ExprKind::Quantified(of) => index_quantified(builder, scope, of),
        ExprKind::Ascription(of) => {
            index_expr(builder, scope, &of.value);
            index_ty(builder, scope, &of.ty);
        }
        ExprKind::ConstructorTest(of) => index_expr(builder, scope, &of.value),
        ExprKind::Match(of) => index_match(builder, scope, of),
        ExprKind::EmptySet(types) => index_statics(builder, scope, None, types),
        ExprKind::Struct(of) => struct_expr(builder, scope, of),
        ExprKind::Update(update) => index_update(builder, scope, update),
    }
}

fn index_quantified<'a>(builder: &mut Builder<'a>, scope: ScopeId, of: &'a Quantified) {
    for var in &of.vars {
        index_ty(builder, scope, &var.ty);
    }
    let names = of.vars.iter().flat_map(|var| &var.names);
    binder_expr(builder, scope, names.map(|name| &name.name), &of.condition);
}

fn index_match<'a>(builder: &mut Builder<'a>, scope: ScopeId, of: &'a Match) {
    index_expr(builder, scope, &of.value);
    for arm in &of.arms {
        let name = &arm.pattern.name;
        elementwise_array_name(builder, scope, &name.name, name.span);
        let parts = arm.pattern.parts.iter().flat_map(Pattern::names);
        binder_expr(builder, scope, parts.map(|name| &name.name), &arm.then);
    }
}

/// Indexes an expression in which further names are bound, as in a quantifier. If one of them has the name of a visible
/// definition, the expression is left out, because its names would be resolved wrongly.
fn binder_expr<'a>(
    builder: &mut Builder<'a>,
    scope: ScopeId,
    mut names: impl Iterator<Item = &'a Name>,
    expr: &'a Expr,
) {
    if !names.any(|name| builder.index.lookup(scope, name).is_some()) {
        index_expr(builder, scope, expr);
    }
}

fn index_member(builder: &mut Builder<'_>, owner: Option<DefId>, field: &Ident) -> Option<DefId> {
    let def = shapes::member_named(builder, owner?, &field.name)?;
    builder.refer(field.span, def);
    Some(def)
}

fn index_slice<'a>(builder: &mut Builder<'a>, scope: ScopeId, slice: &'a SliceBounds) {
    exprs_in(
        builder,
        scope,
        [&slice.from, &slice.to].into_iter().chain(&slice.step),
    );
}

fn struct_expr<'a>(builder: &mut Builder<'a>, scope: ScopeId, of: &'a StructExpr) {
    let ty = elementwise_array_name(builder, scope, &of.ty.name, of.ty.span);
    let owner = ty.map(|ty| shapes::resolve_type_alias(builder, ty));
    exprs_in(builder, scope, &of.base);
    for field in &of.fields {
        index_member(builder, owner, &field.field);
        index_expr(builder, scope, &field.value);
    }
}

fn index_update<'a>(builder: &mut Builder<'a>, scope: ScopeId, update: &'a Update) {
    index_expr(builder, scope, &update.base);
    for change in &update.changes {
        let owner = shapes::owner_of(builder, scope, &update.base);
        match &change.path[..] {
            // The key is the name of a field, or a flow as an index.
            [Access::Index(key)] if update.is_keyed && owner.is_some() => match key.as_name() {
                Some(name) => {
                    let (name, span) = (name.clone(), key.span);
                    index_member(builder, owner, &Ident { name, span });
                }
                None => index_expr(builder, scope, key),
            },
            path => index_path(builder, scope, owner, path),
        }
        index_expr(builder, scope, &change.value);
    }
}

fn index_path<'a>(
    builder: &mut Builder<'a>,
    scope: ScopeId,
    mut owner: Option<DefId>,
    path: &'a [Access],
) {
    for step in path {
        match step {
            Access::Field(field) => {
                let def = index_member(builder, owner, field);
                owner = def.and_then(|def| shapes::owner_of_def(builder, def));
            }
            Access::Index(index) => index_expr(builder, scope, index),
            Access::Slice(slice) => index_slice(builder, scope, slice),
        }
    }
}

fn target_part<'a>(builder: &mut Builder<'a>, scope: ScopeId, target: &'a Target) {
    let name = &target.name;
    let def = elementwise_array_name(builder, scope, &name.name, name.span);
    let owner = def.and_then(|def| shapes::owner_of_def(builder, def));
    index_path(builder, scope, owner, &target.path);
}

fn index_dotted<'a>(builder: &mut Builder<'a>, scope: ScopeId, dotted: &'a Dotted) {
    let Some((first, rest)) = dotted.parts.split_first() else {
        return;
    };
    let mut def = elementwise_array_name(builder, scope, &first.name, first.span);
    for part in rest {
        let owner = def.and_then(|def| shapes::owner_of_def(builder, def));
        def = index_member(builder, owner, part);
    }
}

fn index_clock<'a>(builder: &mut Builder<'a>, scope: ScopeId, clock: &'a Clock) {
    elementwise_array_name(builder, scope, &clock.flow.name, clock.flow.span);
    if let ClockValue::Value(value) = &clock.value {
        elementwise_array_name(builder, scope, &value.name, value.span);
    }
}

fn index_call<'a>(builder: &mut Builder<'a>, scope: ScopeId, call: &'a Call) {
    index_callee(builder, scope, &call.callee);
    match &call.activation {
        Activation::Always => {}
        Activation::Activate {
            every,
            restart,
            default,
        } => exprs_in(
            builder,
            scope,
            [every].into_iter().chain(restart).chain(default),
        ),
        Activation::Restart { every } => index_expr(builder, scope, every),
    }
    index_args(builder, scope, &call.callee.name.name, &call.args);
}

fn index_callee<'a>(builder: &mut Builder<'a>, scope: ScopeId, callee: &'a Callee) {
    let def = elementwise_array_name(builder, scope, &callee.name.name, callee.name.span);
    index_statics(builder, scope, def, &callee.statics);
}

fn index_statics<'a>(
    builder: &mut Builder<'a>,
    scope: ScopeId,
    of: Option<DefId>,
    statics: &'a [StaticArg],
) {
    for arg in statics {
        if let (Some(name), Some(of)) = (&arg.name, of) {
            parameter(builder, of, name);
        }
        match &arg.value {
            StaticValue::Expr(expr) => index_expr(builder, scope, expr),
            StaticValue::Type(ty) => index_ty(builder, scope, ty),
            StaticValue::Op(_) => {}
            StaticValue::Callee(callee) => index_callee(builder, scope, callee),
        }
    }
}

fn index_args<'a>(builder: &mut Builder<'a>, scope: ScopeId, callee: &Name, args: &'a [Arg]) {
    let def = builder.index.lookup(scope, callee);
    for arg in args {
        if let (Some(name), Some(def)) = (&arg.name, def) {
            parameter(builder, def, name);
        }
        index_expr(builder, scope, &arg.value);
    }
}

/// Records the name of an argument as a reference to a parameter or in-port of the callee `of`.
fn parameter(builder: &mut Builder<'_>, of: DefId, name: &Ident) {
    let of = shapes::resolve_callable_alias(builder, of);
    let Some(scope) = builder.index.inner_scopes(of).parameters else {
        return;
    };
    let found = builder.index.scope(scope).names.get(&name.name).copied();
    if let Some(def) = found.filter(|id| builder.index.def(*id).kind.is_parameter()) {
        builder.refer(name.span, def);
    }
}

fn index_ty<'a>(builder: &mut Builder<'a>, scope: ScopeId, ty: &'a Type) {
    match &ty.kind {
        TypeKind::Bool | TypeKind::Int | TypeKind::Error => {}
        TypeKind::Real(unit) => unit
            .iter()
            .for_each(|unit| index_unit(builder, scope, unit)),
        TypeKind::Named(named) => named_type(builder, scope, named),
        TypeKind::Array(array) => {
            index_ty(builder, scope, &array.element);
            index_expr(builder, scope, &array.size);
        }
        TypeKind::Optional(inner) => index_ty(builder, scope, inner),
        TypeKind::Subrange(range) => {
            exprs_in(builder, scope, range.lower.iter().chain(&range.upper))
        }
        // These occur only in type declarations, which are not on the worklist.
        TypeKind::Enum(_) | TypeKind::Datatype(_) => {}
        // A sensor with several parts.
        TypeKind::Struct(fields) => fields
            .iter()
            .for_each(|field| index_ty(builder, scope, &field.ty)),
        TypeKind::Tuple(types) => types.iter().for_each(|ty| index_ty(builder, scope, ty)),
        TypeKind::Refinement(refined) => {
            index_ty(builder, scope, &refined.base);
            binder_expr(
                builder,
                scope,
                [&refined.name.name].into_iter(),
                &refined.condition,
            );
        }
    }
}

/// Resolves the static parameters in a unit of measure: a type parameter stands for the unit of its type. Other names are those of
/// units, even if a flow has the same name.
fn index_unit(builder: &mut Builder<'_>, scope: ScopeId, unit: &Unit) {
    for factor in &unit.factors {
        let def = builder.index.lookup(scope, &factor.unit.name);
        if let Some(def) = def.filter(|def| builder.index.def(*def).kind == DefKind::StaticParam) {
            builder.refer(factor.unit.span, def);
        }
    }
}

fn named_type<'a>(builder: &mut Builder<'a>, scope: ScopeId, named: &'a NamedType) {
    let def = elementwise_array_name(builder, scope, &named.name.name, named.name.span);
    index_statics(builder, scope, def, &named.statics);
    let Some(frames) = &named.frames else {
        return;
    };
    for frame in frames.located.iter().chain([&frames.reference]) {
        index_dotted(builder, scope, frame);
    }
}

fn index_run<'a>(builder: &mut Builder<'a>, scope: ScopeId, run: &'a Run) {
    index_callee(builder, scope, &run.callee);
    index_args(builder, scope, &run.callee.name.name, &run.args);
    let command = builder.index.lookup(scope, &run.callee.name.name);
    for branch in &run.branches {
        index_branch(builder, scope, command, branch);
    }
}

fn index_branch<'a>(
    builder: &mut Builder<'a>,
    scope: ScopeId,
    command: Option<DefId>,
    branch: &'a Branch,
) {
    for result in &branch.results {
        if let ResultPattern::Named(name) = result {
            index_member(builder, command, name);
        }
    }
    if let NextStep::Step(step) = &branch.next {
        elementwise_array_name(builder, scope, &step.name, step.span);
    }
}

/// Returns whether definitions of this kind have members of their own. All others have the members of their type or
/// value.
pub(super) fn has_own_members(kind: DefKind) -> bool {
    use DefKind::{Block, Command, State};
    matches!(kind, Block | State | Command)
}
