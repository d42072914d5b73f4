//! Makes blocks of equations (`if`, `when`, `cond`, `frame` of Kind 2), and works out the equations that they stand for: one
//! for each flow, with the conditions in its value.

mod frames;
mod initial;

use crate::ast::*;
use crate::context::Context;
use crate::ops::{BinaryOp, UnaryOp};
use rpi_diag::Span;
use std::collections::{BTreeMap, BTreeSet};

impl Context<'_> {
    pub(crate) fn choice(
        &self,
        word: ChoiceWord,
        first: ChoiceBranch,
        rest: Vec<ChoiceBranch>,
        otherwise: Option<Vec<Statement>>,
    ) -> Box<Choice> {
        let branches = crate::make::extended(vec![first], rest);
        let mut choice = Box::new(Choice {
            word,
            branches,
            otherwise,
            means: Meaning::default(),
        });
        choice.means = Sense::new(self, &[]).of_choice(&choice);
        choice
    }

    pub(crate) fn keep(
        &self,
        names: Vec<Ident>,
        initial: Vec<Statement>,
        statements: Vec<Statement>,
    ) -> Box<Keep> {
        let mut keep = Box::new(Keep {
            names,
            initial,
            statements,
            means: Meaning::default(),
        });
        keep.means = Sense::new(self, &keep.names).of_keep(&keep);
        keep
    }
}

/// What equations define, by how the left side is written, in text order.
#[derive(Default)]
struct Defined {
    order: Vec<String>,
    by: BTreeMap<String, Definition>,
    /// Where each left side stands in the order.
    at: BTreeMap<String, usize>,
    /// The left sides in which each flow stands, or stood.
    sides: BTreeMap<Name, Vec<String>>,
}

#[derive(Clone)]
struct Definition {
    targets: Vec<Target>,
    value: Expr,
    span: Span,
}

impl Defined {
    /// Takes up a definition, as the last one if its left side is new.
    fn insert(&mut self, key: String, definition: Definition) {
        if !self.at.contains_key(&key) {
            self.at.insert(key.clone(), self.order.len());
            self.order.push(key.clone());
        }
        self.put(key, definition);
    }

    fn put(&mut self, key: String, definition: Definition) {
        for target in &definition.targets {
            let sides = self.sides.entry(target.name.name.clone()).or_default();
            sides.push(key.clone());
        }
        self.by.insert(key, definition);
    }

    /// The definitions in whose left side a flow stands.
    fn of(&self, name: &Name) -> impl Iterator<Item = &Definition> {
        let sides = self.sides.get(name).into_iter().flatten();
        sides.filter_map(|key| self.by.get(key))
    }

    /// The value of targets, which may be defined one by one.
    fn value_of(&self, targets: &[Target]) -> Option<Expr> {
        let written = |target: &Target| self.named(target);
        if let [one] = targets {
            return written(one).map(|definition| definition.value.clone());
        }
        let mut of_first = targets.iter().take(1).flat_map(|t| self.of(&t.name.name));
        if let Some(whole) = of_first.find(|d| same_names(&d.targets, targets)) {
            return Some(whole.value.clone());
        }
        let values: Option<Vec<Expr>> = targets
            .iter()
            .map(|t| Some(written(t)?.value.clone()))
            .collect();
        let values = values?;
        let span = values.first().map_or(Span::NONE, |value| value.span);
        let kind = ExprKind::Tuple(values.into());
        Some(Expr { kind, span })
    }

    /// The equation for one target alone.
    fn named(&self, target: &Target) -> Option<&Definition> {
        let alone = |d: &&Definition| matches!(&d.targets[..], [one] if same_place(one, target));
        self.of(&target.name.name).find(alone)
    }

    /// The value of targets that nothing defines together: what defines each is taken out, what nothing defines stays
    /// as it was.
    fn taken(&mut self, targets: &[Target]) -> Expr {
        let mut values = Vec::with_capacity(targets.len());
        for target in targets {
            let is_alone = |key: &&String| {
                let definition = self.by.get(*key);
                definition
                    .is_some_and(|d| matches!(&d.targets[..], [one] if same_place(one, target)))
            };
            let mut sides = self.sides.get(&target.name.name).into_iter().flatten();
            let key = sides.find(is_alone).cloned();
            let definition = key.and_then(|key| self.by.remove(&key));
            values.push(definition.map_or_else(|| before(target), |d| d.value));
        }
        match values.len() {
            1 => values.remove(0),
            _ => together(targets, values),
        }
    }

    /// The left sides of one flow each that stand in a left side of several.
    fn grouped(&self) -> BTreeSet<String> {
        let groups = self.by.values().filter(|d| d.targets.len() > 1);
        let targets = groups.flat_map(|d| &d.targets);
        targets.map(|target| target.name.name.to_string()).collect()
    }
}

fn same_place(a: &Target, b: &Target) -> bool {
    let step = |(a, b): (&Access, &Access)| match (a, b) {
        (Access::Field(a), Access::Field(b)) => a.name == b.name,
        (Access::Index(a), Access::Index(b)) => a.unparen().kind == b.unparen().kind,
        _ => false,
    };
    a.name.name == b.name.name
        && a.path.len() == b.path.len()
        && a.path.iter().zip(&b.path).all(step)
}

fn same_names(a: &[Target], b: &[Target]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same_place(a, b))
}

/// Works out what a block stands for.
struct Sense<'c, 't> {
    cx: &'c Context<'t>,
    /// The flows that keep their values where nothing defines them.
    kept: BTreeSet<&'c Name>,
    faults: Vec<BlockFault>,
}

impl<'c, 't> Sense<'c, 't> {
    fn new(cx: &'c Context<'t>, kept: &'c [Ident]) -> Self {
        let kept = kept.iter().map(|name| &name.name).collect();
        let faults = Vec::new();
        Sense { cx, kept, faults }
    }

    fn of_choice(mut self, choice: &Choice) -> Meaning {
        let defined = self.choice(choice);
        self.meaning(defined)
    }

    fn meaning(self, mut defined: Defined) -> Meaning {
        let order = std::mem::take(&mut defined.order);
        let definitions = order.iter().filter_map(|key| defined.by.remove(key));
        let equations = definitions.map(|d| {
            let (targets, value) = (d.targets, d.value);
            (Equation { targets, value }, d.span)
        });
        Meaning {
            equations: equations.collect(),
            faults: self.faults,
        }
    }

    /// What is said before `let` is the value in the cycle before the first one: for flows that nothing defines, and for `last`.
    fn of_keep(mut self, keep: &Keep) -> Meaning {
        let mut initial = self.statements(&keep.initial);
        let mut defined = self.statements(&keep.statements);
        frames::same_elements(self.cx, &mut initial, &mut defined);
        let in_groups = defined.grouped();
        for (key, first) in &initial.by {
            if !in_groups.contains(key) && !defined.by.contains_key(key) {
                let value = defined.taken(&first.targets);
                let first = first.clone();
                defined.insert(key.clone(), Definition { value, ..first });
            }
        }
        let says = |name: &&Ident| defined.of(&name.name).next().is_some();
        let unsaid: Vec<&Ident> = keep.names.iter().filter(|name| !says(name)).collect();
        for name in unsaid {
            let targets = vec![Target {
                name: name.clone(),
                path: Vec::new(),
                span: name.span,
            }];
            let (value, span) = (before(&targets[0]), name.span);
            let definition = Definition {
                targets,
                value,
                span,
            };
            self.add(&mut defined, name.name.to_string(), definition);
        }
        for definition in defined.by.values_mut() {
            initial::begin(definition, &initial, &self.kept);
        }
        let strange = defined.by.values().flat_map(|d| &d.targets);
        let strange = strange.filter(|target| !self.kept.contains(&target.name.name));
        let strange: Vec<Ident> = strange.map(|target| target.name.clone()).collect();
        self.faults
            .extend(strange.into_iter().map(BlockFault::NotNamed));
        self.meaning(defined)
    }

    fn statements(&mut self, statements: &[Statement]) -> Defined {
        let mut defined = Defined::default();
        for statement in statements {
            match &statement.kind {
                StatementKind::Equation(equation) => {
                    self.equation(&mut defined, equation, statement.span)
                }
                StatementKind::Choice(choice) => {
                    let mut inner = self.choice(choice);
                    for key in inner.order {
                        if let Some(definition) = inner.by.remove(&key) {
                            self.add(&mut defined, key, definition);
                        }
                    }
                }
                StatementKind::Broken(_) => {}
                other => self
                    .faults
                    .push(BlockFault::NoEquation(statement.span, what(other))),
            }
        }
        defined
    }

    fn equation(&mut self, defined: &mut Defined, equation: &Equation, span: Span) {
        let written =
            |target: &Target| self.cx.slice(target.span.start, target.span.end).to_owned();
        let keys: Vec<String> = equation.targets.iter().map(written).collect();
        let definition = Definition {
            targets: equation.targets.clone(),
            value: equation.value.clone(),
            span,
        };
        self.add(defined, keys.join(","), definition);
    }

    fn add(&mut self, defined: &mut Defined, key: String, definition: Definition) {
        let again = definition.targets.first().map(|target| target.name.clone());
        match defined.by.get(&key) {
            Some(first) => {
                let first = first
                    .targets
                    .first()
                    .map_or(Span::NONE, |target| target.span);
                self.faults
                    .extend(again.map(|name| BlockFault::Twice(name, first)));
            }
            None => defined.insert(key, definition),
        }
    }

    /// The definitions of all branches, joined by the conditions.
    fn choice(&mut self, choice: &Choice) -> Defined {
        let mut parts: Vec<(Option<&Expr>, Defined, Span)> = Vec::new();
        for branch in &choice.branches {
            let defined = self.statements(&branch.statements);
            parts.push((Some(&branch.condition), defined, branch.condition.span));
        }
        let last = self.statements(choice.otherwise.as_deref().unwrap_or_default());
        let whole = choice.branches[0].condition.span;
        parts.push((None, last, whole));
        let in_groups = parts.iter().flat_map(|(_, defined, _)| defined.grouped());
        let mut done: BTreeSet<String> = in_groups.collect();
        let mut joined = Defined::default();
        for key in parts.iter().flat_map(|(_, defined, _)| &defined.order) {
            if done.insert(key.clone())
                && let Some(definition) = self.joined(key, &parts)
            {
                joined.insert(key.clone(), definition);
            }
        }
        joined
    }

    /// What all branches together say of one left side.
    fn joined(
        &mut self,
        key: &str,
        parts: &[(Option<&Expr>, Defined, Span)],
    ) -> Option<Definition> {
        let model = parts
            .iter()
            .find_map(|(_, defined, _)| defined.by.get(key))?;
        let mut whole: Option<Expr> = None;
        for (condition, defined, place) in parts.iter().rev() {
            let value = self.value_in(defined, &model.targets, *place);
            whole = Some(match (whole, condition) {
                (Some(no), Some(condition)) => either((*condition).clone(), value, no),
                _ => value,
            });
        }
        let value = whole?;
        Some(Definition {
            value,
            ..model.clone()
        })
    }

    /// The value that a branch gives to targets.
    fn value_in(&mut self, defined: &Defined, targets: &[Target], place: Span) -> Expr {
        if let Some(value) = defined.value_of(targets) {
            return value;
        }
        if targets.iter().all(|target| defined.named(target).is_none()) {
            return self.missing(targets, place);
        }
        let values = targets.iter().map(|target| match defined.named(target) {
            Some(definition) => definition.value.clone(),
            None => self.missing(std::slice::from_ref(target), place),
        });
        let kind = ExprKind::Tuple(values.collect());
        Expr { kind, span: place }
    }

    /// The value of what a branch does not define: that of the cycle before, where it is kept.
    fn missing(&mut self, targets: &[Target], place: Span) -> Expr {
        let is_kept = |target: &Target| self.kept.contains(&target.name.name);
        if targets.iter().all(is_kept) {
            return match targets {
                [one] => before(one),
                all => together(all, all.iter().map(before).collect()),
            };
        }
        for target in targets {
            self.faults
                .push(BlockFault::MissingIn(target.name.clone(), place));
        }
        let (kind, span) = (ExprKind::Bool(false), place);
        Expr { kind, span }
    }
}

/// The values of several targets.
fn together(targets: &[Target], values: Vec<Expr>) -> Expr {
    let span = targets.first().map_or(Span::NONE, |target| target.span);
    let kind = ExprKind::Tuple(values.into());
    Expr { kind, span }
}

/// `last x`: the target one cycle before.
fn before(target: &Target) -> Expr {
    let span = target.span;
    let mut expr = Expr {
        kind: ExprKind::Name(target.name.name.clone()),
        span: target.name.span,
    };
    for access in &target.path {
        let base = expr;
        let kind = match access.clone() {
            Access::Field(field) => ExprKind::Field(Box::new(Field { base, field })),
            Access::Index(index) => ExprKind::Index(Box::new(Index { base, index })),
            Access::Slice(slice) => ExprKind::Slice(Box::new(SliceOf {
                base,
                slice: *slice,
            })),
        };
        expr = Expr { kind, span };
    }
    let kind = ExprKind::Unary(UnaryOp::Last, Box::new(expr));
    Expr { kind, span }
}

fn either(condition: Expr, yes: Expr, no: Expr) -> Expr {
    let span = yes.span;
    let kind = ExprKind::If(Box::new(If {
        is_static: false,
        condition,
        yes,
        no,
    }));
    Expr { kind, span }
}

fn arrow(lhs: Expr, rhs: Expr) -> Expr {
    let span = lhs.span;
    let (op, op_span) = (BinaryOp::Arrow, lhs.span);
    let kind = ExprKind::Binary(Box::new(Binary {
        op,
        op_span,
        lhs,
        rhs,
    }));
    Expr { kind, span }
}

/// A statement that is no equation, in words.
fn what(kind: &StatementKind) -> &'static str {
    match kind {
        StatementKind::Claim(_) => "a claim",
        StatementKind::Call(_) => "a call",
        StatementKind::Keep(_) => "a `frame`",
        StatementKind::Fragment(_) => "a fragment",
        StatementKind::Automaton(_) => "an automaton",
        _ => "this",
    }
}
