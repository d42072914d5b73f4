//! Actions of the grammar for the blocks of equations of Kind 2 (`if`, `when`, `cond`, `frame`), and their desugaring.
//!
//! A block becomes one equation per flow, with the conditions in its value.

mod frame_arrays;
mod frame_init;

use crate::ast::*;
use crate::context::ParseContext;
use crate::ops::{BinaryOp, UnaryOp};
use rpi_diag::Span;
use std::collections::{BTreeMap, BTreeSet};

pub(crate) fn choice(
    cx: &ParseContext<'_>,
    word: ConditionalKeyword,
    first: BlockBranch,
    rest: Vec<BlockBranch>,
    otherwise: Option<Vec<Statement>>,
) -> Box<ConditionalBlock> {
    let branches = crate::actions::with_elements(vec![first], rest);
    let mut choice = Box::new(ConditionalBlock {
        keyword: word,
        branches,
        else_statements: otherwise,
        desugared: Desugared::default(),
    });
    choice.desugared = Desugarer::new(cx, &[]).desugar_choice(&choice);
    choice
}

pub(crate) fn frame_block(
    cx: &ParseContext<'_>,
    names: Vec<Ident>,
    initial: Vec<Statement>,
    statements: Vec<Statement>,
) -> Box<FrameBlock> {
    let mut keep = Box::new(FrameBlock {
        names,
        initial,
        statements,
        desugared: Desugared::default(),
    });
    keep.desugared = Desugarer::new(cx, &keep.names).desugar_frame(&keep);
    keep
}

/// Definitions of a block, by the source text of their left sides (the keys), in text order.
#[derive(Default)]
struct Definitions {
    /// Keys in text order.
    key_order: Vec<String>,
    /// Definitions by key.
    by_key: BTreeMap<String, Definition>,
    /// Index of each key in `order`.
    positions: BTreeMap<String, usize>,
    /// Keys of the definitions of each flow. May contain keys of removed definitions.
    keys_by_flow: BTreeMap<Name, Vec<String>>,
}

/// Desugared equation.
#[derive(Clone)]
struct Definition {
    targets: Vec<Target>,
    value: Expr,
    span: Span,
}

impl Definitions {
    /// Inserts a definition, as the last one if its key is new.
    fn insert(&mut self, key: String, definition: Definition) {
        if !self.positions.contains_key(&key) {
            self.positions.insert(key.clone(), self.key_order.len());
            self.key_order.push(key.clone());
        }
        self.insert_unordered(key, definition);
    }

    /// Inserts a definition without a position in the order.
    fn insert_unordered(&mut self, key: String, definition: Definition) {
        for target in &definition.targets {
            let sides = self
                .keys_by_flow
                .entry(target.name.name.clone())
                .or_default();
            sides.push(key.clone());
        }
        self.by_key.insert(key, definition);
    }

    /// Returns the definitions with a flow in their left side.
    fn defining(&self, name: &Name) -> impl Iterator<Item = &Definition> {
        let sides = self.keys_by_flow.get(name).into_iter().flatten();
        sides.filter_map(|key| self.by_key.get(key))
    }

    /// Returns the value of targets that are defined together or one by one.
    fn value_of(&self, targets: &[Target]) -> Option<Expr> {
        let written = |target: &Target| self.definition_of(target);
        if let [one] = targets {
            return written(one).map(|definition| definition.value.clone());
        }
        let mut of_first = targets
            .iter()
            .take(1)
            .flat_map(|t| self.defining(&t.name.name));
        if let Some(whole) = of_first.find(|d| are_same_targets(&d.targets, targets)) {
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
    fn definition_of(&self, target: &Target) -> Option<&Definition> {
        let alone =
            |d: &&Definition| matches!(&d.targets[..], [one] if is_same_target(one, target));
        self.defining(&target.name.name).find(alone)
    }

    /// Removes the single definitions of targets that no definition groups, and returns their values as one.
    ///
    /// A target without a definition keeps its previous value.
    fn take_values(&mut self, targets: &[Target]) -> Expr {
        let mut values = Vec::with_capacity(targets.len());
        for target in targets {
            let is_alone = |key: &&String| {
                let definition = self.by_key.get(*key);
                definition
                    .is_some_and(|d| matches!(&d.targets[..], [one] if is_same_target(one, target)))
            };
            let mut sides = self
                .keys_by_flow
                .get(&target.name.name)
                .into_iter()
                .flatten();
            let key = sides.find(is_alone).cloned();
            let definition = key.and_then(|key| self.by_key.remove(&key));
            values.push(definition.map_or_else(|| previous_value(target), |d| d.value));
        }
        match values.len() {
            1 => values.remove(0),
            _ => tuple_of(targets, values),
        }
    }

    /// Returns the flows that are defined together with others in one definition.
    fn grouped_flows(&self) -> BTreeSet<String> {
        let groups = self.by_key.values().filter(|d| d.targets.len() > 1);
        let targets = groups.flat_map(|d| &d.targets);
        targets.map(|target| target.name.name.to_string()).collect()
    }
}

/// Returns whether two targets are the same flow or the same part of a flow.
fn is_same_target(a: &Target, b: &Target) -> bool {
    let step = |(a, b): (&Access, &Access)| match (a, b) {
        (Access::Field(a), Access::Field(b)) => a.name == b.name,
        (Access::Index(a), Access::Index(b)) => a.unparen().kind == b.unparen().kind,
        _ => false,
    };
    a.name.name == b.name.name
        && a.path.len() == b.path.len()
        && a.path.iter().zip(&b.path).all(step)
}

fn are_same_targets(a: &[Target], b: &[Target]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same_target(a, b))
}

/// Desugaring of a block.
struct Desugarer<'c, 't> {
    cx: &'c ParseContext<'t>,
    /// Flows of a `frame`, which keep their previous values where no branch defines them.
    kept_flows: BTreeSet<&'c Name>,
    errors: Vec<BlockError>,
}

impl<'c, 't> Desugarer<'c, 't> {
    fn new(cx: &'c ParseContext<'t>, kept: &'c [Ident]) -> Self {
        let kept = kept.iter().map(|name| &name.name).collect();
        let faults = Vec::new();
        Desugarer {
            cx,
            kept_flows: kept,
            errors: faults,
        }
    }

    fn desugar_choice(mut self, choice: &ConditionalBlock) -> Desugared {
        let defined = self.choice(choice);
        self.finish(defined)
    }

    fn finish(self, mut defined: Definitions) -> Desugared {
        let order = std::mem::take(&mut defined.key_order);
        let definitions = order.iter().filter_map(|key| defined.by_key.remove(key));
        let equations = definitions.map(|d| {
            let (targets, value) = (d.targets, d.value);
            (Equation { targets, value }, d.span)
        });
        Desugared {
            equations: equations.collect(),
            errors: self.errors,
        }
    }

    /// Desugars a `frame` block.
    ///
    /// The equations before `let` give the values before the first cycle, for undefined flows and for `last`.
    fn desugar_frame(mut self, keep: &FrameBlock) -> Desugared {
        let mut initial = self.statements(&keep.initial);
        let mut defined = self.statements(&keep.statements);
        frame_arrays::unify_array_targets(self.cx, &mut initial, &mut defined);
        let in_groups = defined.grouped_flows();
        for (key, first) in &initial.by_key {
            if !in_groups.contains(key) && !defined.by_key.contains_key(key) {
                let value = defined.take_values(&first.targets);
                let first = first.clone();
                defined.insert(key.clone(), Definition { value, ..first });
            }
        }
        let says = |name: &&Ident| defined.defining(&name.name).next().is_some();
        let unsaid: Vec<&Ident> = keep.names.iter().filter(|name| !says(name)).collect();
        for name in unsaid {
            let targets = vec![Target {
                name: name.clone(),
                path: Vec::new(),
                span: name.span,
            }];
            let (value, span) = (previous_value(&targets[0]), name.span);
            let definition = Definition {
                targets,
                value,
                span,
            };
            self.add(&mut defined, name.name.to_string(), definition);
        }
        for definition in defined.by_key.values_mut() {
            frame_init::insert_initial_values(definition, &initial, &self.kept_flows);
        }
        let strange = defined.by_key.values().flat_map(|d| &d.targets);
        let strange = strange.filter(|target| !self.kept_flows.contains(&target.name.name));
        let strange: Vec<Ident> = strange.map(|target| target.name.clone()).collect();
        self.errors
            .extend(strange.into_iter().map(BlockError::NotInFrame));
        self.finish(defined)
    }

    fn statements(&mut self, statements: &[Statement]) -> Definitions {
        let mut defined = Definitions::default();
        for statement in statements {
            match &statement.kind {
                StatementKind::Equation(equation) => {
                    self.equation(&mut defined, equation, statement.span)
                }
                StatementKind::Conditional(choice) => {
                    let mut inner = self.choice(choice);
                    for key in inner.key_order {
                        if let Some(definition) = inner.by_key.remove(&key) {
                            self.add(&mut defined, key, definition);
                        }
                    }
                }
                StatementKind::Error(_) => {}
                other => self.errors.push(BlockError::NotAnEquation(
                    statement.span,
                    statement_description(other),
                )),
            }
        }
        defined
    }

    fn equation(&mut self, defined: &mut Definitions, equation: &Equation, span: Span) {
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

    fn add(&mut self, defined: &mut Definitions, key: String, definition: Definition) {
        let again = definition.targets.first().map(|target| target.name.clone());
        match defined.by_key.get(&key) {
            Some(first) => {
                let first = first
                    .targets
                    .first()
                    .map_or(Span::NONE, |target| target.span);
                self.errors
                    .extend(again.map(|name| BlockError::DuplicateDefinition(name, first)));
            }
            None => defined.insert(key, definition),
        }
    }

    /// Combines the definitions of all branches into conditional expressions.
    fn choice(&mut self, choice: &ConditionalBlock) -> Definitions {
        let mut parts: Vec<(Option<&Expr>, Definitions, Span)> = Vec::new();
        for branch in &choice.branches {
            let defined = self.statements(&branch.statements);
            parts.push((Some(&branch.condition), defined, branch.condition.span));
        }
        let last = self.statements(choice.else_statements.as_deref().unwrap_or_default());
        let whole = choice.branches[0].condition.span;
        parts.push((None, last, whole));
        let in_groups = parts
            .iter()
            .flat_map(|(_, defined, _)| defined.grouped_flows());
        let mut done: BTreeSet<String> = in_groups.collect();
        let mut joined = Definitions::default();
        for key in parts.iter().flat_map(|(_, defined, _)| &defined.key_order) {
            if done.insert(key.clone())
                && let Some(definition) = self.join_branches(key, &parts)
            {
                joined.insert(key.clone(), definition);
            }
        }
        joined
    }

    /// Returns the combined definition of one key over all branches.
    fn join_branches(
        &mut self,
        key: &str,
        parts: &[(Option<&Expr>, Definitions, Span)],
    ) -> Option<Definition> {
        let model = parts
            .iter()
            .find_map(|(_, defined, _)| defined.by_key.get(key))?;
        let mut whole: Option<Expr> = None;
        for (condition, defined, place) in parts.iter().rev() {
            let value = self.value_in(defined, &model.targets, *place);
            whole = Some(match (whole, condition) {
                (Some(no), Some(condition)) => if_expr((*condition).clone(), value, no),
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
    fn value_in(&mut self, defined: &Definitions, targets: &[Target], place: Span) -> Expr {
        if let Some(value) = defined.value_of(targets) {
            return value;
        }
        if targets
            .iter()
            .all(|target| defined.definition_of(target).is_none())
        {
            return self.previous_or_report(targets, place);
        }
        let values = targets
            .iter()
            .map(|target| match defined.definition_of(target) {
                Some(definition) => definition.value.clone(),
                None => self.previous_or_report(std::slice::from_ref(target), place),
            });
        let kind = ExprKind::Tuple(values.collect());
        Expr { kind, span: place }
    }

    /// Returns the previous value of targets that a branch does not define, or reports them if they are not kept.
    fn previous_or_report(&mut self, targets: &[Target], place: Span) -> Expr {
        let is_kept = |target: &Target| self.kept_flows.contains(&target.name.name);
        if targets.iter().all(is_kept) {
            return match targets {
                [one] => previous_value(one),
                all => tuple_of(all, all.iter().map(previous_value).collect()),
            };
        }
        for target in targets {
            self.errors
                .push(BlockError::MissingDefinition(target.name.clone(), place));
        }
        let (kind, span) = (ExprKind::Bool(false), place);
        Expr { kind, span }
    }
}

/// Returns the tuple of the values of several targets.
fn tuple_of(targets: &[Target], values: Vec<Expr>) -> Expr {
    let span = targets.first().map_or(Span::NONE, |target| target.span);
    let kind = ExprKind::Tuple(values.into());
    Expr { kind, span }
}

/// Returns `last x`, the value of a target in the previous cycle.
fn previous_value(target: &Target) -> Expr {
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
            Access::Slice(slice) => ExprKind::Slice(Box::new(SliceExpr {
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
fn if_expr(condition: Expr, yes: Expr, no: Expr) -> Expr {
    let span = yes.span;
    let kind = ExprKind::If(Box::new(IfExpr {
        is_static: false,
        condition,
        then_value: yes,
        else_value: no,
    }));
    Expr { kind, span }
}

/// Returns `lhs -> rhs`.
fn arrow_expr(lhs: Expr, rhs: Expr) -> Expr {
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
fn statement_description(kind: &StatementKind) -> &'static str {
    match kind {
        StatementKind::Claim(_) => "a claim",
        StatementKind::Call(_) => "a call",
        StatementKind::FrameBlock(_) => "a `frame`",
        StatementKind::Fragment(_) => "a fragment",
        StatementKind::Automaton(_) => "an automaton",
        _ => "this",
    }
}
