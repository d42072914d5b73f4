//! Names in expressions.

use super::Constant;
use super::body::Body;
use super::foreign;
use super::locals::Local;
use super::report::{listed, not_a, unknown};
use super::statics::Static;
use crate::program::{Decl, DeclId, DeclKind, Lookup, Space};
use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, FlowId, Kind, Leaf, UnitKind};
use rpi_diag::{Code, Finding, Span};
use rpi_net::prim;
use rpi_prims::PrimId;
use rpi_syntax::Name;
use rpi_syntax::ast::{self, CommandDecl, ExprKind};

/// A predeclared flow: name, primitive, type, and whether only commands have it.
pub(super) struct Predeclared {
    pub(super) name: &'static str,
    pub(super) prim: PrimId,
    pub(super) ty: Ty,
    of_command: bool,
}

/// All predeclared flows.
pub(super) const PREDECLARED: &[Predeclared] = &[
    flow("cancel", prim!("Cancel"), Ty::Bool, true),
    flow("takeover", prim!("Takeover"), Ty::Bool, true),
    flow("predecessor", prim!("Rpi::Predecessor"), Ty::Result, true),
    flow("first", prim!("Rpi::First"), Ty::Bool, false),
    flow("time", prim!("Rpi::Elapsed"), Ty::Duration, false),
    flow("dt", prim!("Rpi::PeriodTicks"), Ty::Duration, false),
];

const fn flow(name: &'static str, prim: PrimId, ty: Ty, of_command: bool) -> Predeclared {
    Predeclared {
        name,
        prim,
        ty,
        of_command,
    }
}

/// Returns the name of the predeclared flow that a primitive computes.
pub(crate) fn predeclared_name(prim: &str) -> Option<&'static str> {
    let flow = PREDECLARED
        .iter()
        .find(|flow| flow.prim.desc().name == prim);
    flow.map(|flow| flow.name)
}

impl<'a> Body<'_, 'a> {
    /// Resolves a plain or qualified name.
    pub(super) fn name(&mut self, name: &Name, span: Span) -> ExprId {
        if let Some(bound) = self.bound_name(name, span) {
            return bound;
        }
        if let Some(mode) = name.strip_prefix("::") {
            return self.mode_applies(mode, span);
        }
        if let Some(local) = self.find_local(name) {
            return self.local(name, &local, span);
        }
        match self.statics.get(name) {
            Some(Static::Value(constant)) => {
                self.statics_read += 1;
                let constant = constant.clone();
                return self.constant_expr(&constant, span);
            }
            Some(_) => return self.not_a_flow(name, "a static parameter", span, span),
            None => {}
        }
        match self.c.program.lookup_in(Space::Value, self.module, name) {
            Lookup::Found(id) => self.declared(id, span),
            Lookup::Missing => self.predeclared(name, span),
        }
    }

    fn local(&mut self, name: &Name, local: &Local, span: Span) -> ExprId {
        match local {
            Local::Flow(flow) => self.flow_expr(*flow, span),
            Local::Constant(constant) => self.constant_expr(constant, span),
            // Fragments and states are not flows. A state may share its name with the constant or enum value that holds
            // in it.
            _ if let Some(value) = self.value_called(name) => self.declared(value, span),
            Local::Block(block) => self.not_a_value(name, "a fragment", *block, span),
            Local::State(block) => self.not_a_value(name, "a state", *block, span),
            Local::States(places, _) => self.one_of_several_states(name, *places, span),
        }
    }

    fn not_a_value(&mut self, name: &Name, what: &str, block: BlockId, span: Span) -> ExprId {
        let declared = self.unit.block(block).span;
        let finding = not_a("a flow", name, what, span, declared)
            .help(format!("read one of its flows: `{name}.x`"));
        self.fault_with(finding, span)
    }

    /// Reports a name that is a state of several automata and is read outside of them.
    pub(super) fn one_of_several_states(
        &mut self,
        name: &Name,
        [first, second]: [Span; 2],
        span: Span,
    ) -> ExprId {
        let message = format!("`{name}` is a state of more than one automaton");
        let finding = Finding::new(Code::RPI1002, message)
            .at(span, "ambiguous name")
            .also(first, "one candidate")
            .also(second, "another candidate")
            .help("give one of them another name");
        self.fault_with(finding, span)
    }

    /// Returns the constant or enum value of this name.
    fn value_called(&self, name: &Name) -> Option<DeclId> {
        let Lookup::Found(id) = self.c.program.lookup_in(Space::Value, self.module, name) else {
            return None;
        };
        let kind = &self.c.program.decl(id).kind;
        matches!(kind, DeclKind::Const(_) | DeclKind::EnumValue { .. }).then_some(id)
    }

    /// Adds an expression that reads a flow.
    pub(super) fn flow_expr(&mut self, flow: FlowId, span: Span) -> ExprId {
        if self.inferring {
            self.is_missing(flow, span);
        }
        let ty = self.unit.flow(flow).ty.clone();
        self.add(Kind::Flow(flow), ty, span)
    }

    /// Adds an expression for a constant.
    pub(super) fn constant_expr(&mut self, constant: &Constant, span: Span) -> ExprId {
        let kind = match &constant.leaves[..] {
            [one] => Kind::Literal(one.clone()),
            _ => Kind::Const(constant.leaves.clone()),
        };
        // Constants are evaluated without a known tick length, so times are in seconds there.
        let ty = match &constant.ty {
            Ty::Duration if self.unit.kind == UnitKind::Constant => super::time::SECONDS,
            ty => ty.clone(),
        };
        self.add(kind, ty, span)
    }

    fn declared(&mut self, id: DeclId, span: Span) -> ExprId {
        let decl = self.c.program.decl(id).clone();
        match decl.kind {
            DeclKind::Const(_) => match self.c.constant(id) {
                Some(constant) => self.constant_expr(&constant, span),
                None => self.fault(span),
            },
            DeclKind::EnumValue { ty, index } => {
                let ty = self.c.type_decl(ty);
                self.add(Kind::Literal(Leaf::int(index.into())), ty, span)
            }
            DeclKind::Constructor { ty, index } => self.construct((ty, index), &[], &[], span),
            DeclKind::Broken(_) => self.fault(span),
            DeclKind::Frame(frame) => match self.c.constant(id) {
                Some(constant) => self.constant_expr(&constant, span),
                None if frame.pose.is_some() => self.fault(span),
                None => {
                    let finding = not_a("a flow", &decl.name, "a frame", span, decl.span);
                    self.fault_with(
                        finding.help(format!(
                            "declare its pose: `frame {0} in world = pose(...);`",
                            decl.name
                        )),
                        span,
                    )
                }
            },
            kind => self.not_a_flow(&decl.name, kind.what(), span, decl.span),
        }
    }

    fn not_a_flow(&mut self, name: &str, is: &str, span: Span, declared: Span) -> ExprId {
        self.fault_with(not_a("a flow", name, is, span, declared), span)
    }

    fn predeclared(&mut self, name: &Name, span: Span) -> ExprId {
        if name == "none" {
            return self.add(Kind::None, Ty::Unknown, span);
        }
        let found = PREDECLARED.iter().find(|flow| name == flow.name);
        match found.filter(|_| self.is_rpi()) {
            Some(flow) if flow.of_command && self.unit.kind == UnitKind::Function => {
                self.no_command(flow.name, span)
            }
            Some(flow) => {
                if !flow.of_command {
                    self.has_state(span);
                }
                self.nullary(flow.prim, flow.ty.clone(), span)
            }
            None => self.unknown_flow(name, span),
        }
    }

    fn no_command(&mut self, name: &str, span: Span) -> ExprId {
        let finding = Finding::new(Code::RPI3005, format!("a function cannot read `{name}`"))
            .at(span, "it belongs to the running command")
            .help("pass it to the function as an argument, or declare the function as a node");
        self.fault_with(finding, span)
    }

    fn unknown_flow(&mut self, name: &Name, span: Span) -> ExprId {
        if let Some(value) = self.value_by_path(name, span) {
            return value;
        }
        if !self.is_new_unknown(name) {
            return self.fault(span);
        }
        let near = self.c.suggest(name, self.local_names());
        let is_value = |id: DeclId| {
            let kind = self.c.program.decl(id).kind;
            matches!(kind, DeclKind::Const(_) | DeclKind::EnumValue { .. })
        };
        let near = near.or_else(|| {
            self.c
                .suggest(name, self.c.program.visible(self.module, is_value))
        });
        if self.unit.kind == UnitKind::Task {
            let finding = unknown("device or parameter", name, span, near);
            self.report(finding.help(format!(
                "declare the devices of a task as its parameters: `task {} (arm: Arm)`",
                self.unit.name
            )));
            return self.fault(span);
        }
        let predeclared = PREDECLARED.iter().map(|flow| flow.name);
        let values = ["true", "false", "none"].into_iter();
        let is_near = near.is_some();
        let near = near.or_else(|| rpi_diag::suggest(name, predeclared.chain(values)));
        if let Some(help) = foreign::no_value(name).filter(|_| !is_near) {
            let finding = unknown(super::unknown::FLOW, name, span, None);
            self.report(finding.help(help));
            return self.fault(span);
        }
        let is_meant = |_: &&str| !is_near || !foreign::is_loose(name);
        match foreign::value_here(name).filter(is_meant) {
            Some(here) => self.other_name("value", name, span, here),
            None => self.unknown_name(super::unknown::FLOW, name, span, near),
        }
        self.fault(span)
    }

    /// Resolves `MoveToC.at_b`, the identity of a command's result; returns `None` if the name is not a command.
    pub(super) fn result_of(
        &mut self,
        name: &Name,
        field: &ast::Ident,
        span: Span,
    ) -> Option<ExprId> {
        if self.find_local(name).is_some() {
            return None;
        }
        let Lookup::Found(id) = self.c.program.lookup(self.module, name) else {
            return None;
        };
        let Decl { kind, .. } = self.c.program.decl(id);
        let DeclKind::Command(command) = *kind else {
            return None;
        };
        let results = results_of(command);
        if !results.contains(&&field.name) {
            let near = rpi_diag::suggest(&field.name, results.iter().map(|name| name.as_str()));
            let of = format!("the command `{name}`");
            let finding =
                super::report::no_member(&of, &field.name, field.span, near).help(format!(
                    "its results are {}",
                    listed(results.iter().map(|n| n.as_str()))
                ));
            return Some(self.fault_with(finding, span));
        }
        let identity = result_identity(&format!("{name}.{}", field.name));
        Some(self.add(Kind::Literal(Leaf::int(identity)), Ty::Result, span))
    }

    /// Resolves a name with parts, as in `export a.b`.
    pub(super) fn dotted(&mut self, dotted: &'a ast::Dotted) -> ExprId {
        let [first, rest @ ..] = &dotted.parts[..] else {
            return self.fault(dotted.span);
        };
        if let (Some(Local::Block(block) | Local::State(block)), [field, after @ ..]) =
            (self.find_local(&first.name), rest)
        {
            let of_block = self.flow_of_block(block, field, first.span.merge(field.span));
            return after
                .iter()
                .fold(of_block, |base, field| self.member(base, field));
        }
        let base = self.name(&first.name, first.span);
        rest.iter()
            .fold(base, |base, field| self.member(base, field))
    }
}

/// Returns the names of a command's results in text order.
pub(crate) fn results_of(command: &CommandDecl) -> Vec<&Name> {
    let ends = ends_of(command).into_iter();
    ends.map(|end| &end.result.name).collect()
}

/// Returns the statements that end a command, in text order.
pub(crate) fn ends_of(command: &CommandDecl) -> Vec<&ast::End> {
    let statements = command.body.statements.iter();
    let ends = statements.filter_map(|statement| match &statement.kind {
        ast::StatementKind::End(end) => Some(end.as_ref()),
        _ => None,
    });
    ends.collect()
}

/// Returns the run-time identity of a result: the 64-bit FNV-1a hash (Fowler, Noll, Vo) of `Command.result`.
#[must_use]
pub fn result_identity(path: &str) -> i64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    path.bytes().fold(0xcbf2_9ce4_8422_2325, step).cast_signed()
}

/// Returns the name of an expression that is only a name, ignoring parentheses.
pub(super) fn plain_name(expr: &ast::Expr) -> Option<&Name> {
    match &expr.unparen().kind {
        ExprKind::Name(name) => Some(name),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identities_are_those_of_fnv_1a() {
        assert_eq!(result_identity("").cast_unsigned(), 0xcbf2_9ce4_8422_2325);
        assert_eq!(result_identity("a").cast_unsigned(), 0xaf63_dc4c_8601_ec8c);
    }
}
