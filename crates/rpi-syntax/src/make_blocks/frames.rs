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
        let Some(target) = first.targets.first() else {
            continue;
        };
        let is_plain = |then: &&Definition| form(then) != Form::Other;
        let then = defined.of(&target.name.name).find(is_plain).cloned();
        let Some(then) = then else {
            continue;
        };
        let old = cx.written(&then.targets[0]);
        let (first, then) = match (form(&first), form(&then)) {
            (Form::Whole, Form::Elements(_)) => element_of(cx, &first, then),
            (Form::Elements(_), Form::Whole) => {
                let (then, first) = element_of(cx, &then, first);
                (first, then)
            }
            (Form::Elements(n), Form::Elements(m)) if n == m => with_same_indices(cx, first, then),
            _ => continue,
        };
        initial.replace(&key, cx, first);
        defined.replace(&old, cx, then);
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
        if let Some(at) = self.at.remove(old) {
            self.order[at].clone_from(&key);
            self.at.insert(key.clone(), at);
        }
        self.put(key, new);
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

/// The definition of a whole array as that of each element, with the left side of another, and that other. The indices
/// are called so that none takes up a name of the whole.
fn element_of(
    cx: &Context<'_>,
    whole: &Definition,
    mut model: Definition,
) -> (Definition, Definition) {
    let mut value = whole.value.clone();
    for k in 0..model.targets[0].path.len() {
        let Some(old) = index(&model.targets[0].path[k]).cloned() else {
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
    let is_clock = matches!(&expr.kind, ExprKind::When(of) if of.clock.flow.name == *name);
    is_clock
        || expr.as_name() == Some(name)
        || expr.children().into_iter().any(|part| mentions(part, name))
}

/// Calls an index something else; where a quantifier or a case of a `match` declares the name, it is none.
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
