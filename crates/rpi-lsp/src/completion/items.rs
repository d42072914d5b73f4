//! Collects the completion items for the kind of name that is expected.

use std::collections::BTreeSet;

use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, Documentation, MarkupContent,
    MarkupKind, Range, TextEdit,
};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_prims::registry;
use rpi_sema::query::{DefId, DefKind, FlowType, builtins, spatial_parts};
use rpi_sema::ty::Ty;
use rpi_sema::units::UNITS;
use rpi_syntax::{Dialect, KEYWORDS};

use super::cursor::{ArgumentContext, Cursor, ExpectedName, MemberPath};
use super::library;
use crate::description::summary;
use crate::locations::LocationMap;
use crate::primitive;

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
    (DefKind::Block, CompletionItemKind::MODULE),
    (DefKind::State, CompletionItemKind::MODULE),
];

/// Group of completion items. The editor lists the groups in this order, so that the names declared nearest to the
/// cursor come first.
#[derive(Clone, Copy)]
enum SortGroup {
    Argument,
    Local,
    Declared,
    Builtin,
    Keyword,
    Library,
    Primitive,
}

/// Collector of the completion items (suggestions) for the cursor position in a document.
pub(super) struct ItemCollector<'s> {
    analysis: &'s Inspection,
    places: &'s LocationMap<'s>,
    offset: u32,
    cursor: &'s Cursor,
    range: Range,
}

impl<'s> ItemCollector<'s> {
    pub(super) fn new(
        seen: &'s Inspection,
        places: &'s LocationMap<'s>,
        offset: u32,
        cursor: &'s Cursor,
    ) -> ItemCollector<'s> {
        let start = u32::try_from(cursor.prefix.start).unwrap_or(u32::MAX);
        ItemCollector {
            analysis: seen,
            places,
            offset,
            cursor,
            range: places.range(Span::new(FileId(0), start, offset)),
        }
    }

    pub(super) fn items(&self) -> Vec<CompletionItem> {
        match &self.cursor.expected {
            ExpectedName::Member(path) => self.members(path),
            ExpectedName::Unit => self.units(),
            ExpectedName::Module => self.modules(),
            ExpectedName::Name(argument) => {
                let mut all = argument
                    .as_ref()
                    .map_or_else(Vec::new, |a| self.arguments(a));
                all.extend(self.visible_names());
                all.extend(self.keywords());
                all.extend(self.library_items());
                all.extend(self.primitives());
                all
            }
        }
    }

    fn item(&self, group: SortGroup, label: &str, kind: CompletionItemKind) -> CompletionItem {
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

    fn def_item(&self, group: SortGroup, id: DefId) -> CompletionItem {
        let def = self.analysis.index().def(id);
        let kind = ITEM_KINDS.iter().find(|(kind, _)| *kind == def.kind);
        let kind = kind.map_or(CompletionItemKind::VARIABLE, |(_, kind)| *kind);
        CompletionItem {
            detail: Some(summary(self.analysis, def)),
            documentation: def.doc.as_deref().map(markdown),
            ..self.item(group, &def.name, kind)
        }
    }

    /// Returns a suggestion for each member of the value or declaration to which a path leads: fields, ports, results,
    /// inner flows.
    fn members(&self, path: &MemberPath) -> Vec<CompletionItem> {
        let Some(last) = self.resolve(path) else {
            return Vec::new();
        };
        let index = self.analysis.index();
        let members = index.members(last).into_iter();
        let members = members.map(|id| self.def_item(SortGroup::Local, id));
        let parts = self.analysis.types_of(index.def(last));
        members.chain(self.parts(parts)).collect()
    }

    /// Returns the declaration to which a path of names such as `arm.pose` leads; `None` if a name is undefined.
    fn resolve(&self, path: &MemberPath) -> Option<DefId> {
        let index = self.analysis.index();
        let root = index.resolve(FileId(0), self.offset, &path.root)?;
        let only = |id: DefId| match index.members(id)[..] {
            [one] => one,
            _ => id,
        };
        let root = if path.is_call { only(root) } else { root };
        let mut names = path.rest.iter();
        names.try_fold(root, |owner, name| index.member(owner, name))
    }

    /// Returns a suggestion for each part of a value of a spatial type, such as the position and the rotation of a
    /// pose.
    fn parts(&self, types: &[FlowType]) -> Vec<CompletionItem> {
        let parts = types.iter().flat_map(|typed| match typed.ty {
            Ty::Spatial(scalar, _) => spatial_parts(scalar).collect::<Vec<_>>(),
            _ => Vec::new(),
        });
        let parts: BTreeSet<&str> = parts.collect();
        let part = |name: &str| self.item(SortGroup::Local, name, CompletionItemKind::PROPERTY);
        parts.into_iter().map(part).collect()
    }

    fn units(&self) -> Vec<CompletionItem> {
        let unit = |name: &str, doc: &str| CompletionItem {
            detail: Some(doc.to_owned()),
            ..self.item(SortGroup::Local, name, CompletionItemKind::UNIT)
        };
        UNITS.iter().map(|row| unit(row.name, row.doc)).collect()
    }

    /// Returns a suggestion for each module of the standard library and each other `.rpi` file in the folder of the
    /// program.
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
        let module = |name: &String| self.item(SortGroup::Local, name, CompletionItemKind::MODULE);
        names.iter().map(module).collect()
    }

    /// Returns a suggestion `name: ` for each parameter of a call to which no argument is passed by name so far.
    fn arguments(&self, argument: &ArgumentContext) -> Vec<CompletionItem> {
        let index = self.analysis.index();
        let callee = index.resolve(FileId(0), self.offset, &argument.callee);
        let params = callee
            .map(|callee| index.parameters(callee))
            .unwrap_or_default();
        let open = params.into_iter().filter(|id| {
            let name = index.def(*id).name.as_str();
            !argument.passed.iter().any(|given| given == name)
        });
        let named = open.map(|id| {
            let text = format!("{}: ", index.def(id).name);
            CompletionItem {
                text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(self.range, text))),
                ..self.def_item(SortGroup::Argument, id)
            }
        });
        named.collect()
    }

    fn visible_names(&self) -> Vec<CompletionItem> {
        let index = self.analysis.index();
        let visible = index.visible(FileId(0), self.offset);
        let of = |id: DefId| {
            let parent = index.def(id).parent.map(|parent| index.def(parent).kind);
            let is_top = parent.is_none_or(|kind| kind == DefKind::Module);
            // Primitives are listed by `primitives`, and tests are never referred to.
            let is_unnamed = matches!(index.def(id).kind, DefKind::Primitive | DefKind::Test);
            let group = if is_top {
                SortGroup::Declared
            } else {
                SortGroup::Local
            };
            (!is_unnamed).then(|| self.def_item(group, id))
        };
        visible.into_iter().filter_map(of).collect()
    }

    /// Returns a suggestion for each predeclared name and each keyword of the language of the document.
    fn keywords(&self) -> Vec<CompletionItem> {
        let mode = self.analysis.mode();
        let keywords = KEYWORDS
            .iter()
            .filter(|word| word.is_in(mode))
            .map(|word| CompletionItem {
                detail: Some(word.doc.to_owned()),
                ..self.item(SortGroup::Keyword, word.text, CompletionItemKind::KEYWORD)
            });
        let built_in = builtins().filter(|one| mode == Dialect::Rpi || one.is_call);
        let built_in = built_in.map(|one| {
            let kind = match one.is_call {
                true => CompletionItemKind::FUNCTION,
                false => CompletionItemKind::VARIABLE,
            };
            CompletionItem {
                detail: Some(one.usage.clone()),
                documentation: Some(markdown(one.doc.trim())),
                ..self.item(SortGroup::Builtin, one.name, kind)
            }
        });
        built_in.chain(keywords).collect()
    }

    /// Returns a suggestion for each name that a library module declares and that is not visible in the document. The
    /// suggestion also inserts the `use` of the module.
    fn library_items(&self) -> Vec<CompletionItem> {
        if self.analysis.mode() == Dialect::Lustre {
            return Vec::new();
        }
        let index = self.analysis.index();
        let known = |name: &str| index.resolve(FileId(0), self.offset, name).is_some();
        let offers = library::library_names()
            .iter()
            .filter(|offer| !known(&offer.name));
        let of = |offer: &library::LibraryName| CompletionItem {
            detail: Some(format!("use {}", offer.module)),
            documentation: Some(markdown(&format!(
                "```rpi\n{}\n```\n\n{}",
                offer.head,
                offer.doc.as_deref().unwrap_or_default()
            ))),
            additional_text_edits: Some(vec![self.use_edit(offer.module)]),
            ..self.item(
                SortGroup::Library,
                &offer.name,
                CompletionItemKind::REFERENCE,
            )
        };
        offers.map(of).collect()
    }

    /// Returns the edit that inserts `use module;` after the last `use` of the document, or at its start if there is
    /// none.
    fn use_edit(&self, module: &str) -> TextEdit {
        let text = self.analysis.sources.text(FileId(0));
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

    /// Returns a suggestion for each primitive whose name contains the text typed before the cursor, ignoring case;
    /// none if no text has been typed.
    fn primitives(&self) -> Vec<CompletionItem> {
        let text = self.analysis.sources.text(FileId(0));
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
            ..self.item(
                SortGroup::Primitive,
                desc.name,
                CompletionItemKind::OPERATOR,
            )
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
