//! Contracts that a contract takes up, and `::c::m`, whether a mode of one applies.
//!
//! Each is an instance of its own, which only claims: in it the out-ports of the contract are in-ports. It gives out
//! whether its modes apply, for those around it to read.

use super::body::Body;
use super::report::unknown;
use crate::ty::Ty;
use crate::typed::{BlockId, Equation, ExprId, FlowRole, Kind, Optional, Place, Target};
use rpi_diag::Span;
use rpi_syntax::ast::{self, Contract, ContractImport, Ident};

/// So many modes of the contracts that a contract takes up can be asked for.
const MAX_MODES: usize = 1000;

/// The longest path to a mode, `::c::d::m`, in steps: every contract gives out all paths that begin at it.
const MAX_PATH: usize = 16;

/// A contract that is taken up.
#[derive(Clone, Copy)]
pub(super) struct Import<'a> {
    text: &'a ContractImport,
    /// The contract that takes it up.
    by: BlockId,
    /// Its instance, as soon as something needs it.
    call: Option<ExprId>,
}

impl Import<'_> {
    fn name(&self) -> Option<&Ident> {
        match &self.text.call.kind {
            ast::ExprKind::Call(call) => Some(&call.callee.name),
            _ => None,
        }
    }
}

impl<'a> Body<'_, 'a> {
    /// Notes what a contract takes up; the current block is the contract's.
    pub(super) fn declare_imports(&mut self, contract: &'a Contract) {
        let by = self.block;
        let imports = contract.imports.iter();
        self.imports.extend(imports.map(|text| Import {
            text,
            by,
            call: None,
        }));
    }

    /// The instances of the contracts that a contract takes up. Gives what goes into them.
    pub(super) fn check_imports(&mut self, block: BlockId) -> Vec<ExprId> {
        let mut given = Vec::new();
        for at in 0..self.imports.len() {
            if self.imports[at].by == block {
                let call = self.instance_of_import(at);
                given.extend(self.goes_into(call).unwrap_or_default());
            }
        }
        given
    }

    /// What goes into a contract that is taken up, if this is whether one of its modes applies.
    pub(super) fn mode_of(&self, kind: &Kind) -> Option<Vec<ExprId>> {
        match kind {
            Kind::Part { base, .. } => self.goes_into(*base),
            _ => None,
        }
    }

    /// What goes into a contract that is taken up, if the expression is its instance.
    fn goes_into(&self, instance: ExprId) -> Option<Vec<ExprId>> {
        let mut imports = self.imports.iter();
        let import = imports.find(|import| import.call == Some(instance))?;
        let Kind::Call(call) = &self.unit.expr(instance).kind else {
            return None;
        };
        let given = call.args.iter().take(import.text.inputs);
        Some(given.flatten().copied().collect())
    }

    /// The instance of a contract that is taken up, which is made when it is asked for first.
    fn instance_of_import(&mut self, at: usize) -> ExprId {
        let import = self.imports[at];
        if let Some(call) = import.call {
            return call;
        }
        let around = (self.claim.take(), std::mem::take(&mut self.bound));
        let call = self.within(import.by, |body| body.import(import.text));
        (self.claim, self.bound) = around;
        self.imports[at].call = Some(call);
        call
    }

    fn import(&mut self, import: &'a ContractImport) -> ExprId {
        let span = import.call.span;
        self.importing = true;
        let value = self.expr(&import.call);
        let targets = Vec::new();
        self.current().equations.push(Equation {
            targets,
            value,
            span,
        });
        if let Kind::Call(call) = &self.unit.expr(value).kind {
            let unit = call.unit;
            self.c.check_now(unit);
            let callee = &self.c.units[unit.0 as usize];
            self.unit.exprs[value.0 as usize].ty = callee.result().widened();
            if callee.has_state {
                self.has_state(span);
            }
        }
        value
    }

    /// `::c::m`: whether a mode of a contract that is taken up applies.
    pub(super) fn imported_mode_applies(
        &mut self,
        contract: &str,
        mode: &str,
        span: Span,
    ) -> ExprId {
        let named = |import: &Import<'_>| import.name().is_some_and(|name| name.name == *contract);
        let Some(at) = self.imports.iter().position(named) else {
            let names = self.imports.iter().filter_map(Import::name);
            let near = rpi_diag::suggest(contract, names.map(|name| name.name.as_str()));
            let near = near.map(|near| format!("::{near}::{mode}"));
            let finding = unknown("imported contract", contract, span, near);
            return self.fault_with(finding, span);
        };
        let base = self.instance_of_import(at);
        let Kind::Call(call) = &self.unit.expr(base).kind else {
            return self.fault(span);
        };
        let callee = &self.c.units[call.unit.0 as usize];
        let modes: Vec<_> = callee.outputs.iter().map(|id| callee.flow(*id)).collect();
        let Some(place) = modes.iter().position(|flow| flow.name == *mode) else {
            let near = rpi_diag::suggest(mode, modes.iter().map(|flow| flow.name.as_str()));
            let near = near.map(|near| format!("::{contract}::{near}"));
            let finding = unknown("mode", &format!("{contract}::{mode}"), span, near);
            return self.fault_with(finding, span);
        };
        let at = u32::try_from(place).unwrap_or(u32::MAX);
        self.add(Kind::Part { base, at }, Ty::Bool, span)
    }

    /// A contract by itself gives out whether each of its modes applies, and those of the contracts that it takes up.
    pub(super) fn give_modes(&mut self, contract: &'a Contract) {
        let applies = std::mem::take(&mut self.applies);
        let own = contract.modes.iter().map(|mode| &mode.name);
        let own = own.zip(applies).map(|(name, value)| (name.clone(), value));
        let own: Vec<(Ident, ExprId)> = own.collect();
        for (name, value) in own.into_iter().chain(self.modes_of_imports()) {
            let span = name.span;
            let never_absent = Optional::Declared(false);
            let flow = self.add_flow(&name, Ty::Bool, never_absent, FlowRole::Output);
            let target = Target {
                place: Place::Flow { flow, at: 0 },
                ty: Ty::Bool,
                span,
            };
            self.current().equations.push(Equation {
                targets: vec![target],
                value,
                span,
            });
            self.unit.outputs.push(flow);
        }
    }

    /// `D::m` for each mode of a contract that is taken up, and whether it applies.
    fn modes_of_imports(&mut self) -> Vec<(Ident, ExprId)> {
        let mut modes = Vec::new();
        for at in 0..self.imports.len() {
            let Some((name, base)) = self.imports[at].name().zip(self.imports[at].call) else {
                continue;
            };
            let Kind::Call(call) = &self.unit.expr(base).kind else {
                continue;
            };
            let callee = &self.c.units[call.unit.0 as usize];
            let outputs = callee.outputs.iter().map(|id| callee.flow(*id));
            let names = (0..).zip(outputs.map(|flow| flow.name.as_str()));
            let names = names.filter(|(_, mode)| mode.matches("::").count() < MAX_PATH);
            let names: Vec<(u32, String)> = names
                .map(|(at, mode)| (at, format!("{}::{mode}", name.name)))
                .collect();
            let span = name.span;
            for (at, name) in names {
                if modes.len() >= MAX_MODES {
                    return modes;
                }
                let value = self.add(Kind::Part { base, at }, Ty::Bool, span);
                let name = name.as_str().into();
                modes.push((Ident { name, span }, value));
            }
        }
        modes
    }
}
