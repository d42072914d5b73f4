//! Definitions and references in bodies: locals, equations, fragments in place and automata.

use crate::hash::Map;
use crate::query::build::{At, Body, Builder, DefId, DefKind, Ident, Mode, Origin, ScopeId, Work};
use rpi_syntax::Name;
use rpi_syntax::ast::{
    Automaton, Equation, FragmentDecl, Locals, Meaning, State, Statement, StatementKind, Target,
    Transition,
};

impl<'a> Builder<'a> {
    pub(super) fn body(&mut self, scope: ScopeId, body: &'a Body) {
        let whole = self.index.scope(scope).span;
        self.locals(scope, whole, &body.locals);
        for statement in &body.statements {
            self.statement(scope, statement);
        }
    }

    fn statement(&mut self, scope: ScopeId, statement: &'a Statement) {
        let at = At {
            scope,
            whole: statement.span,
            doc: statement.doc.as_ref(),
        };
        match &statement.kind {
            StatementKind::Equation(equation) => self.equation(at, equation),
            StatementKind::Call(call) => self.exprs(scope, [&**call]),
            StatementKind::Claim(claim) => {
                self.exprs(scope, [&claim.condition].into_iter().chain(&claim.provided))
            }
            StatementKind::End(end) => self.exprs(scope, [&end.condition]),
            StatementKind::Export(flows) => flows
                .iter()
                .for_each(|flow| self.later(scope, Work::Dotted(flow))),
            StatementKind::Fragment(fragment) => self.block(at, fragment),
            StatementKind::Automaton(automaton) => self.automaton(at, automaton),
            StatementKind::Choice(choice) => self.meaning(at, &choice.means),
            StatementKind::Keep(keep) => self.meaning(at, &keep.means),
            StatementKind::Broken(names) => names.iter().for_each(|name| {
                self.introduced(at, name);
            }),
        }
    }

    /// Visits the equations to which a block is desugared.
    fn meaning(&mut self, at: At<'a>, means: &'a Meaning) {
        for (equation, _) in &means.equations {
            self.equation(at, equation);
        }
    }

    fn equation(&mut self, at: At<'a>, equation: &'a Equation) {
        for target in &equation.targets {
            match target.path.is_empty() {
                true => self.target(at, &target.name, equation),
                false => self.later(at.scope, Work::Target(target)),
            }
        }
        self.exprs(at.scope, [&equation.value]);
    }

    fn target(&mut self, at: At<'a>, name: &'a Ident, equation: &'a Equation) {
        let def = self.introduced(at, name);
        if let (Some(def), [_]) = (def, &equation.targets[..]) {
            let value = Origin::Value(&equation.value);
            self.shapes.set_if_open(def, at.scope, value);
        }
    }

    /// Resolves a plain name on the left of an equation: a flow declared in this scope, a flow of an enclosing scope
    /// that the equation defines, or a new local flow.
    fn introduced(&mut self, at: At<'a>, name: &'a Ident) -> Option<DefId> {
        if name.name == "_" {
            return None;
        }
        let here = self.index.scope(at.scope).names.get(&name.name).copied();
        let around = || self.index.lookup(at.scope, &name.name);
        let known = here.or_else(|| around().filter(|id| self.is_defined_inside(at.scope, *id)));
        match known {
            Some(def) => {
                self.refer(name.span, def);
                Some(def)
            }
            None if self.mode == Mode::Lustre => None,
            None => Some(self.define(at, name, DefKind::Local)),
        }
    }

    /// Returns whether an equation in a scope defines a flow of an enclosing scope: an input or parameter, or a flow
    /// shared by states. A fragment has its own flows.
    fn is_defined_inside(&self, scope: ScopeId, id: DefId) -> bool {
        let def = self.index.def(id);
        use DefKind::{Given, Input, Local, Output, Param};
        match def.kind {
            Given | Input | Param => true,
            Local | Output => self.shares(scope, def.parent),
            _ => false,
        }
    }

    /// Returns whether a scope is a state of an automaton in `parent`, directly or nested.
    fn shares(&self, scope: ScopeId, parent: Option<DefId>) -> bool {
        let owner = |id: DefId| Some(self.index.def(id)).filter(|def| def.kind == DefKind::State);
        let innermost = self.index.scope(scope).owner.and_then(owner);
        let mut states = std::iter::successors(innermost, |state| owner(state.parent?));
        states.any(|state| state.parent == parent)
    }

    fn block(&mut self, at: At<'a>, fragment: &'a FragmentDecl) {
        let signature = &fragment.signature;
        let scope = self.enclosed(at, &signature.name, DefKind::Block);
        // The activation is evaluated in the enclosing scope.
        let when = fragment.when.iter().map(|when| &when.condition);
        self.exprs(at.scope, when.chain(&fragment.budget));
        let outputs = signature.outputs.as_deref().unwrap_or_default();
        self.vars(scope, outputs, DefKind::Output);
        self.contract(scope, fragment.contract.as_ref());
        self.body(scope, &fragment.body);
    }

    /// Defines a block inside a body and returns its scope.
    fn enclosed(&mut self, at: At<'a>, name: &'a Ident, kind: DefKind) -> ScopeId {
        let def = self.define(at, name, kind);
        let scope = self.inner(at, def);
        self.index.inside[def.0 as usize].members = Some(scope);
        scope
    }

    fn automaton(&mut self, at: At<'a>, automaton: &'a Automaton) {
        let states: Vec<ScopeId> = automaton
            .states
            .iter()
            .map(|state| {
                let at = At {
                    whole: state.span,
                    doc: state.doc.as_ref(),
                    ..at
                };
                self.enclosed(at, &state.name, DefKind::State)
            })
            .collect();
        for state in &automaton.states {
            self.shared(at, state);
        }
        // Another automaton in the same body may have states with the same names.
        let names = automaton.states.iter().map(|state| &state.name.name);
        let owners = states.iter().map(|scope| self.index.scope(*scope).owner);
        let named = names.zip(owners).filter_map(|(name, id)| Some((name, id?)));
        let named: Map<&Name, DefId> = named.collect();
        for (state, scope) in automaton.states.iter().zip(states) {
            for transition in state.unless.iter().chain(&state.until) {
                if let Some(target) = named.get(&transition.target.name) {
                    self.refer(transition.target.span, *target);
                }
            }
            self.transitions(at.scope, scope, state);
            self.body(scope, &state.body);
        }
    }

    /// Defines the flows that a state defines but does not declare in the enclosing scope.
    fn shared(&mut self, at: At<'a>, state: &'a State) {
        let is_declared = |name: &Ident| declared_names(state).any(|known| known.name == name.name);
        let equations = state.body.statements.iter();
        let targets = equations.filter_map(|statement| match &statement.kind {
            StatementKind::Equation(equation) => Some((statement, equation)),
            _ => None,
        });
        for (statement, equation) in targets {
            let at = At {
                whole: statement.span,
                doc: statement.doc.as_ref(),
                ..at
            };
            let plain = |target: &&'a Target| target.path.is_empty();
            let names = equation.targets.iter().filter(plain).map(|t| &t.name);
            for name in names.filter(|name| !is_declared(name)) {
                self.target(at, name, equation);
            }
        }
    }

    /// Strong transitions are evaluated in the enclosing scope, weak ones in the scope of the state.
    fn transitions(&mut self, around: ScopeId, inside: ScopeId, state: &'a State) {
        let mut all = |scope: ScopeId, transitions: &'a [Transition]| {
            let conditions = transitions.iter().flat_map(|one| &one.condition);
            self.exprs(scope, conditions);
        };
        all(around, &state.unless);
        all(inside, &state.until);
    }
}

fn declared_names<'a>(state: &'a State) -> impl Iterator<Item = &'a Ident> {
    state.body.locals.iter().flat_map(|section| {
        let names: Vec<&'a Ident> = match section {
            Locals::Var(vars) => vars.iter().flat_map(|var| &var.names).collect(),
            Locals::Const(defs) => defs.iter().flat_map(|def| &def.names).collect(),
        };
        names
    })
}
