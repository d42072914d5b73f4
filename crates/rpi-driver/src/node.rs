//! Compilation of a single node: its selection, its net, and the columns of its input and output tables.

use rpi_diag::{Diagnostic, FileId, Severity, SourceMap};
use rpi_image::Scalar;
use rpi_net::Column;
use rpi_sema::elab::{ClaimPolicy, PortShape, elaborate_node};
use rpi_sema::program::{DeclId, DeclKind};
use rpi_sema::ty::Ty;
use rpi_sema::typed::UnitId;
use rpi_syntax::ast::{ItemKind, NodeKind};
use rpi_syntax::{CommentKind, Dialect};

use crate::analysed_net::AnalysedNet;
use crate::compile::{display, program_text};
use crate::input::{Input, InputError};
use crate::program::{self, AnalysedProgram};
use crate::roots::called_units;
use crate::unit_analysis::{AnalysedUnit, analyse_unit, with_claims};

/// Result of compiling a single node of a file, to run the node on its own.
#[derive(Debug)]
pub struct CompiledNode {
    /// Source texts to which the locations in the diagnostics refer.
    pub sources: SourceMap,
    /// Errors and warnings of the program that declares the node.
    pub diagnostics: Vec<Diagnostic>,
    /// The compiled node; `None` if the program has errors.
    pub node: Option<Node>,
}

/// Compiled node that can be run on its own, with the columns of its input and output tables.
#[derive(Debug)]
pub struct Node {
    /// Net of the node. It exports the out-ports and the requested local flows by the keys of their columns.
    pub net: AnalysedNet,
    /// Columns of the input table: one for each scalar component of an in-port.
    pub inputs: Vec<Column>,
    /// Columns of the output table: one for each scalar component of an out-port.
    pub outputs: Vec<Column>,
    /// Columns for the local flows: one for each scalar component; empty unless requested.
    pub locals: Vec<Column>,
}

impl CompiledNode {
    /// Returns whether the diagnostics contain an error, which prevents the node from running.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics
            .iter()
            .any(|f| f.severity() == Severity::Error)
    }
}

/// Compiles one node of a program to a net. The node is the one with the given name; otherwise the one marked with
/// `--%MAIN`, the one named like the file, or the last one that no other node calls. `claims` is the treatment of
/// assertions and contracts; `locals` is whether local flows can be observed.
///
/// # Errors
/// If the file is not text or has no such node. Errors in the program are diagnostics instead.
pub fn compile_node(
    input: &Input,
    name: Option<&str>,
    claims: ClaimPolicy,
    locals: bool,
) -> Result<CompiledNode, InputError> {
    let (stem, path, text) = (input.stem(), display(&input.path), input.text()?);
    let mut sources = SourceMap::new();
    let modules = program_text(input, &stem, &path, text).modules(&mut sources);
    if let Some(why) = &modules.machine_error {
        return Err(why.clone());
    }
    let (made, diagnostics, _) =
        program::with_checked_program(&modules, &sources, |front, diagnostics| {
            if program::has_errors(diagnostics) {
                return Ok(None);
            }
            let unit = select_node(front, name, &main_nodes(text, &path), &stem)?;
            let elaborated = elaborate_node(
                &front.checked.units,
                front.facts,
                unit,
                ClaimPolicy::Report,
                locals,
            );
            let analysed = analyse_unit(front, unit, &[], elaborated, diagnostics);
            let analysed = analysed.and_then(|analysed| {
                let again =
                    || elaborate_node(&front.checked.units, front.facts, unit, claims, locals);
                with_claims(front, unit, analysed, claims, diagnostics, again)
            });
            Ok(analysed.map(node))
        });
    let node = made.map_err(|message: String| InputError::new(&input.path, message))?;
    Ok(CompiledNode {
        sources,
        diagnostics,
        node,
    })
}

fn select_node(
    front: &AnalysedProgram<'_>,
    name: Option<&str>,
    marked: &[String],
    stem: &str,
) -> Result<UnitId, String> {
    let nodes: Vec<(&str, UnitId)> = front
        .checked
        .runnable
        .iter()
        .filter(|(decl, _)| !is_not_a_node(front.program.decl(*decl).kind))
        .map(|(decl, unit)| (front.program.decl(*decl).name.as_str(), *unit))
        .collect();
    let named = |name: &str| nodes.iter().find(|node| node.0 == name).map(|node| node.1);
    if let Some(name) = name {
        return named(name).ok_or_else(|| no_such_node(front, name, &nodes));
    }
    let marked = marked.iter().find_map(|name| named(name));
    let found = marked
        .or_else(|| named(stem))
        .or_else(|| last_uncalled(front));
    found.ok_or_else(|| {
        let with_devices = ["command", "task"].map(|kind| format!("a {kind}"));
        let decls = front.program.root().decls.iter();
        let mut kinds = decls.map(|id| front.program.decl(*id).kind.description());
        match kinds.any(|kind| with_devices.iter().any(|known| known == kind)) {
            true => "there is no node in it that can be run by itself; its commands run without --node, --step, --inputs and the like".to_owned(),
            false => "there is no node in it that can be run".to_owned(),
        }
    })
}

/// Returns the last node that no other node calls; `None` if there is none. Calls from commands and tests do not count.
/// Nodes of the file itself take precedence over those of included files.
fn last_uncalled(front: &AnalysedProgram<'_>) -> Option<UnitId> {
    let is_node = |decl: DeclId| {
        let kind = &front.program.decl(decl).kind;
        matches!(kind, DeclKind::Node(node) if node.kind != NodeKind::Contract)
    };
    let runnable = front.checked.runnable.iter();
    let nodes: Vec<(DeclId, UnitId)> = runnable
        .filter(|(decl, _)| is_node(*decl))
        .copied()
        .collect();
    let called = called_units(nodes.iter().map(|(_, unit)| front.checked.unit(*unit)));
    let latest_first = nodes.into_iter().rev();
    let free = latest_first.filter(|(_, unit)| !called.contains(unit));
    let included = |decl: &DeclId| front.program.decl(*decl).span.file != OWN;
    free.min_by_key(|(decl, _)| included(decl))
        .map(|(_, unit)| unit)
}

/// Number of the file with the program text itself, which is always read first.
const OWN: FileId = FileId(0);

/// Returns whether a declaration is a contract or a test, which are checked like nodes but are not nodes.
fn is_not_a_node(kind: DeclKind<'_>) -> bool {
    match kind {
        DeclKind::Node(node) => node.kind == NodeKind::Contract,
        DeclKind::Test(_) => true,
        _ => false,
    }
}

fn no_such_node(front: &AnalysedProgram<'_>, name: &str, nodes: &[(&str, UnitId)]) -> String {
    let mut declared = front.program.root().decls.iter();
    if declared.any(|id| front.program.decl(*id).name == *name) {
        return format!(
            "`{name}` cannot be run alone: it is not a node, or needs static arguments"
        );
    }
    let names: Vec<&str> = nodes.iter().map(|node| node.0).collect();
    match rpi_diag::suggest(name, names.iter().copied()) {
        Some(meant) => format!("there is no node {name}; did you mean {meant}?"),
        None => format!("there is no node {name}, there are {}", names.join(", ")),
    }
}

/// Comment that marks the main node of a Lustre program, as in the model checker Kind 2.
const MARK: &str = "--%MAIN";

/// Returns the names of the nodes that contain the mark `--%MAIN` in a program text. The extension of `path` determines
/// the language.
fn main_nodes(text: &str, path: &str) -> Vec<String> {
    if !text.contains(MARK) {
        return Vec::new();
    }
    let parsed = rpi_syntax::parse(FileId(0), text, Dialect::from_path(path));
    let marks = parsed.comments.all.iter().filter(|comment| {
        let span = comment.span;
        let text = &text[span.start as usize..span.end as usize];
        comment.kind == CommentKind::Pragma && text.starts_with(MARK)
    });
    let places: Vec<u32> = marks.map(|comment| comment.span.start).collect();
    let items = parsed.file.items.iter();
    let around = items.filter(|item| {
        let mut places = places.iter();
        places.any(|place| (item.span.start..item.span.end).contains(place))
    });
    let nodes = around.filter_map(|item| match &item.kind {
        ItemKind::Node(node) => Some(node.signature.name.name.to_string()),
        _ => None,
    });
    nodes.collect()
}

fn node(mut analysed: AnalysedUnit) -> Node {
    let locals = analysed.locals.iter().map(|local| column(&local.shape));
    let locals = locals.collect();
    let ports = analysed.locals.into_iter().map(|local| local.port);
    analysed.net.export(ports);
    Node {
        inputs: analysed.inputs.iter().map(column).collect(),
        outputs: analysed.outputs.iter().map(column).collect(),
        net: analysed.net,
        locals,
    }
}

fn column(shape: &PortShape) -> Column {
    let values = match &shape.ty {
        Ty::Enum(e) => e.values.iter().map(ToString::to_string).collect(),
        _ => Vec::new(),
    };
    Column {
        key: shape.key.clone(),
        scalar: shape.ty.scalar().unwrap_or(Scalar::Bool),
        enum_values: values,
        optional: shape.optional,
        range: match shape.ty {
            Ty::Subrange(range) => Some(range.bounds()),
            _ => None,
        },
    }
}
