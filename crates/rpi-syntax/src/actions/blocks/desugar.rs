//! Desugaring of the blocks of Kind 2: one equation per flow, with the conditions in its value.

use super::definitions::{Definition, Definitions};
use super::{frame_arrays, frame_init};
use crate::ast::*;
use crate::context::ParseContext;
use crate::ops::{BinaryOp, UnaryOp};
use rpi_diag::Span;
use std::collections::BTreeSet;

/// State of the translation of one conditional block or `frame` block (Kind 2) to equations.
pub(super) struct Desugarer<'c, 't> {
    cx: &'c ParseContext<'t>,
    /// Flows that a `frame` block lists. They have their previous values where no branch defines them. Empty for a
    /// conditional block.
    kept_flows: BTreeSet<&'c Name>,
    errors: Vec<BlockError>,
}

impl<'c, 't> Desugarer<'c, 't> {
    pub(super) fn new(cx: &'c ParseContext<'t>, kept: &'c [Ident]) -> Self {
        let kept = kept.iter().map(|name| &name.name).collect();
        let faults = Vec::new();
        Desugarer {
            cx,
            kept_flows: kept,
            errors: faults,
        }
    }

    pub(super) fn desugar_choice(mut self, choice: &ConditionalBlock) -> Desugared {
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

    /// Translates a `frame` block to equations.
    ///
    /// The equations before `let` give the initial values. They replace `last x` in the first cycle, also for flows
    /// that the block does not define.
    pub(super) fn desugar_frame(mut self, keep: &FrameBlock) -> Desugared {
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

    /// Combines the definitions in all branches of a conditional block: each left side gets one definition with a
    /// conditional expression.
    fn choice(&mut self, choice: &ConditionalBlock) -> Definitions {
        let mut parts: Vec<(Option<&Expr>, Definitions, MissingBranch)> = Vec::new();
        for branch in &choice.branches {
            let defined = self.statements(&branch.statements);
            let place = MissingBranch::Condition(branch.condition.span);
            parts.push((Some(&branch.condition), defined, place));
        }
        let last = self.statements(choice.else_statements.as_deref().unwrap_or_default());
        parts.push((None, last, else_branch(choice)));
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

    /// Returns the definition of the left side with this key: a conditional expression over the branches. `parts` holds
    /// condition (`None` for `else`), definitions and source range of each branch. `None` if no branch has the key.
    fn join_branches(
        &mut self,
        key: &str,
        parts: &[(Option<&Expr>, Definitions, MissingBranch)],
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

    /// Returns the value of the targets in one branch: the defined value, else the value in the previous cycle. `place`
    /// is the source range of the branch.
    fn value_in(
        &mut self,
        defined: &Definitions,
        targets: &[Target],
        place: MissingBranch,
    ) -> Expr {
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
        let span = place.span();
        Expr { kind, span }
    }

    /// Returns the value in the previous cycle for targets that a branch does not define. If they are not flows of a
    /// `frame`, reports a missing definition at `place` and returns a placeholder.
    fn previous_or_report(&mut self, targets: &[Target], place: MissingBranch) -> Expr {
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
        let (kind, span) = (ExprKind::Bool(false), place.span());
        Expr { kind, span }
    }
}

/// Returns the place of the `else` of a block: its first statement, or the last condition if there is no `else`.
fn else_branch(choice: &ConditionalBlock) -> MissingBranch {
    let last = choice
        .branches
        .last()
        .map_or(Span::NONE, |branch| branch.condition.span);
    match choice.else_statements.as_deref() {
        Some(statements) => {
            MissingBranch::Else(statements.first().map_or(last, |statement| statement.span))
        }
        None => MissingBranch::NoElse(last),
    }
}

/// Returns the tuple expression of `values`, with the source range of the first target.
pub(super) fn tuple_of(targets: &[Target], values: Vec<Expr>) -> Expr {
    let span = targets.first().map_or(Span::NONE, |target| target.span);
    let kind = ExprKind::Tuple(values.into());
    Expr { kind, span }
}

/// Returns the expression `last x`, the value of a target in the previous cycle.
pub(super) fn previous_value(target: &Target) -> Expr {
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

/// Returns the syntax tree of `if condition then yes else no`.
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

/// Returns the syntax tree of `lhs -> rhs`, with the source range of `lhs`.
pub(super) fn arrow_expr(lhs: Expr, rhs: Expr) -> Expr {
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

/// Returns a noun phrase for a statement that is not an equation, such as "a call", for diagnostics.
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
