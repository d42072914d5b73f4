//! Collects the candidates for the place of the cursor.

use std::collections::BTreeSet;

use lsp_types::{CompletionItemKind, TextEdit};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_image::Scalar;
use rpi_prims::registry;
use rpi_sema::query::{Def, DefId, DefKind, builtins};
use rpi_sema::units::UNITS;
use rpi_syntax::ast::PortKind;
use rpi_syntax::{Dialect, KEYWORDS};

use super::candidate::{Candidate, Group};
use super::expected::{is_device, type_text};
use super::library::{self, LibraryKind};
use super::place::{ArgumentContext, Cursor, Place};
use super::{members, words};
use crate::description::summary;
use crate::highlights::written_names;
use crate::locations::LocationMap;

/// Kinds of definitions, each with the kind of completion item in the protocol. Definitions of other kinds are shown as
/// variables.
const ITEM_KINDS: &[(DefKind, CompletionItemKind)] = &[
    (DefKind::Module, CompletionItemKind::MODULE),
    (DefKind::Const, CompletionItemKind::CONSTANT),
    (DefKind::Type, CompletionItemKind::STRUCT),
    (DefKind::EnumValue, CompletionItemKind::ENUM_MEMBER),
    (DefKind::Field, CompletionItemKind::FIELD),
    (DefKind::Node, CompletionItemKind::FUNCTION),
    (DefKind::Function, CompletionItemKind::FUNCTION),
    (DefKind::Fragment, CompletionItemKind::CLASS),
    (DefKind::Primitive, CompletionItemKind::OPERATOR),
    (DefKind::Device, CompletionItemKind::INTERFACE),
    (DefKind::Port, CompletionItemKind::PROPERTY),
    (DefKind::Output, CompletionItemKind::PROPERTY),
    (DefKind::Command, CompletionItemKind::CLASS),
    (DefKind::Task, CompletionItemKind::CLASS),
    (DefKind::Result, CompletionItemKind::EVENT),
    (DefKind::Step, CompletionItemKind::EVENT),
    (DefKind::Block, CompletionItemKind::MODULE),
    (DefKind::State, CompletionItemKind::MODULE),
];

/// SI prefixes of units that are offered.
const PREFIXES: &[&str] = &["k", "c", "m", "u", "n", "M", "G"];

/// Collector of the candidates for the cursor position in a document.
pub(super) struct ItemCollector<'s> {
    pub(super) analysis: &'s Inspection,
    pub(super) places: &'s LocationMap<'s>,
    pub(super) offset: u32,
    pub(super) cursor: &'s Cursor,
    /// True if the client accepts snippets and no bracket follows the cursor.
    pub(super) has_snippets: bool,
    /// Keyword of the declaration at the top level around the cursor.
    pub(super) declaration: Option<&'s str>,
}

impl ItemCollector<'_> {
    /// Returns the candidates for the place of the cursor.
    pub(super) fn candidates(&self) -> Vec<Candidate> {
        use DefKind::{Command, State, Step, Task};
        let place = &self.cursor.place;
        let of_place = match place {
            Place::Member(path, is_target) => members::members(self, path, *is_target),
            Place::Unit => self.units(),
            Place::Module => self.modules(),
            Place::Type => self.types(),
            Place::Value(argument) => self.values(argument.as_ref()),
            Place::Statement => self.targets(),
            Place::Step | Place::Run => self.visible(|def| matches!(def.kind, Command | Task)),
            Place::Result(callee) => members::results(self, callee),
            Place::NextStep => self.in_declaration(Step),
            Place::NextState => self.visible(|def| def.kind == State),
            Place::Field(ty, given) => members::fields(self, ty, given),
            Place::Operator
            | Place::AfterStep
            | Place::State
            | Place::Declaration
            | Place::Header
            | Place::ResultCondition => Vec::new(),
        };
        of_place.into_iter().chain(self.keywords()).collect()
    }

    /// Returns the typed part of the word before the cursor.
    pub(super) fn typed(&self) -> &str {
        let text = self.analysis.sources.text(FileId(0));
        text.get(self.cursor.prefix.clone()).unwrap_or_default()
    }

    pub(super) fn def_candidate(&self, group: Group, id: DefId) -> Candidate {
        let def = self.analysis.index().def(id);
        let kind = ITEM_KINDS.iter().find(|(kind, _)| *kind == def.kind);
        let kind = kind.map_or(CompletionItemKind::VARIABLE, |(_, kind)| *kind);
        let new = Candidate::new(group, &def.name, kind)
            .with_detail(&summary(self.analysis, def))
            .with_data("def", id.0);
        let is_run = matches!(self.cursor.place, Place::Step | Place::Run);
        let is_called = def.kind.is_callable() || is_run;
        let ty = type_text(self.analysis, id);
        let new = Candidate { ty, ..new };
        match is_called && self.has_snippets {
            true => new.with_snippet(format!("{}($0)", def.name)),
            false => new,
        }
    }

    /// Returns the visible definitions that satisfy a condition, the nearest ones first.
    fn visible(&self, is_possible: impl Fn(&Def) -> bool) -> Vec<Candidate> {
        let index = self.analysis.index();
        let visible = index.visible(FileId(0), self.offset).into_iter();
        let possible = visible.filter(|id| is_possible(index.def(*id)));
        let group = |id: DefId| {
            let parent = index.def(id).parent.map(|parent| index.def(parent).kind);
            match parent.is_none_or(|kind| kind == DefKind::Module) {
                true => Group::Declared,
                false => Group::Local,
            }
        };
        possible
            .map(|id| self.def_candidate(group(id), id))
            .collect()
    }

    /// Returns the definitions of a kind in the declaration at the top level around the cursor.
    fn in_declaration(&self, kind: DefKind) -> Vec<Candidate> {
        let cursor = Span::new(FileId(0), self.offset, self.offset);
        let item = self.analysis.item_span_around(cursor);
        let all = self.analysis.index().defs_in(FileId(0));
        let here = all.filter(|(_, def)| {
            def.kind == kind && item.is_some_and(|item| item.contains(def.span))
        });
        here.map(|(id, _)| self.def_candidate(Group::Local, id))
            .collect()
    }

    /// Returns the names that can stand in a value: with the parameters of the call whose argument begins at the cursor.
    fn values(&self, argument: Option<&ArgumentContext>) -> Vec<Candidate> {
        let mut all = argument.map_or_else(Vec::new, |a| self.arguments(a));
        let is_static = argument.is_some_and(|argument| argument.is_static);
        all.extend(
            self.visible(|def| has_value(self.analysis, def) && (!is_static || is_fixed(def.kind))),
        );
        all.extend(self.builtin_names());
        all.extend(self.library_items(|kind| kind == LibraryKind::Value));
        all.extend(self.primitives());
        all
    }

    fn types(&self) -> Vec<Candidate> {
        let built_in = Scalar::ALL.iter().map(|scalar| match scalar {
            // Both spellings are known; programs use the one of the flow.
            Scalar::Time => "time".to_owned(),
            other => other.to_string(),
        });
        let named = built_in.filter(|name| KEYWORDS.iter().all(|word| word.text != name));
        let new = |name: String| Candidate::new(Group::Builtin, &name, CompletionItemKind::STRUCT);
        let mut all = self.visible(|def| {
            let is_parameter = def.kind == DefKind::StaticParam && def.ty.is_none();
            matches!(def.kind, DefKind::Type | DefKind::Device) || is_parameter
        });
        all.extend(named.map(new));
        all.extend(self.library_items(|kind| kind == LibraryKind::Type));
        all
    }

    /// Returns the names that an equation can define or that begin the path of an actuator: those without an equation
    /// first.
    fn targets(&self) -> Vec<Candidate> {
        let written = written_names(self.analysis);
        let index = self.analysis.index();
        let is_defined = |id: DefId| index.references(id).any(|span| written.contains(&span));
        let mut found = self.visible(|def| match def.kind {
            DefKind::Output => true,
            DefKind::Local => def.ty.is_some(),
            DefKind::Param => is_device(self.analysis, def),
            _ => false,
        });
        for one in &mut found {
            let id = index.resolve(FileId(0), self.offset, &one.label);
            one.group = match id.is_some_and(is_defined) {
                true => Group::Declared,
                false => Group::Local,
            };
        }
        found
    }

    fn units(&self) -> Vec<Candidate> {
        let unit = |name: &str, doc: &str| {
            Candidate::new(Group::Local, name, CompletionItemKind::UNIT).with_detail(doc)
        };
        let plain = UNITS.iter().map(|row| unit(row.name, row.doc));
        // Units with a prefix are many, and are offered once a letter is typed.
        let prefixes = PREFIXES.iter().filter(|_| !self.typed().is_empty());
        let prefixed = prefixes.flat_map(|prefix| {
            let scaled = UNITS.iter().filter(|row| row.takes_prefix);
            scaled.map(move |row| unit(&format!("{prefix}{}", row.name), row.doc))
        });
        plain.chain(prefixed).collect()
    }

    /// Returns each module of the standard library and each other `.rpi` file in the folder of the program.
    fn modules(&self) -> Vec<Candidate> {
        let mut names: BTreeSet<String> =
            rpi_driver::library_modules().map(str::to_owned).collect();
        let own = self.places.file(Span::NONE);
        let folder = own
            .parent()
            .and_then(|folder| std::fs::read_dir(folder).ok());
        for entry in folder.into_iter().flatten().flatten() {
            let path = entry.path();
            let stem = path.file_stem().and_then(|stem| stem.to_str());
            let is_rpi = path.extension().is_some_and(|e| e == "rpi") && path != own;
            names.extend(stem.filter(|_| is_rpi).map(str::to_owned));
        }
        let module = |name: &String| Candidate::new(Group::Local, name, CompletionItemKind::MODULE);
        names.iter().map(module).collect()
    }

    /// Returns `name: ` for each parameter of a call to which no argument is passed by name so far.
    fn arguments(&self, argument: &ArgumentContext) -> Vec<Candidate> {
        let index = self.analysis.index();
        let callee = index.resolve(FileId(0), self.offset, &argument.callee);
        let params = callee
            .map(|callee| index.parameters(callee))
            .unwrap_or_default();
        let is_open = |id: &DefId| {
            let def = index.def(*id);
            // An in-port can also get a constant among the static arguments: `on_delay<<delay: 3[ms]>>(x)`.
            let is_here = argument.is_static || def.kind != DefKind::StaticParam;
            is_here && !argument.passed.iter().any(|given| *given == *def.name)
        };
        let named = params.into_iter().filter(is_open).map(|id| {
            let text = format!("{}: ", index.def(id).name);
            let new = self.def_candidate(Group::Argument, id);
            Candidate {
                ty: String::new(),
                is_expected: argument.is_static,
                ..new.with_text(text)
            }
        });
        named.collect()
    }

    /// Returns the keywords of the place, in the language of the document.
    fn keywords(&self) -> Vec<Candidate> {
        let mode = self.analysis.mode();
        let place = &self.cursor.place;
        let texts = words::keywords(place, self.declaration, mode);
        let rows = texts.iter().filter_map(|text| {
            let row = KEYWORDS.iter().find(|word| word.text == *text);
            row.filter(|word| word.is_in(mode))
        });
        let new = rows.map(|word| {
            let new = Candidate::new(Group::Keyword, word.text, CompletionItemKind::KEYWORD);
            let new = new.with_detail(word.doc);
            match words::snippet(place, word.text).filter(|_| self.has_snippets) {
                Some(text) => new.with_snippet(text.to_owned()),
                None => new,
            }
        });
        new.collect()
    }

    fn builtin_names(&self) -> Vec<Candidate> {
        let mode = self.analysis.mode();
        let possible = builtins().filter(|one| mode == Dialect::Rpi || one.is_call);
        let new = possible.map(|one| {
            let kind = match one.is_call {
                true => CompletionItemKind::FUNCTION,
                false => CompletionItemKind::VARIABLE,
            };
            let ty = one.usage.split_once(": ").map_or("", |(_, ty)| ty);
            let new = Candidate {
                ty: ty.to_owned(),
                ..Candidate::new(Group::Builtin, one.name, kind)
            };
            new.with_detail(&one.usage).with_data("builtin", one.name)
        });
        new.collect()
    }

    /// Returns the names of some kind that a library module declares and that are not visible in the document. The
    /// candidate also inserts the `use` of the module.
    fn library_items(&self, is_possible: impl Fn(LibraryKind) -> bool) -> Vec<Candidate> {
        if self.analysis.mode() == Dialect::Lustre {
            return Vec::new();
        }
        let index = self.analysis.index();
        let known = |name: &str| index.resolve(FileId(0), self.offset, name).is_some();
        let offers = library::library_names().iter();
        let offers = offers.filter(|offer| is_possible(offer.kind) && !known(&offer.name));
        let new = offers.map(|offer| {
            let new = Candidate::new(Group::Library, &offer.name, CompletionItemKind::REFERENCE);
            Candidate {
                edit: Some(self.use_edit(offer.module)),
                ..new
            }
            .with_detail(&format!("use {}", offer.module))
            .with_data("library", offer.name.as_str())
        });
        new.collect()
    }

    /// Returns the edit that inserts `use module;` after the last `use` of the document, or at its start if there is
    /// none.
    fn use_edit(&self, module: &str) -> TextEdit {
        let text = self.analysis.sources.text(FileId(0));
        let uses = self.analysis.use_clauses();
        let last = uses.filter(|clause| clause.file == FileId(0)).last();
        let after = last.map_or(0, |clause| {
            let end = clause.end as usize;
            let line = text[end..].find('\n');
            line.map_or(text.len(), |length| end + length + 1)
        });
        let place = u32::try_from(after).unwrap_or(u32::MAX);
        let range = self.places.range(Span::new(FileId(0), place, place));
        let apart = if after == 0 { "\n" } else { "" };
        TextEdit::new(range, format!("use {module};\n{apart}"))
    }

    /// Returns the primitives, which are many, if a word is typed.
    fn primitives(&self) -> Vec<Candidate> {
        if self.typed().is_empty() {
            return Vec::new();
        }
        let new = |prim: &rpi_prims::Prim| {
            let name = prim.desc.name;
            Candidate::new(Group::Primitive, name, CompletionItemKind::OPERATOR)
                .with_data("primitive", name)
        };
        registry().iter().map(new).collect()
    }

    /// Returns the kind of port that a definition in a device type is; `None` if it is no port.
    pub(super) fn port_kind(&self, id: DefId) -> Option<PortKind> {
        let span = self.analysis.index().def(id).span;
        self.analysis.port_kind_at(span)
    }
}

/// Returns whether the value of a definition of this kind is fixed when the program is loaded, or it can be computed from
/// such values.
fn is_fixed(kind: DefKind) -> bool {
    use DefKind::{Const, EnumValue, Fragment, Function, Node, StaticParam, Type};
    matches!(
        kind,
        Const | EnumValue | Fragment | Function | Node | StaticParam | Type
    )
}

/// Returns whether a definition can stand in a value. Types can if they have fields, as in `Pair { left = 1.0 }`.
fn has_value(seen: &Inspection, def: &Def) -> bool {
    use DefKind::{Device, Module, Primitive, Result, State, Step, Task, Test, Type};
    match def.kind {
        Type => {
            let id = seen
                .index()
                .resolve(def.span.file, def.span.start, &def.name);
            id.is_some_and(|id| !seen.index().members(id).is_empty())
        }
        // Primitives have a list of their own.
        Device | Module | Primitive | Result | State | Step | Task | Test => false,
        _ => true,
    }
}
