//! Hashes of declarations, by which a check recognises those that are the same as in the previous check.

use rpi_diag::Span;
use rpi_syntax::ast::{Body, Item, ItemKind, Locals, NodeDef, NodeKind};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::rc::Rc;

/// Hashes of the text and location of a declaration, and the words in it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ItemHash {
    /// Hash of the whole declaration.
    pub whole: u64,
    /// Hash of everything that other declarations can refer to. For a declaration with a body, this is the text before the
    /// local declarations and statements.
    pub interface: u64,
    /// Hashes of the words in the part that other declarations can refer to.
    pub interface_words: Rc<[u64]>,
    /// Hashes of the words in the rest of the declaration.
    pub body_words: Rc<[u64]>,
    /// Whether the declaration decides which other declarations are visible: a `use` or `include`.
    pub is_import: bool,
}

impl ItemHash {
    /// Computes the hashes of a declaration. `text` is the text to which its locations refer.
    #[must_use]
    pub fn new(item: &Item, text: &str) -> ItemHash {
        let Span { file, start, end } = item.span;
        let slice = |start: u32, end: u32| text.get(start as usize..end as usize);
        let hash = |end: u32| hash_of(&(file, start, slice(start, end)));
        let inner = body(item).and_then(first_local);
        let interface_end = inner.filter(|at| (start..end).contains(at)).unwrap_or(end);
        ItemHash {
            whole: hash(end),
            interface: hash(interface_end),
            interface_words: word_hashes(slice(start, interface_end).unwrap_or_default()),
            body_words: word_hashes(slice(interface_end, end).unwrap_or_default()),
            is_import: matches!(item.kind, ItemKind::Use(_) | ItemKind::Include(_)),
        }
    }
}

fn hash_of(value: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

/// Returns the hashes of the words in a text, without duplicates. A word is a sequence of letters, digits and `_`, so that
/// each name in the text consists of words.
pub(crate) fn word_hashes(text: &str) -> Rc<[u64]> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    let words = words.filter(|word| !word.is_empty());
    let mut hashes: Vec<u64> = words.map(|word| hash_of(&word)).collect();
    hashes.sort_unstable();
    hashes.dedup();
    hashes.into()
}

/// Returns the body of a declaration if no other declaration depends on its content; `None` for other declarations.
fn body(item: &Item) -> Option<&Body> {
    match &item.kind {
        ItemKind::Node(node) if node.kind != NodeKind::Contract => match &node.definition {
            NodeDef::Body(body) => Some(body),
            _ => None,
        },
        ItemKind::Fragment(fragment) => Some(&fragment.body),
        ItemKind::Command(command) => Some(&command.body),
        ItemKind::Test(test) => Some(&test.body),
        _ => None,
    }
}

/// Returns the offset of the first local declaration or statement of a body; `None` if the body is empty.
fn first_local(body: &Body) -> Option<u32> {
    let local = body.locals.iter().find_map(|locals| match locals {
        Locals::Var(all) => Some(all.first()?.names.first()?.span.start),
        Locals::Const(all) => Some(all.first()?.names.first()?.span.start),
    });
    let statement = body
        .statements
        .first()
        .map(|statement| statement.span.start);
    local.or(statement)
}
