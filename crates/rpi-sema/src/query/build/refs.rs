//! Resolves references, after all names are defined.

use crate::query::build::{
    Builder, Callee, Clock, DefId, Dotted, Expr, Ident, Run, ScopeId, Target, Type, Update, Work,
};
use crate::query::def::DefKind;
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::{
    Access, Activation, Arg, Branch, Call, ExprKind, NamedType, Next, OnResult, Pattern, Slice,
    StaticArg, StaticValue, StructExpr, Tick, TypeKind,
};

impl<'a> Builder<'a> {
    /// Resolves everything on the worklist and computes the shape of every definition.
    pub(super) fn work_off(&mut self) {
        for (scope, work) in std::mem::take(&mut self.work) {
            match work {
                Work::Expr(expr) => self.expr(scope, expr),
                Work::Type(ty) => self.ty(scope, ty),
                Work::Clock(clock) => self.clock(scope, clock),
                Work::Target(target) => self.target_part(scope, target),
                Work::Dotted(dotted) => self.dotted(scope, dotted),
                Work::Callee(callee) => self.callee(scope, callee),
                Work::Run(run) => self.run(scope, run),
                Work::Name(name) => {
                    self.name(scope, &name.name, name.span);
                }
                Work::Module(name) => {
                    if let Some(def) = self.modules.get(&name.name).copied() {
                        self.refer(name.span, def);
                    }
                }
            }
        }
        for id in (0..self.index.defs.len()).filter_map(|k| u32::try_from(k).ok()) {
            let shape = self.shape(DefId(id));
            self.index.defs[id as usize].shape = shape;
        }
    }

    fn name(&mut self, scope: ScopeId, name: &Name, span: Span) -> Option<DefId> {
        let def = self.index.lookup(scope, name)?;
        self.refer(span, def);
        Some(def)
    }

    fn all(&mut self, scope: ScopeId, exprs: impl IntoIterator<Item = &'a Expr>) {
        exprs.into_iter().for_each(|expr| self.expr(scope, expr));
    }

    fn expr(&mut self, scope: ScopeId, expr: &'a Expr) {
        match &expr.kind {
            ExprKind::Bool(_) | ExprKind::Number(_) | ExprKind::Quantity(_) | ExprKind::Str(_) => {}
            ExprKind::Name(name) => {
                self.name(scope, name, expr.span);
            }
            ExprKind::Field(field) => {
                self.expr(scope, &field.base);
                let owner = self.owner_of(scope, &field.base);
                self.member(owner, &field.field);
            }
            ExprKind::Index(index) => self.all(scope, [&index.base, &index.index]),
            ExprKind::Slice(of) => {
                self.expr(scope, &of.base);
                self.slice(scope, &of.slice);
            }
            ExprKind::Bits(of) => self.all(scope, [&of.base, &of.high, &of.low]),
            ExprKind::Unary(_, inner) | ExprKind::Paren(inner) => self.expr(scope, inner),
            ExprKind::Binary(binary) => self.all(scope, [&binary.lhs, &binary.rhs]),
            ExprKind::When(when) => {
                self.expr(scope, &when.value);
                self.clock(scope, &when.clock);
            }
            ExprKind::If(choice) => self.all(scope, [&choice.condition, &choice.yes, &choice.no]),
            ExprKind::Call(call) => self.call(scope, call),
            ExprKind::Among(_, all) | ExprKind::Tuple(all) | ExprKind::Array(all) => {
                self.all(scope, &**all);
            }
            ExprKind::Merge(merge) => {
                self.expr(scope, &merge.on);
                for case in &merge.cases {
                    self.name(scope, &case.value.name, case.value.span);
                    self.expr(scope, &case.then);
                }
            }
            ExprKind::Quantified(of) => {
                let names = of.vars.iter().flat_map(|var| &var.names);
                let names = names.map(|name| &name.name);
                of.vars.iter().for_each(|var| self.ty(scope, &var.ty));
                self.with_own_names(scope, names, &of.condition);
            }
            ExprKind::Ascribed(of) => {
                self.expr(scope, &of.value);
                self.ty(scope, &of.ty);
            }
            ExprKind::IsA(of) => self.expr(scope, &of.value),
            ExprKind::Match(of) => {
                self.expr(scope, &of.value);
                for arm in &of.arms {
                    self.name(scope, &arm.pattern.name.name, arm.pattern.name.span);
                    let parts = arm.pattern.parts.iter().flat_map(Pattern::names);
                    self.with_own_names(scope, parts.map(|name| &name.name), &arm.then);
                }
            }
            ExprKind::EmptySet(types) => self.statics(scope, None, types),
            ExprKind::Struct(of) => self.struct_expr(scope, of),
            ExprKind::Update(update) => self.update(scope, update),
        }
    }

    /// Visits an expression with bound names. If one of them shadows an outer name, the expression is not resolved.
    fn with_own_names(
        &mut self,
        scope: ScopeId,
        mut names: impl Iterator<Item = &'a Name>,
        expr: &'a Expr,
    ) {
        if !names.any(|name| self.index.lookup(scope, name).is_some()) {
            self.expr(scope, expr);
        }
    }

    fn member(&mut self, owner: Option<DefId>, field: &Ident) -> Option<DefId> {
        let def = self.member_named(owner?, &field.name)?;
        self.refer(field.span, def);
        Some(def)
    }

    fn slice(&mut self, scope: ScopeId, slice: &'a Slice) {
        self.all(
            scope,
            [&slice.from, &slice.to].into_iter().chain(&slice.step),
        );
    }

    fn struct_expr(&mut self, scope: ScopeId, of: &'a StructExpr) {
        let ty = self.name(scope, &of.ty.name, of.ty.span);
        let owner = ty.map(|ty| self.type_behind(ty));
        self.all(scope, &of.base);
        for field in &of.fields {
            self.member(owner, &field.field);
            self.expr(scope, &field.value);
        }
    }

    fn update(&mut self, scope: ScopeId, update: &'a Update) {
        self.expr(scope, &update.base);
        for change in &update.changes {
            let owner = self.owner_of(scope, &update.base);
            match &change.path[..] {
                // The key is the name of a field, or a flow as an index.
                [Access::Index(key)] if update.is_keyed && owner.is_some() => match key.as_name() {
                    Some(name) => {
                        let (name, span) = (name.clone(), key.span);
                        self.member(owner, &Ident { name, span });
                    }
                    None => self.expr(scope, key),
                },
                path => self.path(scope, owner, path),
            }
            self.expr(scope, &change.value);
        }
    }

    fn path(&mut self, scope: ScopeId, mut owner: Option<DefId>, path: &'a [Access]) {
        for step in path {
            match step {
                Access::Field(field) => {
                    let def = self.member(owner, field);
                    owner = def.and_then(|def| self.owner_behind(def));
                }
                Access::Index(index) => self.expr(scope, index),
                Access::Slice(slice) => self.slice(scope, slice),
            }
        }
    }

    fn target_part(&mut self, scope: ScopeId, target: &'a Target) {
        let name = &target.name;
        let def = self.name(scope, &name.name, name.span);
        let owner = def.and_then(|def| self.owner_behind(def));
        self.path(scope, owner, &target.path);
    }

    fn dotted(&mut self, scope: ScopeId, dotted: &'a Dotted) {
        let Some((first, rest)) = dotted.parts.split_first() else {
            return;
        };
        let mut def = self.name(scope, &first.name, first.span);
        for part in rest {
            let owner = def.and_then(|def| self.owner_behind(def));
            def = self.member(owner, part);
        }
    }

    fn clock(&mut self, scope: ScopeId, clock: &'a Clock) {
        self.name(scope, &clock.flow.name, clock.flow.span);
        if let Tick::Value(value) = &clock.tick {
            self.name(scope, &value.name, value.span);
        }
    }

    fn call(&mut self, scope: ScopeId, call: &'a Call) {
        self.callee(scope, &call.callee);
        match &call.activation {
            Activation::Always => {}
            Activation::Activate {
                every,
                restart,
                default,
            } => self.all(scope, [every].into_iter().chain(restart).chain(default)),
            Activation::Restart { every } => self.expr(scope, every),
        }
        self.args(scope, &call.callee.name.name, &call.args);
    }

    fn callee(&mut self, scope: ScopeId, callee: &'a Callee) {
        let def = self.name(scope, &callee.name.name, callee.name.span);
        self.statics(scope, def, &callee.statics);
    }

    fn statics(&mut self, scope: ScopeId, of: Option<DefId>, statics: &'a [StaticArg]) {
        for arg in statics {
            if let (Some(name), Some(of)) = (&arg.name, of) {
                self.parameter(of, name);
            }
            match &arg.value {
                StaticValue::Expr(expr) => self.expr(scope, expr),
                StaticValue::Type(ty) => self.ty(scope, ty),
                StaticValue::Op(_) => {}
                StaticValue::Callee(callee) => self.callee(scope, callee),
            }
        }
    }

    fn args(&mut self, scope: ScopeId, callee: &Name, args: &'a [Arg]) {
        let def = self.index.lookup(scope, callee);
        for arg in args {
            if let (Some(name), Some(def)) = (&arg.name, def) {
                self.parameter(def, name);
            }
            self.expr(scope, &arg.value);
        }
    }

    /// Resolves the name of an argument.
    fn parameter(&mut self, of: DefId, name: &Ident) {
        let of = self.callable_behind(of);
        let Some(scope) = self.index.inside(of).parameters else {
            return;
        };
        let found = self.index.scope(scope).names.get(&name.name).copied();
        if let Some(def) = found.filter(|id| self.index.def(*id).kind.is_parameter()) {
            self.refer(name.span, def);
        }
    }

    fn ty(&mut self, scope: ScopeId, ty: &'a Type) {
        match &ty.kind {
            TypeKind::Bool | TypeKind::Int | TypeKind::Real(_) | TypeKind::Broken => {}
            TypeKind::Named(named) => self.named_type(scope, named),
            TypeKind::Array(array) => {
                self.ty(scope, &array.element);
                self.expr(scope, &array.size);
            }
            TypeKind::Optional(inner) => self.ty(scope, inner),
            TypeKind::Subrange(range) => self.all(scope, range.from.iter().chain(&range.to)),
            // These occur only in type declarations, which are not on the worklist.
            TypeKind::Enum(_) | TypeKind::Struct(_) | TypeKind::Data(_) => {}
            TypeKind::Tuple(types) => types.iter().for_each(|ty| self.ty(scope, ty)),
            TypeKind::Refined(refined) => {
                self.ty(scope, &refined.base);
                self.with_own_names(scope, [&refined.name.name].into_iter(), &refined.condition);
            }
        }
    }

    fn named_type(&mut self, scope: ScopeId, named: &'a NamedType) {
        let def = self.name(scope, &named.name.name, named.name.span);
        self.statics(scope, def, &named.statics);
        let Some(frames) = &named.frames else {
            return;
        };
        for frame in frames.of.iter().chain([&frames.in_frame]) {
            self.dotted(scope, frame);
        }
    }

    fn run(&mut self, scope: ScopeId, run: &'a Run) {
        self.callee(scope, &run.callee);
        self.args(scope, &run.callee.name.name, &run.args);
        let command = self.index.lookup(scope, &run.callee.name.name);
        for branch in &run.branches {
            self.branch(scope, command, branch);
        }
    }

    fn branch(&mut self, scope: ScopeId, command: Option<DefId>, branch: &'a Branch) {
        for result in &branch.on {
            if let OnResult::Named(name) = result {
                self.member(command, name);
            }
        }
        if let Next::Step(step) = &branch.then {
            self.name(scope, &step.name, step.span);
        }
    }

    /// Returns whether definitions of this kind have members of their own, rather than those of their shape.
    pub(super) fn has_own_members(kind: DefKind) -> bool {
        use DefKind::{Block, Command, State};
        matches!(kind, Block | State | Command)
    }
}
