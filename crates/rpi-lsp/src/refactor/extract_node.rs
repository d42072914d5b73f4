//! Extract node: selected equations move to a node of their own.

use std::collections::BTreeSet;

use lsp_types::CodeActionKind;
use rpi_diag::{FileId, Span};
use rpi_sema::query::{Def, DefId, DefKind};
use rpi_syntax::Dialect;
use rpi_syntax::ast::{Statement, StatementKind};

use super::code_context::CodeContext;
use super::{Refactoring, edit, insertion};

/// Returns the refactorings that move the selected equations to a node, and to a fragment, that the body calls. Its
/// in-ports are the flows that the equations read, its out-ports the flows that the rest of the program reads.
pub(super) fn extract_node(context: &CodeContext<'_>) -> Vec<Refactoring> {
    let Some(parts) = Parts::new(context) else {
        return Vec::new();
    };
    let kinds = [("node", "extract node"), ("fragment", "extract fragment")];
    kinds
        .iter()
        .filter_map(|(keyword, title)| parts.extraction(context, keyword, title))
        .collect()
}

/// Selected equations, with the flows at their border.
struct Parts<'s> {
    /// Range from the first to the last equation.
    span: Span,
    inputs: Vec<&'s Def>,
    outputs: Vec<&'s Def>,
}

impl<'s> Parts<'s> {
    fn new(context: &CodeContext<'s>) -> Option<Parts<'s>> {
        (context.seen.mode() == Dialect::Rpi).then_some(())?;
        let equations = selected_equations(context)?;
        let span = equations.iter().map(|one| one.span).reduce(Span::merge)?;
        let index = context.seen.index();
        let names = index.references_in(span);
        let defined: BTreeSet<DefId> = equations
            .iter()
            .flat_map(|one| targets(one))
            .filter_map(|target| Some(index.reference_at(FileId(0), target.start)?.def))
            .collect();
        let mut inputs: Vec<&Def> = Vec::new();
        for id in names
            .iter()
            .map(|name| name.def)
            .filter(|id| !defined.contains(id))
        {
            let def = index.def(id);
            let is_known = inputs.iter().any(|known| known.span == def.span);
            if is_flow_of_body(context, def) && !is_known {
                inputs.push(def);
            }
        }
        let is_read_outside = |id: &&DefId| {
            let mut uses = index.references(**id);
            // A declared flow, such as an out-port, is read by others.
            index.def(**id).ty.is_some() || uses.any(|one| !span.contains(one))
        };
        let outputs: Vec<&Def> = defined
            .iter()
            .filter(is_read_outside)
            .map(|id| index.def(*id))
            .collect();
        (!outputs.is_empty()).then_some(Parts {
            span,
            inputs,
            outputs,
        })
    }

    fn extraction(
        &self,
        context: &CodeContext<'_>,
        keyword: &str,
        title: &str,
    ) -> Option<Refactoring> {
        let name = context.free_name("Extracted");
        let inputs = ports(context, &self.inputs)?;
        let outputs = ports(context, &self.outputs)?;
        let body = context.slice(self.span);
        let item = context.item?;
        let (line, _) = context.line_start(item_start(context, item.span.start));
        let declaration =
            format!("{keyword} {name} ({inputs}) returns ({outputs})\nlet\n  {body}\ntel\n\n");
        let names = |defs: &[&Def]| {
            let names: Vec<&str> = defs.iter().map(|def| def.name.as_str()).collect();
            names.join(", ")
        };
        let targets = names(&self.outputs);
        let arguments = names(&self.inputs);
        let call = match self.outputs.len() {
            1 => format!("{targets} = {name}({arguments});"),
            _ => format!("({targets}) = {name}({arguments});"),
        };
        Some(Refactoring::new(
            title,
            CodeActionKind::REFACTOR_EXTRACT,
            vec![insertion(line, declaration), edit(self.span, call)],
        ))
    }
}

/// Returns the selected equations, if the selection is a sequence of whole equations of one body.
fn selected_equations<'s>(context: &CodeContext<'s>) -> Option<Vec<&'s Statement>> {
    let inside = context
        .statements
        .iter()
        .filter(|one| context.selection.contains(one.span));
    let inside: Vec<&Statement> = inside.copied().collect();
    let is_equation = |one: &&Statement| match &one.kind {
        StatementKind::Equation(of) => of.targets.iter().all(|target| target.path.is_empty()),
        _ => false,
    };
    (!inside.is_empty() && inside.iter().all(is_equation)).then_some(())?;
    let first = inside.first()?.span;
    let last = inside.last()?.span;
    let is_whole = first.start == context.selection.start && last.end == context.selection.end;
    is_whole.then_some(inside)
}

fn targets(statement: &Statement) -> Vec<Span> {
    match &statement.kind {
        StatementKind::Equation(of) => of.targets.iter().map(|target| target.name.span).collect(),
        _ => Vec::new(),
    }
}

/// Returns whether a definition is a flow of the declaration around the selection, which a node gets as an argument.
fn is_flow_of_body(context: &CodeContext<'_>, def: &Def) -> bool {
    use DefKind::{Input, Local, Output, Param, StaticParam, TakenOver};
    let is_flow = matches!(
        def.kind,
        Input | Local | Output | Param | StaticParam | TakenOver
    );
    let item = context.item.map(|item| item.span);
    is_flow && item.is_some_and(|item| item.contains(def.span))
}

/// Returns the declarations of ports for flows; `None` if the type of one is unknown.
fn ports(context: &CodeContext<'_>, defs: &[&Def]) -> Option<String> {
    let port = |def: &&Def| {
        let written = def.ty.map(|span| context.slice(span).to_owned());
        let inferred = || match context.seen.types_of(def) {
            [one] => Some(one.to_string()),
            _ => None,
        };
        Some(format!("{}: {}", def.name, written.or_else(inferred)?))
    };
    let all: Option<Vec<String>> = defs.iter().map(port).collect();
    all.map(|all| all.join("; "))
}

/// Returns the offset at which a declaration starts, with its doc comment.
fn item_start(context: &CodeContext<'_>, start: u32) -> u32 {
    let mut at = start as usize;
    loop {
        let before = &context.text[..at];
        let line = before.trim_end_matches(['\n', '\r']);
        let is_next = before.len() - line.len() <= 1 || before.ends_with("\r\n");
        let last = line.rfind('\n').map_or(0, |end| end + 1);
        match is_next && line[last..].trim_start().starts_with("--") {
            true => at = last,
            false => return u32::try_from(at).unwrap_or(start),
        }
    }
}
