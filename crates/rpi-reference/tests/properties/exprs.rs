//! Random expressions of a given type.

use crate::forms::{FORMS, Form, Part, Use};
use crate::program::Counts;
use crate::random::Random;
use crate::tree::{Role, Tree};
use crate::types::{Kind, Ty};

/// Flow that can be read.
#[derive(Clone, Debug)]
pub(crate) struct Flow {
    pub(crate) name: String,
    pub(crate) ty: Ty,
}

/// Context of an expression.
#[derive(Clone, Debug)]
pub(crate) struct Scope {
    /// Flows that are defined before, or are inputs.
    pub(crate) known: Vec<Flow>,
    /// Flows of the same fragment that may be read through a delay.
    pub(crate) delayed: Vec<Flow>,
    /// Whether state is allowed.
    pub(crate) state: bool,
    /// Clock of the expression: the name of a flow, and the value at which it ticks.
    pub(crate) clock: Option<(String, bool)>,
}

/// Generator of expressions.
pub(crate) struct Exprs<'r> {
    pub(crate) random: &'r mut Random,
    pub(crate) counts: &'r mut Counts,
}

impl Exprs<'_> {
    /// Returns an expression of a type, not much deeper than `depth`.
    pub(crate) fn expr(&mut self, scope: &Scope, ty: Ty, depth: usize) -> Tree {
        if depth == 0 || self.random.one_in(6) {
            return self.leaf(scope, ty);
        }
        if scope.state
            && scope.clock.is_none()
            && self.random.one_in(12)
            && let Some(tree) = self.sampled(scope, ty, depth)
        {
            return tree;
        }
        let forms: Vec<&Form> = FORMS
            .iter()
            .filter(|form| usable(form, scope, ty))
            .collect();
        match forms.is_empty() {
            true => self.leaf(scope, ty),
            false => {
                let form = *self.random.pick(&forms);
                self.of_form(form, scope, ty, depth - 1)
            }
        }
    }

    fn of_form(&mut self, form: &Form, scope: &Scope, ty: Ty, depth: usize) -> Tree {
        let mut parts = Vec::with_capacity(form.parts.len());
        for part in form.parts {
            parts.push(match part {
                Part::Delayed => self.delayed(scope, part_type(*part, ty), depth),
                Part::DelayedOptional => {
                    let optional = ty.kind.optional();
                    match scope.delayed.iter().find(|flow| flow.ty == optional) {
                        Some(flow) => Tree::form(Role::Rest, &flow.name, Vec::new()),
                        None => return self.leaf(scope, ty),
                    }
                }
                _ => self.expr(scope, part_type(*part, ty), depth),
            });
        }
        self.counts.add(form.name);
        let result = match form.used {
            Use::Absent | Use::StateAbsent => Ty {
                optional: true,
                ..ty
            },
            _ => ty,
        };
        Tree::expr(result, form.text, parts)
    }

    /// Returns a delayed operand: often a flow that is defined later, or the defined flow itself.
    fn delayed(&mut self, scope: &Scope, ty: Ty, depth: usize) -> Tree {
        let flows = named(&scope.delayed, ty);
        match flows.is_empty() || scope.clock.is_some() || self.random.one_in(3) {
            true => self.expr(scope, ty, depth),
            false => {
                let flow = *self.random.pick(&flows);
                self.counts.add("delayed flow");
                Tree::expr(ty, &flow.name, Vec::new())
            }
        }
    }

    /// Returns the name of a flow that can be used as a clock.
    pub(crate) fn deciding(&mut self, scope: &Scope) -> Option<String> {
        let deciding = named(&scope.known, Kind::Bool.total());
        let plain: Vec<&&Flow> = deciding.iter().filter(|f| !f.name.contains('.')).collect();
        (!plain.is_empty()).then(|| self.random.pick(&plain).name.clone())
    }

    /// Returns `merge`, `current` or another expression with parts sampled by a flow.
    fn sampled(&mut self, scope: &Scope, ty: Ty, depth: usize) -> Option<Tree> {
        let clock = self.deciding(scope).filter(|_| ty.kind.is_scalar())?;
        let on = |value: bool| Scope {
            clock: Some((clock.clone(), value)),
            ..scope.clone()
        };
        let total = Ty {
            ticking: true,
            ..ty.kind.total()
        };
        let yes = self.expr(&on(true), total, depth.min(2));
        let sampled = "(if @ when CLOCK then @ else @)".replace("CLOCK", &clock);
        let condition = || Tree::form(Role::Rest, "true", Vec::new());
        if ty.optional && self.random.one_in(2) {
            self.counts.add("current");
            let no = self.ticking_leaf(&on(true), total);
            let form = format!("(current {sampled})");
            return Some(Tree::expr(ty, &form, vec![condition(), yes, no]));
        }
        if scope.clock.is_none() && ty.optional {
            self.counts.add("lifted");
            let no = self.ticking_leaf(&on(true), total);
            let (chosen, rest) = (Kind::Bool.total(), ty.kind.total());
            let chosen = self.expr(scope, chosen, depth.min(2));
            let rest = self.expr(scope, rest, depth.min(2));
            // The result is present in all cycles; flows on other clocks are tested in `clocked`.
            let form = format!("(if ({clock} or @) then {sampled} else @)");
            return Some(Tree::expr(
                ty,
                &form,
                vec![chosen, condition(), yes, no, rest],
            ));
        }
        if scope.clock.is_none() && self.random.one_in(3) {
            self.counts.add("off clock");
            let no = self.ticking_leaf(&on(true), total);
            let rest = self.expr(scope, ty.kind.total(), depth.min(2));
            let form = match self.random.one_in(2) {
                true => format!("({sampled} ?? @)"),
                false => format!("hold({sampled}, @)"),
            };
            return Some(Tree::expr(ty, &form, vec![condition(), yes, no, rest]));
        }
        self.counts.add("merge");
        let no = self.expr(&on(false), total, depth.min(2));
        let form = format!("(merge {clock} (true -> @) (false -> @))");
        Some(Tree::expr(ty, &form, vec![yes, no]))
    }

    /// Returns a literal or a flow.
    fn leaf(&mut self, scope: &Scope, ty: Ty) -> Tree {
        if scope.clock.is_some() {
            return self.ticking_leaf(scope, ty);
        }
        let flows = named(&scope.known, ty);
        let exact: Vec<&Flow> = flows.iter().copied().filter(|f| f.ty == ty).collect();
        let from = if exact.is_empty() { &flows } else { &exact };
        match from.is_empty() || self.random.one_in(4) {
            true => Tree::expr(ty.kind.total(), &self.literal(ty.kind), Vec::new()),
            false => {
                let flow = *self.random.pick(from);
                Tree::expr(flow.ty, &flow.name.clone(), Vec::new())
            }
        }
    }

    /// Returns a flow sampled by the clock.
    fn ticking_leaf(&mut self, scope: &Scope, ty: Ty) -> Tree {
        let flows = named(&scope.known, ty.kind.total());
        let (clock, value) = scope.clock.clone().unwrap_or_default();
        let not = if value { "" } else { "not " };
        match flows.is_empty() {
            true => {
                let literal = self.literal(ty.kind);
                Tree::expr(ty, &format!("({literal} when {not}{clock})"), Vec::new())
            }
            false => {
                self.counts.add("when");
                let flow = *self.random.pick(&flows);
                Tree::expr(
                    ty,
                    &format!("({} when {not}{clock})", flow.name),
                    Vec::new(),
                )
            }
        }
    }

    fn literal(&mut self, kind: Kind) -> String {
        let n = self.random.below(7);
        match kind {
            Kind::Bool => (if n.is_multiple_of(2) { "true" } else { "false" }).to_owned(),
            Kind::Int => n.to_string(),
            Kind::Real => format!("{n}.5"),
            Kind::Length => format!("{n}.25[m]"),
            Kind::Time => format!("{}[ms]", n + 1),
            Kind::Speed => format!("{n}.5[m/s]"),
            Kind::Area => format!("{n}.0[m^2]"),
            Kind::Mode => (*self.random.pick(&["Off", "Slow", "Fast"])).to_owned(),
            Kind::Point => format!("Point{{x = {n}.5; n = {n}}}"),
            Kind::Ints => format!("[{n}, {}, 2]", n + 1),
            Kind::Reals => format!("[{n}.5, 2.0, 0.25]"),
        }
    }
}

/// Returns the flows that can be used where a type is expected.
fn named(flows: &[Flow], ty: Ty) -> Vec<&Flow> {
    let has_type = |flow: &&Flow| flow.ty.kind == ty.kind && (ty.optional || !flow.ty.optional);
    let exact = flows.iter().filter(|flow| flow.ty == ty);
    match ty.optional {
        true if exact.clone().next().is_some() => exact.collect(),
        _ => flows.iter().filter(has_type).collect(),
    }
}

fn usable(form: &Form, scope: &Scope, ty: Ty) -> bool {
    let of_kind = form.kind.is_none_or(|kind| kind == ty.kind);
    let clocked = scope.clock.is_none() || (form.clocked && !ty.optional);
    let used = match form.used {
        Use::Any => true,
        Use::State => scope.state,
        Use::Absent => ty.optional,
        Use::StateAbsent => scope.state && ty.optional,
    };
    of_kind && clocked && used
}

fn part_type(part: Part, ty: Ty) -> Ty {
    match part {
        Part::Own => ty,
        Part::OwnTotal | Part::Delayed => Ty {
            optional: false,
            ..ty
        },
        Part::OwnOptional | Part::DelayedOptional => Ty {
            optional: true,
            ..ty
        },
        Part::Total(kind) => Ty {
            kind,
            optional: false,
            ..ty
        },
        Part::Optional(kind) => Ty {
            kind,
            optional: true,
            ..ty
        },
        Part::Lifted(kind) => Ty { kind, ..ty },
    }
}
