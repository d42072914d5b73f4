//! Arrays in a `frame`: `A = e` in one half of it and `A[i] = e` in the other speak of the same flow.

use super::{Defined, Definition};
use crate::ast::*;
use crate::context::Context;

/// How a definition speaks of an array.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// `A = e`
    Whole,
    /// `A[i][j] = e`
    Elements(usize),
    /// Something else: a part of a flow, several flows.
    Other,
}

/// Lets both halves speak of each array in the same way, with the same indices.
pub(super) fn same_elements(cx: &Context<'_>, initial: &mut Defined, defined: &mut Defined) {
    for key in initial.order.clone() {
        let Some(first) = initial.by.get(&key).cloned() else {
            continue;
        };
        let is_same = |then: &&Definition| {
            form(then) != Form::Other && then.targets[0].name.name == first.targets[0].name.name
        };
        let Some(then) = defined.by.values().find(is_same).cloned() else {
            continue;
        };
        match (form(&first), form(&then)) {
            (Form::Whole, Form::Elements(_)) => {
                initial.replace(&key, cx, element_of(&first, &then));
            }
            (Form::Elements(_), Form::Whole) => {
                let old = cx.written(&then.targets[0]);
                defined.replace(&old, cx, element_of(&then, &first));
            }
            (Form::Elements(n), Form::Elements(m)) if n == m => {
                let old = cx.written(&then.targets[0]);
                let (first, then) = with_same_indices(cx, first, then);
                initial.replace(&key, cx, first);
                defined.replace(&old, cx, then);
            }
            _ => {}
        }
    }
}

impl Context<'_> {
    /// How a left side is written.
    pub(super) fn written(&self, target: &Target) -> String {
        self.slice(target.span.start, target.span.end).to_owned()
    }
}

impl Defined {
    /// Puts a definition in the place of another, under the left side that it has now.
    fn replace(&mut self, old: &str, cx: &Context<'_>, new: Definition) {
        let key = cx.written(&new.targets[0]);
        self.by.remove(old);
        for known in self.order.iter_mut().filter(|known| *known == old) {
            known.clone_from(&key);
        }
        self.by.insert(key, new);
    }
}

fn form(definition: &Definition) -> Form {
    let [target] = &definition.targets[..] else {
        return Form::Other;
    };
    match target.path.len() {
        0 => Form::Whole,
        n if target.path.iter().all(|step| index(step).is_some()) => Form::Elements(n),
        _ => Form::Other,
    }
}

/// The name that an index is.
fn index(step: &Access) -> Option<&Name> {
    match step {
        Access::Index(index) => index.as_name(),
        _ => None,
    }
}

/// The definition of a whole array as that of each element, with the left side of another.
fn element_of(whole: &Definition, model: &Definition) -> Definition {
    let targets = model.targets.clone();
    let mut value = whole.value.clone();
    for step in &targets[0].path {
        let span = value.span;
        if let Access::Index(index) = step {
            let of = Index {
                base: value,
                index: index.clone(),
            };
            let kind = ExprKind::Index(Box::new(of));
            value = Expr { kind, span };
        }
    }
    Definition {
        targets,
        value,
        span: whole.span,
    }
}

/// Both with the same names for the indices, and the left side of the second. A name that means something else in one of
/// the two is not taken.
fn with_same_indices(
    cx: &Context<'_>,
    mut first: Definition,
    mut then: Definition,
) -> (Definition, Definition) {
    let names = |of: &Definition| -> Vec<Name> {
        let steps = of.targets[0].path.iter().filter_map(index);
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

fn mentions(expr: &Expr, name: &Name) -> bool {
    expr.as_name() == Some(name) || expr.children().into_iter().any(|part| mentions(part, name))
}

fn rename(expr: &mut Expr, from: &Name, to: &Name) {
    expr.each_mut(&mut |part| {
        if part.as_name() == Some(from) {
            part.kind = ExprKind::Name(to.clone());
        }
    });
}

/// The flow that an expression is, or is an element or field of.
pub(super) fn of_element(expr: &Expr) -> Option<&Name> {
    let mut base = expr.unparen();
    loop {
        base = match &base.kind {
            ExprKind::Index(of) => of.base.unparen(),
            ExprKind::Field(of) => of.base.unparen(),
            _ => return base.as_name(),
        };
    }
}
