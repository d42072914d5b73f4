//! Instances of what has static parameters: keys that tell them apart, and their names in messages.

use super::statics::{Param, Static, Statics};
use crate::program::{DeclId, Program};
use crate::ty::Ty;
use crate::typed::Leaf;
use rpi_syntax::Name;
use std::fmt::Write;

/// A key that tells one choice of static arguments from another.
pub(super) fn key(id: DeclId, statics: &Statics) -> String {
    let mut key = format!("{}", id.0);
    for (name, value) in statics {
        key.push(';');
        key.push_str(name);
        key.push('=');
        write_key(value, &mut key);
    }
    key
}

fn write_key(value: &Static, key: &mut String) {
    match value {
        // Not the same as a type that is called so, like that for which a generic node of Kind 2 is checked by itself.
        Static::Ty(Ty::Generic(name)) => {
            key.push('?');
            key.push_str(name);
        }
        Static::Ty(ty) => key.push_str(&ty.to_string()),
        Static::Opaque => key.push('?'),
        Static::Callee(callable, _) => callable.write_key(key),
        Static::Value(constant) => {
            for leaf in &*constant.leaves {
                let _ = write!(key, "{:x?},", leaf.cells());
            }
        }
    }
}

/// `Line`, `fill<<3>>`: a name with the static arguments that tell its instances apart, in the order of its parameters.
pub(super) fn display(
    program: &Program<'_>,
    name: &Name,
    params: &[Param<'_>],
    statics: &Statics,
) -> Name {
    let shown = |value: &Static| match value {
        Static::Ty(ty) => Some(ty.to_string()),
        Static::Value(constant) => Some(written(&constant.ty, &constant.leaves)),
        Static::Callee(callable, _) => Some(callable.name(program)),
        Static::Opaque => None,
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

/// A value that [tells apart](tells_apart), as it is written.
fn written(ty: &Ty, leaves: &[Leaf]) -> String {
    match (ty, leaves) {
        (Ty::Array(element, n), _) => {
            let size = (leaves.len() / (*n).max(1) as usize).max(1);
            let elements = leaves.chunks(size).map(|leaves| written(element, leaves));
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
