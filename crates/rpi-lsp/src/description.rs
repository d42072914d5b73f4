//! Description of a definition: kind, type, presence and documentation.

use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_sema::query::{Def, DefKind, FlowType};

/// Description of a definition (declaration, kind and documentation), shown by hover and completion.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Description {
    /// Declaration of the definition without its body, in the language of the program.
    pub(crate) code: String,
    /// Kind of the definition, such as `in-port`, and whether its value may be absent, in a few words.
    pub(crate) kind: String,
    /// Documentation of the definition in Markdown; empty if there is none.
    pub(crate) doc: String,
}

impl Description {
    /// Returns the text of a hover window: declaration and documentation, in Markdown.
    pub(crate) fn markdown(&self) -> String {
        let mut out = format!("```rpi\n{}\n```\n", self.code);
        if !self.kind.is_empty() {
            out.push_str(&format!("\n{}\n", self.kind));
        }
        if !self.doc.is_empty() {
            out.push_str(&format!("\n---\n\n{}\n", self.doc));
        }
        out
    }
}

/// Returns the description of a definition. `read` is the range of a use of the definition: the type inferred there
/// takes precedence over that of the declaration.
pub(crate) fn describe(seen: &Inspection, def: &Def, read: Option<Span>) -> Description {
    let types = types(seen, def, read);
    Description {
        code: code(seen, def, &types),
        kind: kind(seen, def, &types),
        doc: def.doc.as_deref().unwrap_or_default().to_owned(),
    }
}

/// Returns a one-line summary of a definition: `name: type` for a value, and kind and name for any other definition.
pub(crate) fn summary(seen: &Inspection, def: &Def) -> String {
    match def.kind.is_declared_value() {
        true => typed_name(seen, def, &types(seen, def, None)),
        false => format!("{} {}", def.kind.description(), def.name),
    }
}

fn types(seen: &Inspection, def: &Def, read: Option<Span>) -> Vec<FlowType> {
    if !def.kind.is_declared_value() {
        return Vec::new();
    }
    let read = read.filter(|span| *span != def.span);
    let read = read
        .map(|span| seen.types_of_read(span))
        .unwrap_or_default();
    match read.is_empty() {
        true => seen.types_of(def).to_vec(),
        false => read,
    }
}

fn code(seen: &Inspection, def: &Def, types: &[FlowType]) -> String {
    use DefKind::{
        Block, Command, Const, Device, EnumValue, Module, Result, State, Task, Test, Type,
    };
    match def.kind {
        Module => format!("use {}", def.name),
        Const | Type | Result => seen.sources.slice(def.full_span).to_owned(),
        EnumValue | State => format!("{} {}", def.kind.description(), def.name),
        Block => first_line(seen.sources.slice(def.full_span)),
        Command | Device | Task | Test => header(seen, def),
        kind if kind.is_callable() => header(seen, def),
        _ => typed_name(seen, def, types),
    }
}

fn first_line(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    line.trim_end().to_owned()
}

/// Returns the header of a declaration: its text without the body.
fn header(seen: &Inspection, def: &Def) -> String {
    let mode = seen.mode();
    let item = seen.item_around(def.full_span);
    let head = item
        .map(|item| rpi_syntax::header(item, mode))
        .filter(|head| !head.is_empty());
    head.unwrap_or_else(|| format!("{} {}", def.kind.description(), def.name))
}

/// Returns `name: type` for a definition. `types` are the inferred types, of which at most three are shown; if there
/// are none, the declared type is shown.
fn typed_name(seen: &Inspection, def: &Def, types: &[FlowType]) -> String {
    let found: Vec<String> = types.iter().take(3).map(FlowType::to_string).collect();
    let written = || def.ty.map(|span| seen.sources.slice(span).to_owned());
    let ty = match found.is_empty() {
        true => written(),
        false => Some(found.join(" or ")),
    };
    match ty {
        Some(ty) => format!("{}: {ty}", def.name),
        None => def.name.to_string(),
    }
}

fn kind(seen: &Inspection, def: &Def, types: &[FlowType]) -> String {
    let of = def.parent.map(|parent| seen.index().def(parent));
    let of = of.filter(|of| of.kind != DefKind::Module);
    let of = of.map_or(String::new(), |of| format!(" of `{}`", of.name));
    let presence = match types {
        [] => "",
        all if all.iter().any(|one| one.optional) => ", may be absent",
        _ => ", always present",
    };
    let from = match def.span.file {
        FileId(0) => String::new(),
        file => format!(", from `{}`", seen.sources.name(file)),
    };
    format!("{}{of}{presence}{from}", def.kind.description())
}
