//! What a command takes over (`given`), each command that it may follow exports under the same name (M7.3).

use super::{Labels, Then};
use crate::check::body::Body;
use crate::program::DeclKind;
use crate::ty::{Misfit, Subst, Ty, fit};
use crate::typed::{BlockId, FlowRole, UnitId, UnitKind};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::ast::{Next, Run};

/// What runs before a step.
pub(super) enum Before<'a> {
    /// It may come first.
    Nothing,
    /// This.
    Run(&'a Run),
    /// For each strand what it can end with: a value comes from the first that has it at each of its ends.
    Strands(Vec<Vec<&'a Run>>),
}

/// A step and what it may follow.
pub(super) type Follows<'a> = (Before<'a>, &'a Run);

/// The steps that may follow a step by itself.
pub(super) fn followers<'a>(
    run: &'a Run,
    next: &Then<'a>,
    labels: &Labels<'a>,
) -> Vec<Follows<'a>> {
    let by_branch = run.branches.iter().filter_map(|branch| match &branch.then {
        Next::Step(label) => {
            let mut known = labels.iter().rev();
            known.find(|(known, _)| known.name == label.name)
        }
        Next::End(_) => None,
    });
    let is_followed = run.branches.is_empty() && !next.joins;
    let in_turn = next.runs.iter().filter(|_| is_followed).copied();
    let all = by_branch.map(|(_, run)| *run).chain(in_turn);
    all.map(|follower| (Before::Run(run), follower)).collect()
}

impl<'a> Body<'_, 'a> {
    /// Checks that all that commands take over is there: a missing value is reported once for a step.
    pub(super) fn hand_over(&mut self, follows: &[Follows<'a>]) {
        let mut told: Vec<(Span, String)> = Vec::new();
        for (before, run) in follows {
            let Some(unit) = self.command_of(run) else {
                continue;
            };
            for (name, ty, declared) in self.taken_over(unit) {
                let key = (run.callee.span, name.clone());
                if told.contains(&key) {
                    continue;
                }
                if let Some(finding) = self.not_there((&name, &ty, declared), before, run) {
                    self.report(finding);
                    told.push(key);
                }
            }
        }
    }

    /// What is wrong with a value that a step takes over from those before it, if something is.
    fn not_there(
        &mut self,
        value: (&str, &Ty, Span),
        before: &Before<'a>,
        run: &Run,
    ) -> Option<Finding> {
        match before {
            Before::Nothing => self.not_handed(value, None, run),
            Before::Run(before) => self.not_handed_by(value, before, run),
            Before::Strands(strands) => {
                let mut wrong = None;
                for ends in strands.iter().filter(|ends| !ends.is_empty()) {
                    let mut ends = ends.iter();
                    match ends.find_map(|end| self.not_handed_by(value, end, run)) {
                        Some(finding) => wrong = wrong.or(Some(finding)),
                        None => return None,
                    }
                }
                wrong
            }
        }
    }

    /// As [`Body::not_handed`]; what an inner task ends with is its own business.
    fn not_handed_by(
        &mut self,
        value: (&str, &Ty, Span),
        before: &Run,
        run: &Run,
    ) -> Option<Finding> {
        let unit = self.command_of(before)?;
        self.not_handed(value, Some((unit, before.callee.span)), run)
    }

    /// The command that a step runs, once its arguments are known.
    pub(super) fn command_of(&self, run: &Run) -> Option<UnitId> {
        let mut steps = self.unit.steps.iter();
        let step = steps.find(|step| step.span == run.callee.span)?;
        let is_command = matches!(self.c.program.decl(step.decl).kind, DeclKind::Command(_));
        is_command.then_some(step.unit)
    }

    /// What a command takes over and has no default: names, types, where they are declared.
    fn taken_over(&mut self, unit: UnitId) -> Vec<(String, Ty, Span)> {
        self.c.check_now(unit);
        let unit = &self.c.units[unit.0 as usize];
        let flows = unit.inputs.iter().map(|id| unit.flow(*id));
        let given = flows.filter(|flow| flow.role == FlowRole::Given && flow.default.is_none());
        given
            .map(|flow| (flow.name.to_string(), flow.ty.clone(), flow.span))
            .collect()
    }

    fn not_handed(
        &mut self,
        (name, ty, declared): (&str, &Ty, Span),
        before: Option<(UnitId, Span)>,
        run: &Run,
    ) -> Option<Finding> {
        let command = &run.callee.name.name;
        let finding = Finding::new(
            Code::RPI8004,
            format!("`{command}` takes `{name}` over, and nothing hands it over"),
        );
        let finding = finding
            .at(run.callee.span, format!("`{name}` has no value here"))
            .also(declared, "taken over from the predecessor");
        let Some((before, span)) = before else {
            return Some(
                finding.help("no command runs before it; make it a parameter of the command"),
            );
        };
        self.c.check_now(before);
        let unit = &self.c.units[before.0 as usize];
        debug_assert!(unit.kind == UnitKind::Command);
        let exports = &unit.block(BlockId::ROOT).exports;
        let Some(export) = exports.iter().find(|export| export.key == name) else {
            let help = format!("write `export {name};` in `{}`", unit.name);
            return Some(finding.also(span, "this runs before it").help(help));
        };
        let found = &unit.expr(export.value).ty;
        match fit(ty, found, &mut Subst::default()) {
            // Frames are named after the parameters of each command.
            Ok(()) | Err(Misfit::Frame { .. }) => None,
            Err(_) => {
                let text = format!("this `{name}` is `{found}`, `{ty}` is wanted");
                Some(finding.also(export.span, text))
            }
        }
    }
}
