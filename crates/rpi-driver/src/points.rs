//! Module `points`: the taught points, work frames and tools of `points.toml` beside a program, as constants and frames.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

use rpi_diag::{Code, Diagnostic, FileId, Span};
use rpi_sema::query::{DefKind, Index};
use rpi_sim::PointsFile;
use rpi_syntax::ast::{DeclaredKind, DeclaredName, File, Ident, Item, ItemKind};
use rpi_syntax::{Dialect, Name, parse};

use crate::library;
use crate::points_text::{declared_names, foreign_frame, module_text};

/// Name of the module, for which programs write `use points;`.
pub(crate) const MODULE: &str = "points";
/// Name of the file from which the module is made.
pub(crate) const FILE: &str = "points.toml";
/// Tables of the file.
const TABLES: [&str; 3] = ["frames", "tools", "points"];

/// Module with the points of a file.
#[derive(Debug)]
pub(crate) struct PointsModule {
    /// Text of the module.
    pub(crate) text: String,
    /// Names of its constants and frames, each with the name of the entry of the file that gives it.
    pub(crate) entries: BTreeMap<String, String>,
}

/// Error in a file with points.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PointsError {
    /// Bytes of the text that are wrong.
    pub span: Range<usize>,
    /// Description of the error.
    pub message: String,
    /// Suggestion for the user; `None` if there is none.
    pub help: Option<String>,
}

/// Checks the text of a file with points, of the path `path`. Returns all errors.
#[must_use]
pub fn check_points(path: &Path, text: &str) -> Vec<PointsError> {
    read(path, text, "program").err().unwrap_or_default()
}

/// Reads a file with points for the program whose module has the name `program`.
///
/// # Errors
/// Returns all errors of the text.
pub(crate) fn read(
    path: &Path,
    text: &str,
    program: &str,
) -> Result<PointsModule, Vec<PointsError>> {
    let parsed = PointsFile::parse(&path.display().to_string(), text);
    let file = parsed.map_err(|errors| {
        let all = errors.errors.into_iter();
        let error = all.map(|error| PointsError {
            span: error.span,
            message: error.message,
            help: error.help,
        });
        error.collect::<Vec<_>>()
    })?;
    let mut errors = wrong_names(&file);
    if let Some(frame) = foreign_frame(&file).filter(|_| !is_free_name(program)) {
        errors.push(PointsError {
            span: 0..text.find('\n').unwrap_or(text.len()),
            message: format!("the frame `{frame}` is not in {FILE}"),
            help: Some(format!(
                "add [frames.{frame}], or rename the program: `{program}` is not a name that `use` can have"
            )),
        });
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let entries = declared_names(&file).into_iter();
    let entries = entries.map(|(name, entry)| (name, entry.to_owned()));
    Ok(PointsModule {
        text: module_text(&file, text, program),
        entries: entries.collect(),
    })
}

/// Returns errors about names that are words of the language or names of the library, and about names that two entries give.
fn wrong_names(file: &PointsFile) -> Vec<PointsError> {
    let spans = file.frames.iter().map(|entry| (&entry.name, &entry.span));
    let spans = spans.chain(file.tools.iter().map(|entry| (&entry.name, &entry.span)));
    let spans = spans.chain(file.points.iter().map(|entry| (&entry.name, &entry.span)));
    let spans: BTreeMap<&str, &Range<usize>> =
        spans.map(|(name, span)| (name.as_str(), span)).collect();
    let mut errors = Vec::new();
    let mut error = |entry: &str, message: String| {
        errors.push(PointsError {
            span: spans.get(entry).map_or(0..0, |span| (*span).clone()),
            message,
            help: Some("give the entry another name".to_owned()),
        });
    };
    let library = library::implicit_names();
    let mut known: BTreeMap<String, &str> = BTreeMap::new();
    for (name, entry) in declared_names(file) {
        if library.contains(&name) {
            error(entry, format!("`{name}` is a name of the standard library"));
        } else if !is_free_name(&name) {
            error(entry, format!("`{name}` is a word of the language"));
        } else if let Some(other) = known.insert(name.clone(), entry) {
            error(entry, format!("`{other}` gives the name `{name}` as well"));
        }
    }
    errors
}

/// Returns whether a program can declare a constant with this name.
fn is_free_name(name: &str) -> bool {
    let declaration = format!("const {name}: int = 0;");
    let parsed = parse(FileId(0), &declaration, Dialect::Rpi);
    let is_constant = |item: &Item| matches!(item.kind, ItemKind::Const(_));
    parsed.diagnostics.is_empty() && parsed.file.items.iter().all(is_constant)
}

/// Returns the diagnostics of a file with errors, and a module that declares its names, so that their uses cause no further
/// errors.
pub(crate) fn faulty_module(
    file: FileId,
    text: &str,
    errors: &[PointsError],
) -> (Vec<Diagnostic>, File) {
    let span = |range: &Range<usize>| {
        let place = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
        Span {
            file,
            start: place(range.start),
            end: place(range.end),
        }
    };
    let diagnostics = errors.iter().map(|error| {
        let diagnostic = Diagnostic::new(Code::RPI1018, error.message.clone())
            .primary(span(&error.span), "in the list of points");
        match &error.help {
            Some(help) => diagnostic.help(help.clone()),
            None => diagnostic,
        }
    });
    let whole = span(&(0..text.len()));
    let names = names_in(text).into_iter().map(|name| DeclaredName {
        kind: DeclaredKind::Const,
        name: Ident {
            name: Name::from(name.as_str()),
            span: whole,
        },
    });
    let item = Item {
        doc: None,
        kind: ItemKind::Error(names.collect()),
        span: whole,
    };
    let module = File {
        items: vec![item],
        dialect: Dialect::Rpi,
    };
    (diagnostics.collect(), module)
}

/// Returns the names that the entries of a faulty file may give, as far as it is TOML.
fn names_in(text: &str) -> BTreeSet<String> {
    let tables = toml::from_str::<toml::Table>(text).unwrap_or_default();
    let entries = TABLES
        .iter()
        .filter_map(|table| tables.get(*table)?.as_table());
    let entries = entries.flat_map(|table| table.keys());
    let endings = ["", "_joints", "_mass", "_centre", "_inertia"];
    entries
        .flat_map(|name| endings.map(|ending| format!("{name}{ending}")))
        .collect()
}

/// Returns warnings about the entries of a file with points, whose module is `file`, that no other file of the program names.
/// An entry with several constants, such as a pose and joint positions, is used if one of them is.
pub(crate) fn unused_warnings(
    index: &Index,
    file: FileId,
    entries: &BTreeMap<String, String>,
) -> Vec<Diagnostic> {
    let used = index.referenced_outside(file);
    let defs = index.defs_in(file);
    let defs = defs.filter(|(_, def)| matches!(def.kind, DefKind::Const | DefKind::Frame));
    let mut unused: BTreeMap<&str, Option<Span>> = BTreeMap::new();
    for (id, def) in defs {
        let Some(entry) = entries.get(&*def.name) else {
            continue;
        };
        let place = unused.entry(entry).or_insert(Some(def.span));
        if used.contains(&id) {
            *place = None;
        }
    }
    let warning = |(entry, place): (&str, Option<Span>)| {
        let message = format!("`{entry}` of {FILE} is never used");
        let warning = Diagnostic::new(Code::RPI1019, message).primary(place?, "never used");
        Some(warning.help("delete it, or name it in the program"))
    };
    unused.into_iter().filter_map(warning).collect()
}
