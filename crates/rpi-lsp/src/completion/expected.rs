//! Types of candidates, and the type that is expected at the cursor.

use rpi_diag::FileId;
use rpi_driver::Inspection;
use rpi_sema::query::{Def, DefId, DefKind, Reference};

use super::members;
use super::place::{ArgumentContext, Cursor, MemberPath, Place, member_path};
use super::structure::{Bracket, Structure};
use crate::cursor_tokens::CursorToken;

/// What decides the type of the value at the cursor.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum ExpectedType {
    /// A value with this path, on the left of the equation or of the operator before the cursor.
    SameAs(MemberPath),
    /// Parameter of a callee, by its name.
    Parameter(String, String),
    /// A Boolean condition.
    Condition,
}

/// Operators whose operands have the same type and unit.
const SAME_TYPE: &[&str] = &["=", "+", "-", "<", ">", "<=", ">=", "<>", "->", "??"];

impl ExpectedType {
    /// Returns what decides the type of a value after the tokens; `None` if that is unknown.
    pub(super) fn from_tokens(words: &[CursorToken<'_>]) -> Option<ExpectedType> {
        let (last, before) = words.split_last()?;
        match last.text {
            "if" | "when" | "not" | "and" | "or" | "until" | "unless" | "assert" | "xor" => {
                Some(ExpectedType::Condition)
            }
            ":" => {
                let structure = Structure::new(words);
                let name = before.last()?.text.to_owned();
                match structure.bracket() {
                    Some((_, Bracket::Call(callee))) => Some(ExpectedType::Parameter(callee, name)),
                    _ => None,
                }
            }
            text if SAME_TYPE.contains(&text) => {
                member_path(before).map(|(path, _)| ExpectedType::SameAs(path))
            }
            _ => None,
        }
    }
}

/// Returns the type of the value of a definition as text, without `?`. A callable has the type of its only output. Empty
/// if the type is unknown.
pub(super) fn type_text(seen: &Inspection, id: DefId) -> String {
    let index = seen.index();
    let def = index.def(id);
    if def.kind.is_callable() {
        let outputs = index.members(id);
        return match outputs[..] {
            [only] => value_type(seen, index.def(only)),
            _ => String::new(),
        };
    }
    if def.kind == DefKind::EnumValue {
        return enum_of(seen, def).unwrap_or_default();
    }
    value_type(seen, def)
}

/// Returns the name of the enum that declares a value.
fn enum_of(seen: &Inspection, value: &Def) -> Option<String> {
    let found = seen.type_around_declaration(value.span)?;
    Some(found.to_string())
}

fn value_type(seen: &Inspection, def: &Def) -> String {
    if let Some(found) = seen.types_of(def).first() {
        return found.ty.to_string();
    }
    let written = def.ty.map(|span| seen.sources.slice(span));
    written.unwrap_or_default().trim_end_matches('?').to_owned()
}

/// Returns the type that is expected at the cursor as text, without `?`; `None` if it is unknown.
pub(super) fn expected_type(seen: &Inspection, offset: u32, cursor: &Cursor) -> Option<String> {
    let ty = match (&cursor.expected, &cursor.place) {
        (Some(ExpectedType::Condition), _) => "bool".to_owned(),
        (Some(ExpectedType::SameAs(path)), _) => {
            type_text(seen, members::resolve(seen, offset, path)?)
        }
        (Some(ExpectedType::Parameter(callee, name)), _) => {
            parameter_type(seen, offset, callee, |_, def| *def.name == **name)?
        }
        (None, Place::Value(Some(argument))) => argument_type(seen, offset, argument)?,
        _ => return None,
    };
    (!ty.is_empty()).then_some(ty)
}

/// Returns the type of the parameter at the position of an argument.
fn argument_type(seen: &Inspection, offset: u32, argument: &ArgumentContext) -> Option<String> {
    parameter_type(seen, offset, &argument.callee, |position, def| {
        let is_static = def.kind == DefKind::StaticParam;
        is_static == argument.is_static && position == argument.position
    })
}

/// Returns the type of the first parameter of a callee that satisfies a condition, which gets the number of the
/// parameter among those of its list.
fn parameter_type(
    seen: &Inspection,
    offset: u32,
    callee: &str,
    is_it: impl Fn(usize, &Def) -> bool,
) -> Option<String> {
    let index = seen.index();
    let callee = index.resolve(FileId(0), offset, callee)?;
    let (mut statics, mut values) = (0, 0);
    for id in index.parameters(callee) {
        let def = index.def(id);
        let count = match def.kind == DefKind::StaticParam {
            true => &mut statics,
            false => &mut values,
        };
        if is_it(*count, def) {
            return Some(value_type(seen, def));
        }
        *count += 1;
    }
    None
}

/// Returns whether the declared type of a definition is a device type.
pub(super) fn is_device(seen: &Inspection, def: &Def) -> bool {
    let index = seen.index();
    let Some(ty) = def.ty else { return false };
    let is_device = |name: &Reference| index.def(name.def).kind == DefKind::Device;
    index.references_in(ty).first().is_some_and(is_device)
}
