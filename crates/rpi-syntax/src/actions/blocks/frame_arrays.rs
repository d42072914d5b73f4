//! Arrays in a `frame` block that one half defines as a whole, `A = e`, and the other by element, `A[i] = e`.

use super::definitions::{Definition, Definitions};
use crate::ast::*;
use crate::context::ParseContext;

/// Form of the left side of a definition in a `frame` block.
#[derive(Clone, Copy, PartialEq)]
enum TargetForm {
    /// The definition is of the whole flow: `A = e`.
    Whole,
    /// Element with the given number of indices: `A[i][j] = e`.
    Elements(usize),
    /// Left side of another form: a field or slice of a flow, or several flows.
    Other,
}

/// Rewrites the initial values (`initial`) and the equations (`defined`) of a `frame` block so that both define an
/// array with the same left side, `A` or `A[i]`, and the same index names.
pub(super) fn unify_array_targets(
    cx: &ParseContext<'_>,
    initial: &mut Definitions,
    defined: &mut Definitions,
) {
    for key in initial.key_order.clone() {
        let Some(first) = initial.by_key.get(&key).cloned() else {
            continue;
        };
        let Some(target) = first.targets.first() else {
            continue;
        };
        let is_plain = |then: &&Definition| form(then) != TargetForm::Other;
        let then = defined.defining(&target.name.name).find(is_plain).cloned();
        let Some(then) = then else {
            continue;
        };
        let old = target_text(cx, &then.targets[0]);
        let Some((first, then)) = with_same_target(cx, first, then) else {
            continue;
        };
        initial.replace(&key, cx, first);
        defined.replace(&old, cx, then);
    }
}

/// Returns the source text of a target, which is the key of its definition.
pub(super) fn target_text(cx: &ParseContext<'_>, target: &Target) -> String {
    cx.slice(target.span.start, target.span.end).to_owned()
}

impl Definitions {
    /// Replaces the definition with key `old` by another one, under the key of its new left side.
    fn replace(&mut self, old: &str, cx: &ParseContext<'_>, new: Definition) {
        let key = target_text(cx, &new.targets[0]);
        self.by_key.remove(old);
        if let Some(at) = self.positions.remove(old) {
            self.key_order[at].clone_from(&key);
            self.positions.insert(key.clone(), at);
        }
        self.insert_unordered(key, new);
    }
}

/// Rewrites two definitions of one array so that both have the same left side. Returns `None` if a left side is neither
/// the whole array nor an element, or if the numbers of indices differ.
fn with_same_target(
    cx: &ParseContext<'_>,
    first: Definition,
    then: Definition,
) -> Option<(Definition, Definition)> {
    match (form(&first), form(&then)) {
        (TargetForm::Whole, TargetForm::Elements(_)) => Some(elementwise(cx, &first, then)),
        (TargetForm::Elements(_), TargetForm::Whole) => {
            let (then, first) = elementwise(cx, &then, first);
            Some((first, then))
        }
        (TargetForm::Elements(n), TargetForm::Elements(m)) if n == m => {
            Some(unify_indices(cx, first, then))
        }
        _ => None,
    }
}

/// Returns the form of the left side of a definition.
fn form(definition: &Definition) -> TargetForm {
    let [target] = &definition.targets[..] else {
        return TargetForm::Other;
    };
    match target.path.len() {
        0 => TargetForm::Whole,
        n if target.path.iter().all(|step| index_name(step).is_some()) => TargetForm::Elements(n),
        _ => TargetForm::Other,
    }
}

/// Returns the name in an index step such as `[i]`; `None` if the step is a field, a slice or an index of another form.
fn index_name(step: &Access) -> Option<&Name> {
    match step {
        Access::Index(index) => index.as_name(),
        _ => None,
    }
}

/// Rewrites the definition of a whole array, `A = e`, to the elementwise form of `model`, `A[i] = e[i]`. Returns the
/// new definition and `model`.
///
/// An index name of `model` that also occurs in `e` is renamed in both definitions.
fn elementwise(
    cx: &ParseContext<'_>,
    whole: &Definition,
    mut model: Definition,
) -> (Definition, Definition) {
    let mut value = whole.value.clone();
    for k in 0..model.targets[0].path.len() {
        let Some(old) = index_name(&model.targets[0].path[k]).cloned() else {
            continue;
        };
        let mut new = old.clone();
        while mentions(&whole.value, &new) || (new != old && mentions(&model.value, &new)) {
            new = cx.intern(&format!("{new}'"));
        }
        rename(&mut model.value, &old, &new);
        let Access::Index(index) = &mut model.targets[0].path[k] else {
            continue;
        };
        index.kind = ExprKind::Name(new);
        let span = value.span;
        let of = Index {
            base: value,
            index: index.clone(),
        };
        let kind = ExprKind::Index(Box::new(of));
        value = Expr { kind, span };
    }
    let element = Definition {
        targets: model.targets.clone(),
        value,
        span: whole.span,
    };
    (element, model)
}

/// Rewrites two elementwise definitions, such as `A[i] = e` and `A[j] = f`, so that both have the left side of the
/// second.
///
/// The new index names differ from all other names in both values.
fn unify_indices(
    cx: &ParseContext<'_>,
    mut first: Definition,
    mut then: Definition,
) -> (Definition, Definition) {
    let names = |of: &Definition| -> Vec<Name> {
        let steps = of.targets[0].path.iter().filter_map(index_name);
        steps.cloned().collect()
    };
    for (k, (a, b)) in names(&first).into_iter().zip(names(&then)).enumerate() {
        if a == b {
            continue;
        }
        let mut new = b.clone();
        while mentions(&first.value, &new) || (new != b && mentions(&then.value, &new)) {
            new = cx.intern(&format!("{new}'"));
        }
        rename(&mut first.value, &a, &new);
        rename(&mut then.value, &b, &new);
        if let Some(Access::Index(index)) = then.targets[0].path.get_mut(k) {
            index.kind = ExprKind::Name(new);
        }
    }
    first.targets.clone_from(&then.targets);
    (first, then)
}

/// Returns whether a name occurs in an expression.
fn mentions(expr: &Expr, name: &Name) -> bool {
    let is_clock = matches!(&expr.kind, ExprKind::When(of) if of.clock.flow.name == *name);
    is_clock
        || expr.as_name() == Some(name)
        || expr.children().into_iter().any(|part| mentions(part, name))
}

/// Renames the index `from` to `to` in an expression, except where a quantifier or a `match` arm declares the name
/// `from` itself.
fn rename(expr: &mut Expr, from: &Name, to: &Name) {
    match &mut expr.kind {
        ExprKind::Name(name) if name == from => name.clone_from(to),
        ExprKind::Quantified(of) if declares(&of.vars, from) => {}
        ExprKind::Match(of) => {
            rename(&mut of.value, from, to);
            for arm in &mut of.arms {
                if arm.pattern.names().iter().all(|name| name.name != *from) {
                    rename(&mut arm.then, from, to);
                }
            }
        }
        _ => {
            for part in expr.children_mut() {
                rename(part, from, to);
            }
        }
    }
}

fn declares(vars: &[VarDecl], name: &Name) -> bool {
    let mut names = vars.iter().flat_map(|var| &var.names);
    names.any(|declared| declared.name == *name)
}

/// Returns the name of the flow in an expression that is a flow, or an element or field of one; `None` for other
/// expressions.
pub(super) fn base_flow(expr: &Expr) -> Option<&Name> {
    let mut base = expr.unparen();
    loop {
        base = match &base.kind {
            ExprKind::Index(of) => of.base.unparen(),
            ExprKind::Field(of) => of.base.unparen(),
            _ => return base.as_name(),
        };
    }
}
