//! What each name of a text stands for. Names are local to their fragment.

use super::text::{BodyId, Definition, DefinitionId, Given, Kind, Place, Subject, Text, Word};
use rpi_diag::{Code, Finding};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// The word that stands for the enclosing fragment's in-ports.
pub(super) const PARENT: &str = "parent";

/// All names of a text.
pub(super) struct Names<'t> {
    definitions: HashMap<(BodyId, &'t str), DefinitionId>,
    aliases: HashMap<(BodyId, &'t str), Word<'t>>,
    outputs: HashMap<(BodyId, &'t str), usize>,
    inputs: HashMap<(DefinitionId, &'t str), usize>,
    repeated: Vec<bool>,
}

impl<'t> Names<'t> {
    /// Enters all names. The reference writes some definitions twice; the second is passed over if it says the same.
    pub(super) fn new(text: &Text<'t>, findings: &mut Vec<Finding>) -> Self {
        let mut names = Names {
            definitions: HashMap::with_capacity(text.definitions.len()),
            aliases: HashMap::new(),
            outputs: HashMap::new(),
            inputs: HashMap::new(),
            repeated: vec![false; text.definitions.len()],
        };
        for id in 0..text.definitions.len() {
            names.enter(text, id, findings);
        }
        for body in 0..text.fragments.len() {
            names.enter_aliases(text, body, findings);
            names.enter_outputs(text, body, findings);
        }
        names
    }

    /// The definition that a name stands for.
    pub(super) fn definition(&self, scope: BodyId, name: &'t str) -> Option<DefinitionId> {
        let mut name = name;
        // As many steps as there are second names: they may stand for each other in a circle.
        for _ in 0..self.aliases.len() {
            match self.aliases.get(&(scope, name)) {
                Some(other) => name = other.text,
                None => break,
            }
        }
        self.definitions.get(&(scope, name)).copied()
    }

    /// Index of an out-port of a fragment.
    pub(super) fn output(&self, body: BodyId, name: &str) -> Option<usize> {
        self.outputs.get(&(body, name)).copied()
    }

    /// Index of the argument that connects an in-port of a fragment.
    pub(super) fn input(&self, fragment: DefinitionId, name: &str) -> Option<usize> {
        self.inputs.get(&(fragment, name)).copied()
    }

    /// Whether a definition says again what another one has said, or stands inside one that does.
    pub(super) fn is_repeated(&self, id: DefinitionId) -> bool {
        self.repeated[id]
    }

    /// Whether a name is in use in a fragment.
    pub(super) fn is_taken(&self, scope: BodyId, name: &str) -> bool {
        self.definitions.contains_key(&(scope, name)) || self.aliases.contains_key(&(scope, name))
    }

    fn enter(&mut self, text: &Text<'t>, id: DefinitionId, findings: &mut Vec<Finding>) {
        let definition = &text.definitions[id];
        let outer = definition
            .owner
            .or(text.fragments[definition.scope].definition);
        self.repeated[id] = outer.is_some_and(|o| self.repeated[o]);
        if self.repeated[id] {
            return;
        }
        if let Kind::Fragment(_) = definition.kind {
            self.enter_inputs(id, definition);
        }
        let Some(name) = definition.name else {
            return;
        };
        if name.text == PARENT {
            findings.push(reserved(text, name));
        }
        match self.definitions.entry((definition.scope, name.text)) {
            Entry::Vacant(free) => {
                free.insert(id);
            }
            Entry::Occupied(first) => {
                self.repeated[id] = true;
                let first = &text.definitions[*first.get()];
                if !same(text, first, definition) {
                    findings.push(twice(text, name, first.place, definition.place));
                }
            }
        }
    }

    fn enter_inputs(&mut self, id: DefinitionId, definition: &Definition<'t>) {
        for (k, argument) in definition.arguments.iter().enumerate() {
            self.inputs.entry((id, argument.name.text)).or_insert(k);
        }
    }

    fn enter_aliases(&mut self, text: &Text<'t>, body: BodyId, findings: &mut Vec<Finding>) {
        for (name, other) in &text.fragments[body].aliases {
            let key = (body, name.text);
            let definition = self.definitions.get(&key);
            let alias = self.aliases.get(&key).copied();
            let other_meaning = match (definition, alias) {
                (Some(id), _) => Some(text.definitions[*id].place),
                (None, Some(word)) if word.text != other.text => Some(word.place()),
                _ => None,
            };
            match other_meaning {
                Some(first) => findings.push(twice(text, *name, first, other.place())),
                None => drop(self.aliases.insert(key, *other)),
            }
        }
    }

    fn enter_outputs(&mut self, text: &Text<'t>, body: BodyId, findings: &mut Vec<Finding>) {
        let outputs = &text.fragments[body].outputs;
        for (k, output) in outputs.iter().enumerate() {
            let first = *self.outputs.entry((body, output.name.text)).or_insert(k);
            let places = [first, k].map(|k| text.source_place(outputs[k].source));
            if text.slice(places[0]) != text.slice(places[1]) {
                findings.push(twice(text, output.name, places[0], places[1]));
            }
        }
    }
}

/// Whether two definitions say the same: letter for letter, or the same type with the same arguments in any order.
fn same<'t>(text: &Text<'t>, a: &Definition<'t>, b: &Definition<'t>) -> bool {
    if text.slice(a.place) == text.slice(b.place) {
        return true;
    }
    match (a.kind, b.kind) {
        (Kind::Primitive(x), Kind::Primitive(y)) if x.text == y.text => {
            arguments(text, a) == arguments(text, b)
        }
        _ => false,
    }
}

/// The arguments as they stand, recording times left out, sorted by name.
fn arguments<'t>(text: &Text<'t>, definition: &Definition<'t>) -> Vec<(&'t str, &'t str, &'t str)> {
    let mut all: Vec<_> = definition
        .arguments
        .iter()
        .map(|a| match &a.value {
            Given::Text(value) => (a.name.text, "'", value.text),
            Given::Link(source) => match source.of {
                Subject::Name(of) => (a.name.text, of.text, source.port.text),
                Subject::Definition(_) => (a.name.text, "", text.slice(text.source_place(*source))),
            },
        })
        .collect();
    all.sort_unstable();
    all
}

fn twice(text: &Text<'_>, name: Word<'_>, first: Place, second: Place) -> Finding {
    let name = name.text;
    Finding::new(
        Code::RPI1106,
        format!("`{name}` is defined twice, and not the same way"),
    )
    .at(text.span(second), "defined again here")
    .also(text.span(first), "first defined here")
    .help("give one of them another name, or delete the wrong one")
    .note("the same definition may stand twice: the reference writes its nets so")
}

fn reserved(text: &Text<'_>, name: Word<'_>) -> Finding {
    Finding::new(
        Code::RPI1106,
        "`parent` already means the enclosing fragment",
    )
    .at(text.span(name.place()), "defined here")
    .help("give this definition another name")
}
