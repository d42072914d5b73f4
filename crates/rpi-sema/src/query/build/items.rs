//! Definitions at the top level of a file, with their parameters and ports.

use crate::program::Source;
use crate::query::build::{At, Body, Builder, DefId, DefKind, Ident, Origin, ScopeId, Work};
use rpi_syntax::ast::{
    Claim, ConstDef, Contract, DeclaredKind, DeviceDecl, FragmentDecl, FrameDecl, Item, ItemKind,
    Locals, NodeDecl, NodeDef, NodeKind, Signature, StaticParam, StaticParamKind, Step, StepKind,
    TaskDecl, TypeDef, TypeKind, VarDecl,
};

impl<'a> Builder<'a> {
    pub(super) fn items(&mut self, source: &Source<'a>, scope: ScopeId) {
        for file in &source.files {
            self.mode = file.mode;
            for item in &file.items {
                self.item(scope, item);
            }
        }
    }

    fn item(&mut self, scope: ScopeId, item: &'a Item) {
        let at = At {
            scope,
            whole: item.span,
            doc: item.doc.as_ref(),
        };
        match &item.kind {
            ItemKind::Use(names) => names
                .iter()
                .for_each(|name| self.later(scope, Work::Module(name))),
            ItemKind::Include(_) => {}
            ItemKind::Const(defs) => defs.iter().for_each(|def| self.constant(at, def)),
            ItemKind::Type(defs) => defs.iter().for_each(|def| self.type_def(at, def)),
            ItemKind::Node(node) => self.node(at, node),
            ItemKind::Fragment(fragment) => self.fragment(at, fragment),
            ItemKind::Primitive(primitive) => {
                self.callable(at, DefKind::Primitive, &primitive.signature);
                self.exprs(scope, &primitive.budget);
            }
            ItemKind::Device(device) => self.device(at, device),
            ItemKind::Frame(frame) => self.frame(at, frame),
            ItemKind::Command(command) => {
                let (def, body) =
                    self.loaded(at, DefKind::Command, &command.name, &command.statics);
                let results = self.inner(at, def);
                self.index.inside[def.0 as usize].members = Some(results);
                self.vars(body, &command.params, DefKind::Param);
                self.vars(body, &command.given, DefKind::Given);
                self.exprs(body, &command.budget);
                self.contract(body, command.contract.as_ref());
                self.body(body, &command.body);
                self.results(
                    At {
                        scope: results,
                        ..at
                    },
                    &command.body,
                );
            }
            ItemKind::Task(task) => self.task(at, task),
            ItemKind::Test(test) => {
                let def = self.define(at, &test.title, DefKind::Test);
                let results = self.inner(at, def);
                let body = self.inner(at, def);
                self.body(body, &test.body);
                let at = At {
                    scope: results,
                    ..at
                };
                self.results(at, &test.body);
            }
            ItemKind::Broken(names) => {
                for declared in names {
                    self.define(at, &declared.name, broken_kind(declared.kind));
                }
            }
        }
    }

    pub(super) fn constant(&mut self, at: At<'a>, def: &'a ConstDef) {
        self.constants(at.within(def.span, def.doc.as_ref()), def, DefKind::Const);
    }

    fn constants(&mut self, at: At<'a>, def: &'a ConstDef, kind: DefKind) {
        for name in &def.names {
            let id = self.define(at, name, kind);
            match (&def.ty, &def.value) {
                (Some(ty), _) => self.typed(id, at.scope, ty),
                (None, Some(value)) => self.shapes.set(id, at.scope, Origin::Value(value)),
                (None, None) => {}
            }
        }
        if let Some(ty) = &def.ty {
            self.later(at.scope, Work::Type(ty));
        }
        self.exprs(at.scope, &def.value);
    }

    fn type_def(&mut self, at: At<'a>, def: &'a TypeDef) {
        let at = at.within(def.span, def.doc.as_ref());
        let id = self.define(at, &def.name, DefKind::Type);
        let Some(ty) = &def.ty else {
            return;
        };
        match &ty.kind {
            TypeKind::Enum(values) => {
                for value in values {
                    // The doc comment of the type does not apply to its values.
                    let at = At {
                        whole: value.name.span,
                        doc: value.doc.as_ref(),
                        ..at
                    };
                    self.define(at, &value.name, DefKind::EnumValue);
                }
            }
            TypeKind::Struct(fields) => {
                let scope = self.inner(at, id);
                self.index.inside[id.0 as usize].members = Some(scope);
                self.vars(scope, fields, DefKind::Field);
            }
            _ => {
                self.typed(id, at.scope, ty);
                self.later(at.scope, Work::Type(ty));
            }
        }
    }

    fn node(&mut self, at: At<'a>, node: &'a NodeDecl) {
        let kind = match node.kind {
            NodeKind::Node | NodeKind::Contract => DefKind::Node,
            NodeKind::Function => DefKind::Function,
        };
        let (def, scope) = self.callable(at, kind, &node.signature);
        self.contract(scope, node.contract.as_ref());
        match &node.definition {
            NodeDef::Body(body) => self.body(scope, body),
            NodeDef::Alias(callee) => {
                self.shapes.set(def, at.scope, Origin::Alias(callee));
                self.later(scope, Work::Callee(callee));
            }
            NodeDef::Extern => {}
        }
    }

    fn fragment(&mut self, at: At<'a>, fragment: &'a FragmentDecl) {
        let (_, scope) = self.callable(at, DefKind::Fragment, &fragment.signature);
        let when = fragment.when.iter().map(|when| &when.condition);
        self.exprs(scope, when.chain(&fragment.budget));
        self.contract(scope, fragment.contract.as_ref());
        self.body(scope, &fragment.body);
    }

    /// Defines a callable with its parameters and ports.
    fn callable(&mut self, at: At<'a>, kind: DefKind, of: &'a Signature) -> (DefId, ScopeId) {
        let (def, scope) = self.loaded(at, kind, &of.name, &of.statics);
        self.index.inside[def.0 as usize].members = Some(scope);
        self.vars(
            scope,
            of.inputs.as_deref().unwrap_or_default(),
            DefKind::Input,
        );
        self.vars(
            scope,
            of.outputs.as_deref().unwrap_or_default(),
            DefKind::Output,
        );
        (def, scope)
    }

    /// Defines a declaration with static parameters and returns its inner scope.
    fn loaded(
        &mut self,
        at: At<'a>,
        kind: DefKind,
        name: &'a Ident,
        statics: &'a [StaticParam],
    ) -> (DefId, ScopeId) {
        let def = self.define(at, name, kind);
        let scope = self.inner(at, def);
        self.index.inside[def.0 as usize].parameters = Some(scope);
        let at = At { scope, ..at };
        statics
            .iter()
            .for_each(|param| self.static_param(at, param));
        (def, scope)
    }

    fn static_param(&mut self, at: At<'a>, param: &'a StaticParam) {
        let at = At {
            whole: param.span,
            doc: param.doc.as_ref(),
            ..at
        };
        match &param.kind {
            StaticParamKind::Type(name, _) => {
                self.define(at, name, DefKind::Static);
            }
            StaticParamKind::Value(def) => self.constants(at, def, DefKind::Static),
            StaticParamKind::Node(_, signature) => {
                let def = self.define(at, &signature.name, DefKind::Static);
                let scope = self.inner(at, def);
                let ports = [&signature.inputs, &signature.outputs];
                for port in ports.into_iter().flatten().flatten() {
                    self.later(scope, Work::Type(&port.ty));
                }
            }
        }
    }

    fn device(&mut self, at: At<'a>, device: &'a DeviceDecl) {
        let (def, scope) = self.loaded(at, DefKind::Device, &device.name, &device.statics);
        self.index.inside[def.0 as usize].members = Some(scope);
        let ports = device.sections.iter().flat_map(|section| &section.ports);
        for port in ports {
            self.vars(scope, &port.alternatives, DefKind::Port);
        }
    }

    fn frame(&mut self, at: At<'a>, frame: &'a FrameDecl) {
        for name in &frame.names {
            self.define(at, name, DefKind::Frame);
        }
        if let Some(parent) = &frame.parent {
            self.later(at.scope, Work::Dotted(parent));
        }
        self.exprs(at.scope, &frame.pose);
    }

    fn task(&mut self, at: At<'a>, task: &'a TaskDecl) {
        let (def, scope) = self.loaded(at, DefKind::Task, &task.name, &task.statics);
        self.vars(scope, &task.params, DefKind::Param);
        let steps = self.scope(at.whole, Some(scope), Some(def));
        self.steps(steps, &task.steps);
    }

    fn steps(&mut self, scope: ScopeId, steps: &'a [Step]) {
        for step in steps {
            let at = At {
                scope,
                whole: step.span,
                doc: step.doc.as_ref(),
            };
            match &step.kind {
                StepKind::Run(run) => {
                    if let Some(label) = &run.label {
                        self.define(at, label, DefKind::Step);
                    }
                    self.later(scope, Work::Run(run));
                }
                StepKind::Repeat { count, steps } => {
                    self.exprs(scope, count);
                    self.steps(scope, steps);
                }
                StepKind::Parallel(strands) => {
                    for strand in strands {
                        let own = self.scope(strand.span, Some(scope), None);
                        self.steps(own, &strand.steps);
                    }
                }
                StepKind::Start(name) => self.later(scope, Work::Name(name)),
                StepKind::Broken(labels) => {
                    for label in labels {
                        self.define(at, label, DefKind::Step);
                    }
                }
            }
        }
    }

    /// Defines ports, parameters or fields.
    pub(super) fn vars(&mut self, scope: ScopeId, decls: &'a [VarDecl], kind: DefKind) {
        for decl in decls {
            let at = At {
                scope,
                whole: decl.span,
                doc: decl.doc.as_ref(),
            };
            for name in &decl.names {
                let def = self.define(at, name, kind);
                self.typed(def, scope, &decl.ty);
            }
            self.later(scope, Work::Type(&decl.ty));
            if let Some(clock) = &decl.clock {
                self.later(scope, Work::Clock(clock));
            }
            self.exprs(scope, &decl.default);
        }
    }

    pub(super) fn contract(&mut self, scope: ScopeId, contract: Option<&'a Contract>) {
        let Some(contract) = contract else {
            return;
        };
        self.locals(scope, contract.span, &contract.locals);
        for together in &contract.together {
            self.vars(scope, &together.vars, DefKind::Local);
            self.exprs(scope, [&together.equation.value]);
        }
        let modes = contract.modes.iter();
        let of_modes = modes.flat_map(|mode| mode.requires.iter().chain(&mode.ensures));
        let claims = contract.claims.iter().chain(of_modes);
        self.exprs(scope, claims.map(|claim: &Claim| &claim.condition));
        self.exprs(scope, contract.imports.iter().map(|import| &import.call));
    }

    pub(super) fn locals(&mut self, scope: ScopeId, whole: rpi_diag::Span, all: &'a [Locals]) {
        let at = At {
            scope,
            whole,
            doc: None,
        };
        for section in all {
            match section {
                Locals::Var(vars) => self.vars(scope, vars, DefKind::Local),
                Locals::Const(defs) => defs.iter().for_each(|def| self.constant(at, def)),
            }
        }
    }

    /// Defines the results of a command or test.
    fn results(&mut self, at: At<'a>, body: &'a Body) {
        for statement in &body.statements {
            if let rpi_syntax::ast::StatementKind::End(end) = &statement.kind {
                let at = At {
                    whole: statement.span,
                    doc: statement.doc.as_ref(),
                    ..at
                };
                self.define(at, &end.result, DefKind::Result);
            }
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
