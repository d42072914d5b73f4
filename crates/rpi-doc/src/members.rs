//! Tables of the members of a declaration: parameters, ports, fields, values and results, each with its doc comment.

use rpi_diag::{SourceMap, Span};
use rpi_driver::Inspection;
use rpi_sema::query::{Def, DefId, DefKind, FlowType};
use rpi_syntax::Dialect;

use crate::code;
use crate::html::escape;
use crate::links::anchor;
use crate::markdown::{Link, to_html};

/// Group of members of one kind (ports, fields, results) that one table of a declaration lists.
struct Group {
    title: &'static str,
    kind: DefKind,
    /// True if the table is shown even if no member has a doc comment, because the table contains more than the
    /// signature.
    always: bool,
}

const fn group(title: &'static str, kind: DefKind, always: bool) -> Group {
    Group {
        title,
        kind,
        always,
    }
}

const GROUPS: &[Group] = &[
    group("Static parameters", DefKind::StaticParam, false),
    group("Parameters", DefKind::Param, false),
    group("Given by the predecessor", DefKind::TakenOver, false),
    group("In-ports", DefKind::Input, false),
    group("Out-ports", DefKind::Output, false),
    group("Ports", DefKind::Port, true),
    group("Fields", DefKind::Field, true),
    group("Values", DefKind::EnumValue, true),
    group("Results", DefKind::Result, true),
];

/// Returns the tables of the members of a declaration (parameters, ports, fields, results) in HTML, with their doc
/// comments.
pub(crate) fn tables(seen: &Inspection, id: DefId, link: Link<'_>) -> String {
    let parts = parts(seen, id);
    let mut out = String::new();
    for group in GROUPS {
        let rows: Vec<&(DefId, &Def)> =
            parts.iter().filter(|(_, d)| d.kind == group.kind).collect();
        let documented = rows.iter().any(|(_, def)| def.doc.is_some());
        if !rows.is_empty() && (group.always || documented) {
            out.push_str(&table(seen, group, &rows, link));
        } else {
            out.extend(rows.iter().map(|(id, _)| target(seen, *id)));
        }
    }
    out
}

/// Returns the members of a declaration (parameters, ports, fields, values, results) in source order.
fn parts(seen: &Inspection, id: DefId) -> Vec<(DefId, &Def)> {
    let index = seen.index();
    let whole = index.def(id);
    let inside = |def: &Def| match def.kind {
        DefKind::EnumValue => whole.kind == DefKind::Type && whole.full_span.contains(def.span),
        _ => def.parent == Some(id),
    };
    let all = index.defs_in(whole.span.file);
    let mut parts: Vec<(DefId, &Def)> = all.filter(|(_, def)| inside(def)).collect();
    parts.sort_by_key(|(_, def)| def.span.start);
    parts
}

/// Returns an empty HTML element with the id of a member that has no row in a table, as the target of links to the
/// member.
fn target(seen: &Inspection, id: DefId) -> String {
    let anchor = anchor(seen, id).unwrap_or_default();
    format!("<span id=\"{}\"></span>\n", escape(&anchor))
}

fn table(seen: &Inspection, group: &Group, rows: &[&(DefId, &Def)], link: Link<'_>) -> String {
    let mut out = format!(
        "<table class=\"parts\"><caption>{}</caption>\n<tbody>\n",
        group.title
    );
    for (id, def) in rows {
        let anchor = anchor(seen, *id).unwrap_or_default();
        let about = def.doc.as_deref().map(|doc| to_html(doc, link));
        out.push_str(&format!(
            "<tr id=\"{}\"><th scope=\"row\"><code>{}</code></th><td>{}</td><td>{}{}</td></tr>\n",
            escape(&anchor),
            escape(&def.name),
            what(seen, def, link),
            presence(seen, def),
            about.unwrap_or_default(),
        ));
    }
    out.push_str("</tbody></table>\n");
    out
}

/// Returns the type and default of a member, or the condition of a result, as HTML; empty for the value of an enum.
fn what(seen: &Inspection, def: &Def, link: Link<'_>) -> String {
    let text = match def.kind {
        DefKind::Result => seen
            .sources
            .slice(def.full_span)
            .trim_end_matches(';')
            .to_owned(),
        DefKind::EnumValue => return String::new(),
        _ => type_text(seen, def),
    };
    if text.is_empty() {
        return String::new();
    }
    format!(
        "<code>{}</code>",
        code::code(&one_line(&text), Dialect::Rpi, link)
    )
}

/// Returns the type and default of a member as text, such as `real = 0.0`. For a member without a written type, the
/// text contains up to three inferred types.
pub(crate) fn type_text(seen: &Inspection, def: &Def) -> String {
    match def.ty {
        Some(ty) => {
            let written = seen.sources.slice(ty);
            let rest = rest_of(&seen.sources, def.full_span, ty);
            format!("{written}{rest}")
        }
        None => {
            let types = seen.types_of(def).iter().map(FlowType::to_string);
            types.take(3).collect::<Vec<_>>().join(" or ")
        }
    }
}

/// Returns the text of a declaration that follows its type: a clock or a default; empty if there is none. `whole` is
/// the range of the declaration, `ty` that of its type.
fn rest_of(sources: &SourceMap, whole: Span, ty: Span) -> String {
    let rest = Span::new(whole.file, ty.end, whole.end.max(ty.end));
    let rest = sources.slice(rest).trim().trim_end_matches(';');
    let is_part = rest.starts_with('=') || rest.starts_with("when ");
    match is_part && !rest.contains('\n') {
        true => format!(" {rest}"),
        false => String::new(),
    }
}

/// Returns a remark in HTML that a member may be absent, if its type is optional; else an empty text.
fn presence(seen: &Inspection, def: &Def) -> &'static str {
    let optional = def
        .ty
        .is_some_and(|ty| seen.sources.slice(ty).ends_with('?'));
    match (optional, def.kind) {
        (true, DefKind::Input | DefKind::Param | DefKind::TakenOver) => "<em>may be absent</em> ",
        (true, _) => "<em>absent in some cycles</em> ",
        _ => "",
    }
}

/// Returns a text with each line break and each sequence of blanks replaced by a single space.
pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
