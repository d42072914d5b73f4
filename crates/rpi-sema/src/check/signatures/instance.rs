//! Instances of callables and types with static parameters: their keys, and their names in messages.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::signatures::constraint;
use crate::check::signatures::header;
use crate::check::signatures::header::Header;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_args::missing_static_args;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::program::{DeclId, Program};
use crate::ty::{Substitution, Ty};
use crate::typed::Leaf;
use rpi_diag::Span;
use rpi_syntax::Name;
use std::fmt::Write;
use std::rc::Rc;

/// Returns a text that identifies an instance: the declaration and its static arguments.
pub(crate) fn instance_key(id: DeclId, statics: &StaticBindings) -> String {
    let mut key = format!("{}", id.0);
    for (name, value) in statics {
        key.push(';');
        key.push_str(name);
        key.push('=');
        write_key(value, &mut key);
    }
    key
}

fn write_key(value: &StaticBinding, key: &mut String) {
    match value {
        // The mark distinguishes a type parameter from a declared type of the same name. A generic Kind 2 node is
        // checked with such types.
        StaticBinding::Type(Ty::Generic(name)) => {
            key.push('?');
            key.push_str(name);
        }
        StaticBinding::Type(ty) => key.push_str(&ty.to_string()),
        StaticBinding::LoadTime => key.push('?'),
        StaticBinding::Callable(callable, _) => callable.write_key(key),
        StaticBinding::Value(constant) => {
            for leaf in &*constant.leaves {
                let _ = write!(key, "{:x?},", leaf.slots());
            }
        }
    }
}

/// Returns the name of an instance with its static arguments in the order of the parameters: `Line`, `fill<<3>>`.
pub(crate) fn instance_name(
    program: &Program<'_>,
    name: &Name,
    params: &[StaticParamDecl<'_>],
    statics: &StaticBindings,
) -> Name {
    let shown = |value: &StaticBinding| match value {
        StaticBinding::Type(ty) => Some(ty.to_string()),
        StaticBinding::Value(constant) => Some(value_text(&constant.ty, &constant.leaves)),
        StaticBinding::Callable(callable, _) => Some(callable.name(program)),
        StaticBinding::LoadTime => None,
    };
    let given = params
        .iter()
        .filter_map(|param| statics.get(&param.name().name));
    let shown: Vec<String> = given.filter_map(shown).collect();
    match shown.is_empty() {
        true => name.clone(),
        false => format!("{name}<<{}>>", shown.join(", ")).into(),
    }
}

/// Returns the ports of the instance of a generic callable whose type parameters `open` are inferred from the
/// arguments, given in `subst`. `None` if a parameter cannot be inferred; this is reported at the second location if
/// there is one.
pub(crate) fn resolve_instance(
    cx: &mut Body<'_, '_>,
    header: &Rc<Header>,
    mut statics: StaticBindings,
    open: &[Name],
    subst: &Substitution,
    (span, told_at): (Span, Option<Span>),
) -> Option<Rc<Header>> {
    let mut left = Vec::new();
    for name in open {
        match (statics.get(name), subst.types.get(name)) {
            (Some(StaticBinding::Type(_)), Some(ty)) if ty.has_unknown() => return None,
            (Some(StaticBinding::Type(_)), Some(ty)) => {
                statics.insert(name.clone(), StaticBinding::Type(ty.clone()));
            }
            (Some(StaticBinding::LoadTime), _) => {}
            _ => left.push(name.clone()),
        }
    }
    if !left.is_empty() {
        told_at
            .into_iter()
            .for_each(|span| report_missing(cx, header.decl, &left, span));
        return None;
    }
    match open.is_empty() {
        true => Some(header.clone()),
        false if !constraint::check_constraints(cx, header.decl, &statics, span) => None,
        false => header::check_header(cx.checker, header.decl, Rc::new(statics)),
    }
}

/// Reports the static arguments `left` of declaration `id`, which are missing in a call at `span`.
pub(crate) fn report_missing(cx: &mut Body<'_, '_>, id: DeclId, left: &[Name], span: Span) {
    let decl = cx.checker.program.decl(id);
    let diagnostic = missing_static_args(&decl.name, left, span, decl.span);
    report::report_diagnostic(cx, diagnostic);
}

/// Returns the source text of the value of a static argument, of a type for which each value has [an instance of its
/// own](distinguishes_instances).
fn value_text(ty: &Ty, leaves: &[Leaf]) -> String {
    match (ty, leaves) {
        (Ty::Array(element, n), _) => {
            let size = (leaves.len() / (*n).max(1) as usize).max(1);
            let elements = leaves
                .chunks(size)
                .map(|leaves| value_text(element, leaves));
            format!("[{}]", elements.collect::<Vec<_>>().join(", "))
        }
        (Ty::Enum(known), [leaf]) => {
            let index = leaf.as_int().and_then(|index| usize::try_from(index).ok());
            let value = index.and_then(|index| known.values.get(index));
            value.map_or_else(String::new, Name::to_string)
        }
        (_, [leaf]) => match (leaf.as_int(), leaf.as_bool()) {
            (Some(number), _) => number.to_string(),
            (None, truth) => truth.unwrap_or_default().to_string(),
        },
        _ => String::new(),
    }
}
