//! Collects the completion items for the kind of name that is expected.

use std::collections::BTreeSet;

use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, Documentation, MarkupContent,
    MarkupKind, Range, TextEdit,
};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspected;
use rpi_prims::registry;
use rpi_sema::query::{DefId, DefKind, Typed, builtins, spatial_parts};
use rpi_sema::ty::Ty;
use rpi_sema::units::UNITS;
use rpi_syntax::{KEYWORDS, Mode};

use super::cursor::{Argument, Cursor, Path, Wanted};
use super::library;
use crate::describe::brief;
use crate::places::Places;
use crate::primitive;

/// Completion item kinds of the protocol, by kind of definition.
const KINDS: &[(DefKind, CompletionItemKind)] = &[
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
    (DefKind::Block, CompletionItemKind::MODULE),
    (DefKind::State, CompletionItemKind::MODULE),
];

/// Group of a completion item, in sort order: the closest names come first.
#[derive(Clone, Copy)]
enum Group {
    Argument,
    Near,
    Declared,
    Builtin,
    Keyword,
    Offered,
    Primitive,
}

/// Collector of completion items for a cursor.
pub(super) struct Names<'s> {
    seen: &'s Inspected,
    places: &'s Places<'s>,
    offset: u32,
    cursor: &'s Cursor,
    range: Range,
}

impl<'s> Names<'s> {
    pub(super) fn new(
        seen: &'s Inspected,
        places: &'s Places<'s>,
        offset: u32,
        cursor: &'s Cursor,
    ) -> Names<'s> {
        let start = u32::try_from(cursor.prefix.start).unwrap_or(u32::MAX);
        Names {
            seen,
            places,
            offset,
            cursor,
            range: places.range(Span::new(FileId(0), start, offset)),
        }
    }

    pub(super) fn list(&self) -> Vec<CompletionItem> {
        match &self.cursor.wanted {
            Wanted::Member(path) => self.members(path),
            Wanted::Unit => self.units(),
            Wanted::Module => self.modules(),
            Wanted::Name(argument) => {
                let mut all = argument
                    .as_ref()
                    .map_or_else(Vec::new, |a| self.arguments(a));
                all.extend(self.visible());
                all.extend(self.words());
                all.extend(self.offered());
                all.extend(self.primitives());
                all
            }
        }
    }

    fn item(&self, group: Group, label: &str, kind: CompletionItemKind) -> CompletionItem {
        CompletionItem {
            label: label.to_owned(),
            kind: Some(kind),
            sort_text: Some(format!("{}{label}", group as u8)),
            filter_text: Some(label.to_owned()),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(
                self.range,
                label.to_owned(),
            ))),
            ..CompletionItem::default()
        }
    }

    fn of_def(&self, group: Group, id: DefId) -> CompletionItem {
        let def = self.seen.index().def(id);
        let kind = KINDS.iter().find(|(kind, _)| *kind == def.kind);
        let kind = kind.map_or(CompletionItemKind::VARIABLE, |(_, kind)| *kind);
        CompletionItem {
            detail: Some(brief(self.seen, def)),
            documentation: def.doc.as_deref().map(markdown),
            ..self.item(group, &def.name, kind)
        }
    }

    /// Returns the members of a path: fields, ports, results, inner flows.
    fn members(&self, path: &Path) -> Vec<CompletionItem> {
        let Some(last) = self.behind(path) else {
            return Vec::new();
        };
        let index = self.seen.index();
        let members = index.members(last).into_iter();
        let members = members.map(|id| self.of_def(Group::Near, id));
        let parts = self.seen.types_of(index.def(last));
        members.chain(self.parts(parts)).collect()
    }

    /// Resolves a path.
    fn behind(&self, path: &Path) -> Option<DefId> {
        let index = self.seen.index();
        let root = index.resolve(FileId(0), self.offset, &path.root)?;
        let only = |id: DefId| match index.members(id)[..] {
            [one] => one,
            _ => id,
        };
        let root = if path.is_call { only(root) } else { root };
        let mut names = path.rest.iter();
        names.try_fold(root, |owner, name| index.member(owner, name))
    }

    /// Returns the parts of a spatial type (such as position and rotation).
    fn parts(&self, types: &[Typed]) -> Vec<CompletionItem> {
        let parts = types.iter().flat_map(|typed| match typed.ty {
            Ty::Spatial(scalar, _) => spatial_parts(scalar).collect::<Vec<_>>(),
            _ => Vec::new(),
        });
        let parts: BTreeSet<&str> = parts.collect();
        let part = |name: &str| self.item(Group::Near, name, CompletionItemKind::PROPERTY);
        parts.into_iter().map(part).collect()
    }

    fn units(&self) -> Vec<CompletionItem> {
        let unit = |name: &str, doc: &str| CompletionItem {
            detail: Some(doc.to_owned()),
            ..self.item(Group::Near, name, CompletionItemKind::UNIT)
        };
        UNITS.iter().map(|row| unit(row.name, row.doc)).collect()
    }

    /// Returns the modules of the standard library, and the `.rpi` files in the folder of the program.
    fn modules(&self) -> Vec<CompletionItem> {
        let mut names: BTreeSet<String> =
            rpi_driver::library_modules().map(str::to_owned).collect();
        let own = self.places.file(Span::NONE);
        let beside = own
            .parent()
            .and_then(|folder| std::fs::read_dir(folder).ok());
        for path in beside
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
        {
            let stem = path.file_stem().and_then(|stem| stem.to_str());
            let is_rpi = path.extension().is_some_and(|e| e == "rpi") && path != own;
            names.extend(stem.filter(|_| is_rpi).map(str::to_owned));
        }
        let module = |name: &String| self.item(Group::Near, name, CompletionItemKind::MODULE);
        names.iter().map(module).collect()
    }

    /// Returns the parameters of a call that are not passed by name yet, as `name: `.
    fn arguments(&self, argument: &Argument) -> Vec<CompletionItem> {
        let index = self.seen.index();
        let callee = index.resolve(FileId(0), self.offset, &argument.callee);
        let params = callee
            .map(|callee| index.parameters(callee))
            .unwrap_or_default();
        let open = params.into_iter().filter(|id| {
            let name = index.def(*id).name.as_str();
            !argument.given.iter().any(|given| given == name)
        });
        let named = open.map(|id| {
            let text = format!("{}: ", index.def(id).name);
            CompletionItem {
                text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(self.range, text))),
                ..self.of_def(Group::Argument, id)
            }
        });
        named.collect()
    }

    fn visible(&self) -> Vec<CompletionItem> {
        let index = self.seen.index();
        let visible = index.visible(FileId(0), self.offset);
        let of = |id: DefId| {
            let parent = index.def(id).parent.map(|parent| index.def(parent).kind);
            let is_top = parent.is_none_or(|kind| kind == DefKind::Module);
            // Primitives are listed by `primitives`, and tests are never referred to.
            let is_unnamed = matches!(index.def(id).kind, DefKind::Primitive | DefKind::Test);
            let group = if is_top { Group::Declared } else { Group::Near };
            (!is_unnamed).then(|| self.of_def(group, id))
        };
        visible.into_iter().filter_map(of).collect()
    }

    /// Returns the predeclared names and the keywords.
    fn words(&self) -> Vec<CompletionItem> {
        let mode = self.seen.mode();
        let keywords = KEYWORDS
            .iter()
            .filter(|word| word.is_in(mode))
            .map(|word| CompletionItem {
                detail: Some(word.doc.to_owned()),
                ..self.item(Group::Keyword, word.text, CompletionItemKind::KEYWORD)
            });
        let built_in = builtins().filter(|one| mode == Mode::Rpi || one.is_call);
        let built_in = built_in.map(|one| {
            let kind = match one.is_call {
                true => CompletionItemKind::FUNCTION,
                false => CompletionItemKind::VARIABLE,
            };
            CompletionItem {
                detail: Some(one.form.clone()),
                documentation: Some(markdown(one.doc.trim())),
                ..self.item(Group::Builtin, one.name, kind)
            }
        });
        built_in.chain(keywords).collect()
    }

    /// Returns the names of library modules that are not imported yet, with an edit that adds the `use`.
    fn offered(&self) -> Vec<CompletionItem> {
        if self.seen.mode() == Mode::Lustre {
            return Vec::new();
        }
        let index = self.seen.index();
        let known = |name: &str| index.resolve(FileId(0), self.offset, name).is_some();
        let offers = library::offers().iter().filter(|offer| !known(&offer.name));
        let of = |offer: &library::Offer| CompletionItem {
            detail: Some(format!("use {}", offer.module)),
            documentation: Some(markdown(&format!(
                "```rpi\n{}\n```\n\n{}",
                offer.head,
                offer.doc.as_deref().unwrap_or_default()
            ))),
            additional_text_edits: Some(vec![self.use_of(offer.module)]),
            ..self.item(Group::Offered, &offer.name, CompletionItemKind::REFERENCE)
        };
        offers.map(of).collect()
    }

    /// Returns the edit that inserts `use module;` after the last `use`, or at the start of the text.
    fn use_of(&self, module: &str) -> TextEdit {
        let text = self.seen.sources.text(FileId(0));
        let lines = text.split_inclusive('\n');
        let mut at = 0;
        let mut after = 0;
        for line in lines {
            at += line.len();
            if line.trim_start().starts_with("use ") {
                after = at;
            }
        }
        let place = u32::try_from(after).unwrap_or(u32::MAX);
        let range = self.places.range(Span::new(FileId(0), place, place));
        let apart = if after == 0 { "\n" } else { "" };
        TextEdit::new(range, format!("use {module};\n{apart}"))
    }

    /// Returns the primitives whose name contains the typed text; none if nothing has been typed.
    fn primitives(&self) -> Vec<CompletionItem> {
        let text = self.seen.sources.text(FileId(0));
        let written = text.get(self.cursor.prefix.clone()).unwrap_or_default();
        let written = written.to_lowercase();
        if written.is_empty() {
            return Vec::new();
        }
        let fits = |name: &str| name.to_lowercase().contains(&written);
        let fitting = registry().iter().filter(|prim| fits(prim.desc.name));
        let of = |desc: &rpi_image::PrimDesc| CompletionItem {
            documentation: Some(markdown(&format!(
                "```rpi\n{}\n```\n\n{}",
                primitive::signature(desc),
                primitive::doc(desc)
            ))),
            ..self.item(Group::Primitive, desc.name, CompletionItemKind::OPERATOR)
        };
        fitting.map(|prim| of(&prim.desc)).collect()
    }
}

fn markdown(text: &str) -> Documentation {
    Documentation::MarkupContent(MarkupContent {
        kind: MarkupKind::Markdown,
        value: text.to_owned(),
    })
}
