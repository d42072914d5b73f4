//! What a command takes over (`given`), each command that it may follow exports under the same name (M7.3).

use super::{Labels, Then};
use crate::check::body::Body;
use crate::program::DeclKind;
use crate::ty::{Misfit, Subst, Ty, fit};
use crate::typed::{BlockId, FlowId, FlowRole, Handed, UnitId, UnitKind};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Name;
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

/// What a command takes over and has no default for.
struct Taken {
    flow: FlowId,
    name: Name,
    ty: Ty,
    declared: Span,
}

impl<'a> Body<'_, 'a> {
    /// Checks that all that commands take over is there: a missing value is reported once for a step. What is there may
    /// still be absent, which is known later.
    pub(super) fn hand_over(&mut self, follows: &[Follows<'a>]) {
        let mut told: Vec<(Span, Name)> = Vec::new();
        for (before, run) in follows {
            let Some(step) = self.step_of(run).filter(|step| self.is_command(*step)) else {
                continue;
            };
            for taken in self.taken_over(self.unit.steps[step].unit) {
                let key = (run.callee.span, taken.name.clone());
                if told.contains(&key) {
                    continue;
                }
                match self.handed(&taken, before, run) {
                    Ok(handed) => self.unit.steps[step].handed.extend(handed),
                    Err(finding) => {
                        self.report(*finding);
                        told.push(key);
                    }
                }
            }
        }
    }

    /// Where a value comes from that a step takes over from those before it; or what is wrong with that.
    fn handed(
        &mut self,
        taken: &Taken,
        before: &Before<'a>,
        run: &Run,
    ) -> Result<Vec<Handed>, Box<Finding>> {
        match before {
            Before::Nothing => Err(Box::new(
                not_handed(taken, run)
                    .help("no command runs before it; make it a parameter of the command"),
            )),
            Before::Run(before) => self.handed_by_all(taken, &[before], run),
            Before::Strands(strands) => {
                let mut wrong = None;
                for ends in strands.iter().filter(|ends| !ends.is_empty()) {
                    match self.handed_by_all(taken, ends, run) {
                        Ok(handed) => return Ok(handed),
                        Err(finding) => wrong = wrong.or(Some(finding)),
                    }
                }
                wrong.map_or(Ok(Vec::new()), Err)
            }
        }
    }

    /// Each of several commands hands a value over; what an inner task ends with is its own business.
    fn handed_by_all(
        &mut self,
        taken: &Taken,
        before: &[&Run],
        run: &Run,
    ) -> Result<Vec<Handed>, Box<Finding>> {
        let mut all = Vec::new();
        for before in before {
            if let Some(unit) = self.command_of(before) {
                all.push(self.handed_by(taken, (unit, before.callee.span), run)?);
            }
        }
        Ok(all)
    }

    /// The command that a step runs, once its arguments are known.
    pub(super) fn command_of(&self, run: &Run) -> Option<UnitId> {
        let step = self.step_of(run).filter(|step| self.is_command(*step))?;
        Some(self.unit.steps[step].unit)
    }

    /// The step that is made of a run, once its arguments are known.
    fn step_of(&self, run: &Run) -> Option<usize> {
        let mut steps = self.unit.steps.iter();
        steps.position(|step| step.span == run.callee.span)
    }

    fn is_command(&self, step: usize) -> bool {
        let decl = self.c.program.decl(self.unit.steps[step].decl);
        matches!(decl.kind, DeclKind::Command(_))
    }

    fn taken_over(&mut self, unit: UnitId) -> Vec<Taken> {
        self.c.check_now(unit);
        let unit = &self.c.units[unit.0 as usize];
        let flows = unit.inputs.iter().map(|id| (*id, unit.flow(*id)));
        let given =
            flows.filter(|(_, flow)| flow.role == FlowRole::Given && flow.default.is_none());
        given
            .map(|(id, flow)| Taken {
                flow: id,
                name: flow.name.clone(),
                ty: flow.ty.clone(),
                declared: flow.span,
            })
            .collect()
    }

    fn handed_by(
        &mut self,
        taken: &Taken,
        (before, span): (UnitId, Span),
        run: &Run,
    ) -> Result<Handed, Box<Finding>> {
        let Taken { flow, name, ty, .. } = taken;
        self.c.check_now(before);
        let unit = &self.c.units[before.0 as usize];
        debug_assert!(unit.kind == UnitKind::Command);
        let mut exports = unit.block(BlockId::ROOT).exports.iter().enumerate();
        let Some((index, export)) = exports.find(|(_, export)| export.key == name.as_str()) else {
            let help = format!("write `export {name};` in `{}`", unit.name);
            let finding = not_handed(taken, run).also(span, "this runs before it");
            return Err(Box::new(finding.help(help)));
        };
        let found = &unit.expr(export.value).ty;
        let [wanted, handed] = [ty, found].map(|ty| crate::check::outside_type(ty).0);
        match fit(&wanted, &handed, &mut Subst::default()) {
            // Frames are named after the parameters of each command.
            Ok(()) | Err(Misfit::Frame { .. }) => Ok(Handed {
                flow: *flow,
                by: before,
                export: index,
                span,
            }),
            Err(_) => {
                let text = format!("this `{name}` is `{found}`, `{ty}` is wanted");
                Err(Box::new(not_handed(taken, run).also(export.span, text)))
            }
        }
    }
}

fn not_handed(taken: &Taken, run: &Run) -> Finding {
    let (name, command) = (&taken.name, &run.callee.name.name);
    Finding::new(
        Code::RPI8004,
        format!("`{command}` takes `{name}` over, and nothing hands it over"),
    )
    .at(run.callee.span, format!("`{name}` has no value here"))
    .also(taken.declared, "taken over from the predecessor")
}
