//! Targets: the left sides of equations.

use super::body::Body;
use super::locals::Local;
use super::order::Goal;
use super::report::{Wanted, unknown};
use super::spread;
use crate::program::Lookup;
use crate::ty::{Subst, Ty, fit, join};
use crate::typed::{Equation, ExprId, FlowId, FlowRole, Place, Target, UnitKind};
use rpi_diag::counted;
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::ast::{self, Ident};
use smallvec::SmallVec;

impl<'a> Body<'_, 'a> {
    /// Checks the value of an equation against its targets.
    pub(super) fn check_equation(&mut self, index: usize) {
        let value = self.value_of(index);
        let (goal, span) = (self.pending[index].goal, self.pending[index].span);
        let count = match goal {
            Goal::Targets(targets) => targets.len(),
            Goal::Var(_) => 1,
        };
        let mut parts: SmallVec<[Ty; 1]> = match goal {
            Goal::Targets(targets) if count > 1 => {
                let wanted = targets.iter().map(|target| self.declared_type(target));
                let wanted: Vec<Option<&Ty>> = wanted.collect();
                let pieces = spread::pieces(std::slice::from_ref(self.ty_of(value)), &wanted);
                pieces.into_iter().map(|piece| piece.ty).collect()
            }
            _ => SmallVec::from([self.ty_of(value).clone()]),
        };
        if parts.len() != count && !self.ty_of(value).is_unknown() {
            return self.wrong_count(index, value, count, parts.len());
        }
        parts.resize(count, Ty::Unknown);
        let targets = match goal {
            Goal::Targets(targets) => {
                let targets = targets.iter().zip(&parts);
                targets
                    .map(|(target, ty)| self.target(target, ty, value))
                    .collect()
            }
            Goal::Var(flow) => vec![self.var_target(flow, &parts[0], value)],
        };
        self.current().equations.push(Equation {
            targets,
            value,
            span,
        });
    }

    /// Returns the type of the flow that a target defines as a whole, if it is known.
    fn declared_type(&self, target: &ast::Target) -> Option<&Ty> {
        let flow = self.local_flow(&target.name.name)?;
        let ty = &self.unit.flow(flow).ty;
        (target.path.is_empty() && !ty.has_unknown()).then_some(ty)
    }

    fn wrong_count(&mut self, index: usize, value: ExprId, targets: usize, parts: usize) {
        let span = self.pending[index].span;
        let at = self.span_of(value);
        let finding = Finding::new(
            Code::RPI1010,
            format!(
                "{} {} defined by {}",
                counted(targets, "flow"),
                if targets == 1 { "is" } else { "are" },
                counted(parts, "value")
            ),
        )
        .at(at, format!("this gives {}", counted(parts, "value")))
        .also(span, format!("{} on the left", counted(targets, "flow")));
        // It is not known which target lacks its value, so no further errors are reported for any of them.
        let introduced = self.pending[index].introduces.iter().flatten();
        self.broken.extend(introduced.copied());
        if let Goal::Targets(targets) = self.pending[index].goal {
            let declared = targets.iter().filter_map(|t| self.local_flow(&t.name.name));
            let declared: Vec<FlowId> = declared.collect();
            self.broken.extend(declared);
        }
        self.report(finding);
    }

    /// Checks a target, whose type must match the type of the value.
    fn target(&mut self, target: &'a ast::Target, found: &Ty, value: ExprId) -> Target {
        let (place, expected) = self.place(target);
        self.fitting_target(place, expected, target.span, found, value)
    }

    fn var_target(&mut self, flow: FlowId, found: &Ty, value: ExprId) -> Target {
        let expected = self.unit.flow(flow).ty.clone();
        let span = self.unit.flow(flow).span;
        self.fitting_target(Place::Flow { flow, at: 0 }, expected, span, found, value)
    }

    fn fitting_target(
        &mut self,
        place: Place,
        expected: Ty,
        span: Span,
        found: &Ty,
        value: ExprId,
    ) -> Target {
        let mut ty = expected.clone();
        let is_all = self.ty_of(value) == found;
        if is_all {
            self.suits(value, &expected);
        }
        let now = self.ty_of(value).clone();
        let found = if is_all { &now } else { found };
        match fit(&expected, found, &mut Subst::default()) {
            Ok(()) => {
                self.angle_has_unit(value, &expected);
                ty = join(&expected, found).unwrap_or(ty);
            }
            Err(misfit) => {
                let text = format!("the target has the type `{expected}`");
                self.misfit(value, &expected, &misfit, &Wanted::By(span, text));
            }
        }
        Target { place, ty, span }
    }

    fn place(&mut self, target: &'a ast::Target) -> (Place, Ty) {
        let name = &target.name;
        match self.find_local(&name.name) {
            Some(Local::Flow(flow)) => self.place_in_flow(self.defined_here(flow), target),
            Some(Local::Constant(_)) => self.not_definable(name, "a constant"),
            Some(Local::Block(_)) => self.not_definable(name, "a fragment"),
            Some(Local::State(_) | Local::States(..)) => self.not_definable(name, "a state"),
            None if name.name == "_" => (Place::Nowhere, Ty::Unknown),
            None => self.no_place(name, !target.path.is_empty()),
        }
    }

    /// Handles a target whose name is not declared in this body.
    fn no_place(&mut self, name: &Ident, in_part: bool) -> (Place, Ty) {
        if let Lookup::Found(id) = self.c.program.lookup(self.module, &name.name) {
            return self.not_definable(name, self.c.program.decl(id).kind.what());
        }
        let help = match in_part && self.unit.kind == UnitKind::Command {
            true => "declare the device as a parameter of the command: `command C (arm: Arm)`",
            false => "declare flows after `returns` or `var`",
        };
        let told = self.unknown.place(&name.name);
        if self.is_new_unknown(&name.name) {
            let near = self.c.suggest(&name.name, self.local_names());
            // That the intended flow has no equation is the same error.
            let meant = near.as_ref().and_then(|near| self.local_flow(near));
            self.broken.extend(meant);
            let finding = unknown("flow", &name.name, name.span, near);
            self.report(finding.help(help));
        } else if let Some(told) = told {
            self.say_what_to_do(told, name, help);
        }
        (Place::Nowhere, Ty::Unknown)
    }

    /// Adds a help text to the earlier diagnostic about a read of an undefined flow, if it has no other help.
    fn say_what_to_do(&mut self, told: usize, name: &Ident, help: &str) {
        let alike = unknown("flow", &name.name, name.span, None);
        let told = self.findings.get_mut(told);
        let told = told.filter(|told| told.code == alike.code && told.message == alike.message);
        if let Some(told) = told.filter(|told| told.help.is_empty() && told.fixes.is_empty()) {
            told.help.push(help.to_owned());
        }
    }

    /// Returns the type of a flow; a flow that several states define has one type in all of them.
    fn shared_type(&self, flow: FlowId) -> &Ty {
        let all = self.shared_around(flow).chain([flow]);
        let mut types = all.map(|flow| &self.unit.flow(flow).ty);
        let told = types.find(|ty| !ty.has_unknown());
        told.unwrap_or(&self.unit.flow(flow).ty)
    }

    fn place_in_flow(&mut self, flow: FlowId, target: &'a ast::Target) -> (Place, Ty) {
        if let Some(device) = self.unit.device(flow).cloned() {
            return self.actuator(flow, &device, target);
        }
        let what = match self.unit.flow(flow).role {
            FlowRole::Input | FlowRole::Given => Some("an in-port"),
            FlowRole::Param => Some("a parameter"),
            FlowRole::Output | FlowRole::Local => None,
        };
        let ty = self.shared_type(flow).clone();
        if what.is_some() && self.broken.contains(&flow) {
            return (Place::Nowhere, Ty::Unknown);
        }
        if let Some(what) = what {
            // A parameter of an unknown type may be a device.
            return match ty.is_unknown() && !target.path.is_empty() {
                true => (Place::Nowhere, Ty::Unknown),
                false => self.not_definable(&target.name, what),
            };
        }
        if self.is_part_around(flow, target) {
            return (Place::Nowhere, Ty::Unknown);
        }
        match self.path_in(&ty, 0, &target.path) {
            Some((at, ty)) => (Place::Flow { flow, at }, ty),
            None => (Place::Nowhere, Ty::Unknown),
        }
    }

    /// Whether a target is a part of a flow of a surrounding block, which is active while this block is not. Reports it
    /// once for each flow.
    fn is_part_around(&mut self, flow: FlowId, target: &ast::Target) -> bool {
        if self.unit.flow(flow).block == self.block {
            return false;
        }
        if !self.broken.contains(&flow) {
            self.broken.push(flow);
            let name = &target.name.name;
            let block = self.unit.block(self.block).name.clone();
            let declared = self.unit.flow(flow).span;
            let message = format!("`{name}` is defined in parts inside of `{block}`");
            let finding = Finding::new(Code::RPI1008, message)
                .at(
                    target.span,
                    format!("takes effect only while `{block}` is active"),
                )
                .also(declared, "declared outside of it, to be defined as a whole")
                .help(format!("define it in one equation: `{name} = ...;`"));
            self.report(finding);
        }
        true
    }

    fn not_definable(&mut self, name: &Ident, what: &str) -> (Place, Ty) {
        let finding = Finding::new(Code::RPI1003, format!("`{}` is {what}", name.name))
            .at(name.span, format!("{what} cannot be defined here"))
            .help(format!(
                "use another name for the new flow: `{}_new = ...;`",
                name.name
            ));
        self.report(finding);
        (Place::Nowhere, Ty::Unknown)
    }
}
