//! Actions of the grammar for the blocks of equations of Kind 2 (`if`, `when`, `cond`, `frame`), and their desugaring.
//!
//! A block becomes one equation per flow, with the conditions in its value.

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

/// Definitions of a block, by the source text of their left sides (the keys), in text order.
#[derive(Default)]
struct Defined {
    /// Keys in text order.
    order: Vec<String>,
    /// Definitions by key.
    by: BTreeMap<String, Definition>,
    /// Index of each key in `order`.
    at: BTreeMap<String, usize>,
    /// Keys of the definitions of each flow. May contain keys of removed definitions.
    sides: BTreeMap<Name, Vec<String>>,
}

/// Desugared equation.
#[derive(Clone)]
struct Definition {
    targets: Vec<Target>,
    value: Expr,
    span: Span,
}

impl Defined {
    /// Inserts a definition, as the last one if its key is new.
    fn insert(&mut self, key: String, definition: Definition) {
        if !self.at.contains_key(&key) {
            self.at.insert(key.clone(), self.order.len());
            self.order.push(key.clone());
        }
        self.put(key, definition);
    }

    /// Inserts a definition without a position in the order.
    fn put(&mut self, key: String, definition: Definition) {
        for target in &definition.targets {
            let sides = self.sides.entry(target.name.name.clone()).or_default();
            sides.push(key.clone());
        }
        self.by.insert(key, definition);
    }

    /// Returns the definitions with a flow in their left side.
    fn of(&self, name: &Name) -> impl Iterator<Item = &Definition> {
        let sides = self.sides.get(name).into_iter().flatten();
        sides.filter_map(|key| self.by.get(key))
    }

    /// Returns the value of targets that are defined together or one by one.
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

    /// Returns the definition of one target alone.
    fn named(&self, target: &Target) -> Option<&Definition> {
        let alone = |d: &&Definition| matches!(&d.targets[..], [one] if same_place(one, target));
        self.of(&target.name.name).find(alone)
    }

    /// Removes the single definitions of targets that no definition groups, and returns their values as one.
    ///
    /// A target without a definition keeps its previous value.
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

    /// Returns the flows that are defined together with others in one definition.
    fn grouped(&self) -> BTreeSet<String> {
        let groups = self.by.values().filter(|d| d.targets.len() > 1);
        let targets = groups.flat_map(|d| &d.targets);
        targets.map(|target| target.name.name.to_string()).collect()
    }
}

/// Returns whether two targets are the same flow or the same part of a flow.
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

/// Desugaring of a block.
struct Sense<'c, 't> {
    cx: &'c Context<'t>,
    /// Flows of a `frame`, which keep their previous values where no branch defines them.
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

    /// Desugars a `frame` block.
    ///
    /// The equations before `let` give the values before the first cycle, for undefined flows and for `last`.
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

    /// Combines the definitions of all branches into conditional expressions.
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

    /// Returns the combined definition of one key over all branches.
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

    /// Returns the value of targets in a branch.
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

    /// Returns the previous value of targets that a branch does not define, or reports them if they are not kept.
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

/// Returns the tuple of the values of several targets.
fn together(targets: &[Target], values: Vec<Expr>) -> Expr {
    let span = targets.first().map_or(Span::NONE, |target| target.span);
    let kind = ExprKind::Tuple(values.into());
    Expr { kind, span }
}

/// Returns `last x`, the value of a target in the previous cycle.
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

/// Returns `if condition then yes else no`.
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

/// Returns `lhs -> rhs`.
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

/// Returns a description of a statement that is not an equation, for messages.
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
