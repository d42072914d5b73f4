//! Name resolution of a net's text. Names are local to their fragment.

use super::parsed_text::{
    Argument, ArgumentValue, BodyId, Definition, DefinitionId, DefinitionKind, ParsedText, Subject,
    TextRange, Word,
};
use hashbrown::hash_table::{Entry, HashTable};
use rpi_diag::{Code, Diagnostic};
use rustc_hash::{FxBuildHasher, FxHashMap};
use std::hash::BuildHasher;

/// Reserved word in links to the in-ports of the enclosing fragment: `parent.port`.
pub(super) const PARENT: &str = "parent";

/// Symbol table of the text of a net: definitions, aliases and ports by name.
pub(super) struct SymbolTable<'t> {
    text: &'t ParsedText<'t>,
    /// Definitions by fragment and name. Both are stored in the definition, so that an entry of the table is only its
    /// index.
    definitions: HashTable<DefinitionId>,
    aliases: FxHashMap<(BodyId, &'t str), Word>,
    outputs: FxHashMap<(BodyId, &'t str), usize>,
    inputs: FxHashMap<(DefinitionId, &'t str), usize>,
    repeated: Vec<bool>,
}

impl<'t> SymbolTable<'t> {
    /// Enters all names of a text and reports conflicts. The reference system writes some definitions twice; an
    /// identical repetition is ignored.
    pub(super) fn new(text: &'t ParsedText<'t>, diagnostics: &mut Vec<Diagnostic>) -> Self {
        let mut names = SymbolTable {
            text,
            definitions: HashTable::with_capacity(text.definitions.len()),
            aliases: FxHashMap::default(),
            outputs: FxHashMap::default(),
            inputs: FxHashMap::default(),
            repeated: vec![false; text.definitions.len()],
        };
        for id in text.definition_ids() {
            names.insert(id, diagnostics);
        }
        for body in text.body_ids() {
            names.enter_aliases(body, diagnostics);
            names.enter_outputs(body, diagnostics);
        }
        names
    }

    /// Returns the definition with a name in the fragment `scope`, following aliases; `None` if there is none.
    pub(super) fn definition(&self, scope: BodyId, name: &'t str) -> Option<DefinitionId> {
        let mut name = name;
        // The number of steps is limited to the number of aliases, since aliases may form a cycle.
        for _ in 0..self.aliases.len() {
            match self.aliases.get(&(scope, name)) {
                Some(other) => name = self.text.str(*other),
                None => break,
            }
        }
        self.defined(scope, name)
    }

    fn defined(&self, scope: BodyId, name: &str) -> Option<DefinitionId> {
        let is = |id: &DefinitionId| has_name(self.text, *id, scope, name);
        self.definitions.find(hash(scope, name), is).copied()
    }

    /// Returns the index of the out-port with this name in a fragment; `None` if there is none.
    pub(super) fn output(&self, body: BodyId, name: &str) -> Option<usize> {
        self.outputs.get(&(body, name)).copied()
    }

    /// Returns the index of the argument that connects the in-port with this name of a fragment; `None` if there is
    /// none.
    pub(super) fn input(&self, fragment: DefinitionId, name: &str) -> Option<usize> {
        self.inputs.get(&(fragment, name)).copied()
    }

    /// Returns whether a definition repeats an earlier one, or is inside a definition that does.
    pub(super) fn is_duplicate(&self, id: DefinitionId) -> bool {
        self.repeated[id as usize]
    }

    /// Returns whether a name is in use in the fragment `scope`.
    pub(super) fn is_taken(&self, scope: BodyId, name: &str) -> bool {
        self.defined(scope, name).is_some() || self.aliases.contains_key(&(scope, name))
    }

    fn insert(&mut self, id: DefinitionId, diagnostics: &mut Vec<Diagnostic>) {
        let text = self.text;
        let definition = text.definition(id);
        let outer = definition.owner.or(text.body(definition.scope).definition);
        if outer.is_some_and(|o| self.is_duplicate(o)) {
            self.repeated[id as usize] = true;
            return;
        }
        if let DefinitionKind::Fragment(_) = definition.kind {
            self.enter_inputs(id, definition);
        }
        let (scope, Some(name)) = (definition.scope, definition.name) else {
            return;
        };
        let label = text.str(name);
        if label == PARENT {
            diagnostics.push(reserved(text, name));
        }
        let is = |id: &DefinitionId| has_name(text, *id, scope, label);
        let again = |id: &DefinitionId| hash_of(text, *id);
        match self.definitions.entry(hash(scope, label), is, again) {
            Entry::Vacant(free) => {
                free.insert(id);
            }
            Entry::Occupied(first) => {
                self.repeated[id as usize] = true;
                let first = text.definition(*first.get());
                if !is_same_definition(text, first, definition) {
                    diagnostics.push(conflicting_definition(
                        text,
                        name,
                        first.place,
                        definition.place,
                    ));
                }
            }
        }
    }

    fn enter_inputs(&mut self, id: DefinitionId, definition: &Definition) {
        for (k, argument) in self.text.arguments(definition).iter().enumerate() {
            let name = self.text.str(argument.name);
            self.inputs.entry((id, name)).or_insert(k);
        }
    }

    fn enter_aliases(&mut self, body: BodyId, diagnostics: &mut Vec<Diagnostic>) {
        let text = self.text;
        for (name, other) in &text.body(body).aliases {
            let key = (body, text.str(*name));
            let definition = self.defined(body, key.1);
            let alias = self.aliases.get(&key).copied();
            let other_meaning = match (definition, alias) {
                (Some(id), _) => Some(text.definition(id).place),
                (None, Some(word)) if text.str(word) != text.str(*other) => Some(word),
                _ => None,
            };
            match other_meaning {
                Some(first) => diagnostics.push(conflicting_definition(text, *name, first, *other)),
                None => drop(self.aliases.insert(key, *other)),
            }
        }
    }

    fn enter_outputs(&mut self, body: BodyId, diagnostics: &mut Vec<Diagnostic>) {
        let text = self.text;
        let outputs = &text.body(body).outputs;
        for (k, output) in outputs.iter().enumerate() {
            let key = (body, text.str(output.name));
            let first = *self.outputs.entry(key).or_insert(k);
            let places = [first, k].map(|k| text.source_place(outputs[k].source));
            if text.str(places[0]) != text.str(places[1]) {
                diagnostics.push(conflicting_definition(
                    text,
                    output.name,
                    places[0],
                    places[1],
                ));
            }
        }
    }
}

fn hash(scope: BodyId, name: &str) -> u64 {
    FxBuildHasher.hash_one((scope, name))
}

/// Returns the hash of the fragment and name of a definition.
fn hash_of(text: &ParsedText<'_>, id: DefinitionId) -> u64 {
    let definition = text.definition(id);
    let name = definition.name.map_or("", |n| text.str(n));
    hash(definition.scope, name)
}

fn has_name(text: &ParsedText<'_>, id: DefinitionId, scope: BodyId, name: &str) -> bool {
    let definition = text.definition(id);
    definition.scope == scope && definition.name.is_some_and(|n| text.str(n) == name)
}

/// Returns whether two definitions are equal: the same text, or the same primitive with the same arguments in any
/// order.
fn is_same_definition(text: &ParsedText<'_>, a: &Definition, b: &Definition) -> bool {
    if text.str(a.place) == text.str(b.place) {
        return true;
    }
    match (a.kind, b.kind) {
        (DefinitionKind::Primitive(x), DefinitionKind::Primitive(y))
            if text.str(x) == text.str(y) =>
        {
            arguments(text, a) == arguments(text, b)
        }
        _ => false,
    }
}

/// Returns the arguments of a definition in a form for comparisons, sorted by name: name, subject and port of a link,
/// or name, quote and quoted value. Recording times are left out.
fn arguments<'t>(
    text: &ParsedText<'t>,
    definition: &Definition,
) -> Vec<(&'t str, &'t str, &'t str)> {
    let output = |a: &Argument| {
        let name = text.str(a.name);
        match a.value {
            ArgumentValue::Text(value) => (name, "'", text.str(value)),
            ArgumentValue::Link(source) => match source.subject {
                Subject::Name(of) => (name, text.str(of), text.str(source.port)),
                Subject::Definition(_) => (name, "", text.str(text.source_place(source))),
            },
        }
    };
    let mut all: Vec<_> = text.arguments(definition).iter().map(output).collect();
    all.sort_unstable();
    all
}

fn conflicting_definition(
    text: &ParsedText<'_>,
    name: Word,
    first: TextRange,
    second: TextRange,
) -> Diagnostic {
    let name = text.str(name);
    Diagnostic::new(
        Code::RPI1106,
        format!("conflicting definitions of `{name}`"),
    )
    .primary(text.span(second), "defined again here")
    .secondary(text.span(first), "first defined here")
    .help("give one of them another name, or delete the wrong one")
    .note("identical definitions may be repeated, as the reference system does")
}

fn reserved(text: &ParsedText<'_>, name: Word) -> Diagnostic {
    Diagnostic::new(
        Code::RPI1106,
        "`parent` is reserved for the enclosing fragment",
    )
    .primary(text.span(name), "defined here")
    .help("give this definition another name")
}
