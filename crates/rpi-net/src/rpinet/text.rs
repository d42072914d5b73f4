//! A net's text taken apart: names as they stand, nothing resolved.
//!
//! Definitions lie in one list in the order of their beginnings, so that a definition comes before those inside it.

use rpi_diag::{FileId, Span};

/// A text and what stands in it.
#[derive(Debug)]
pub(super) struct Text<'t> {
    /// Where the text lies.
    pub(super) file: FileId,
    /// The whole text.
    pub(super) text: &'t str,
    /// All definitions.
    pub(super) definitions: Vec<Definition>,
    /// All arguments, those of one definition side by side.
    pub(super) arguments: Vec<Argument>,
    /// All fragments; the first is the root.
    pub(super) fragments: Vec<Body>,
}

/// A piece of the text, as byte offsets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Place {
    pub(super) start: u32,
    pub(super) end: u32,
}

/// A place or index in a text; texts are shorter than 4 GiB, the parser sees to it.
pub(super) fn number(k: usize) -> u32 {
    u32::try_from(k).unwrap_or(u32::MAX)
}

impl Place {
    pub(super) fn new(start: usize, end: usize) -> Self {
        let [start, end] = [start, end].map(number);
        Place { start, end }
    }

    pub(super) const EMPTY: Place = Place { start: 0, end: 0 };

    fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// A name or a quoted text, by its place: [`Text::str`] gives its letters.
pub(super) type Word = Place;

/// Index into [`Text::definitions`].
pub(super) type DefinitionId = u32;
/// Index into [`Text::fragments`].
pub(super) type BodyId = u32;

/// A primitive or a fragment with what is connected to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Definition {
    /// The fragment in which it stands.
    pub(super) scope: BodyId,
    /// The definition in whose arguments it stands, if it has no name of its own.
    pub(super) owner: Option<DefinitionId>,
    /// Its name; none where it stands in another's arguments.
    pub(super) name: Option<Word>,
    pub(super) kind: Kind,
    /// Its range in [`Text::arguments`].
    pub(super) arguments: Place,
    /// From its type or `{` to its last `)`.
    pub(super) place: Place,
}

/// What is defined.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// A primitive of this type.
    Primitive(Word),
    /// A fragment.
    Fragment(BodyId),
}

/// The inside of a fragment, besides its definitions.
#[derive(Debug, Default)]
pub(super) struct Body {
    /// The definition that it belongs to; none for the root.
    pub(super) definition: Option<DefinitionId>,
    /// Its out-ports.
    pub(super) outputs: Vec<Output>,
    /// Second names.
    pub(super) aliases: Vec<(Word, Word)>,
}

/// An out-port of a fragment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Output {
    pub(super) name: Word,
    pub(super) source: Source,
}

/// What stands at an in-port or a parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Argument {
    pub(super) name: Word,
    pub(super) value: Given,
}

/// A link or a parameter's text.
#[derive(Clone, Copy, Debug)]
pub(super) enum Given {
    Link(Source),
    /// The text between the quotes, as it stands.
    Text(Word),
}

/// One end of a link: an out-port.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) of: Subject,
    pub(super) port: Word,
}

/// Whose out-port.
#[derive(Clone, Copy, Debug)]
pub(super) enum Subject {
    Name(Word),
    Definition(DefinitionId),
}

impl<'t> Text<'t> {
    /// The definition of this index.
    pub(super) fn definition(&self, id: DefinitionId) -> &Definition {
        &self.definitions[id as usize]
    }

    /// All definition indices, in the order of their beginnings.
    pub(super) fn definition_ids(&self) -> impl Iterator<Item = DefinitionId> + use<> {
        (0..).take(self.definitions.len())
    }

    /// The fragment of this index.
    pub(super) fn body(&self, id: BodyId) -> &Body {
        &self.fragments[id as usize]
    }

    /// All fragment indices; the first is the root's.
    pub(super) fn body_ids(&self) -> impl Iterator<Item = BodyId> + use<> {
        (0..).take(self.fragments.len())
    }

    /// What stands in a definition's parentheses.
    pub(super) fn arguments(&self, definition: &Definition) -> &[Argument] {
        &self.arguments[definition.arguments.range()]
    }

    /// The text at a place.
    pub(super) fn str(&self, place: Place) -> &'t str {
        &self.text[place.range()]
    }

    /// A place as a span.
    pub(super) fn span(&self, place: Place) -> Span {
        Span::new(self.file, place.start, place.end)
    }

    /// Where a link stands, from its subject to its port.
    pub(super) fn source_place(&self, source: Source) -> Place {
        let start = match source.of {
            Subject::Name(word) => word.start,
            Subject::Definition(id) => self.definition(id).place.start,
        };
        Place {
            start,
            end: source.port.end,
        }
    }

    /// Where the value of an argument stands.
    pub(super) fn argument_place(&self, argument: &Argument) -> Place {
        match argument.value {
            Given::Link(source) => self.source_place(source),
            Given::Text(word) => word,
        }
    }
}
