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
    pub(super) definitions: Vec<Definition<'t>>,
    /// All fragments; the first is the root.
    pub(super) fragments: Vec<Body<'t>>,
}

/// A piece of the text, as byte offsets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Place {
    pub(super) start: usize,
    pub(super) end: usize,
}

/// A name and where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word<'t> {
    pub(super) text: &'t str,
    pub(super) at: usize,
}

/// Index into [`Text::definitions`].
pub(super) type DefinitionId = usize;
/// Index into [`Text::fragments`].
pub(super) type BodyId = usize;

/// A primitive or a fragment with what is connected to it.
#[derive(Debug)]
pub(super) struct Definition<'t> {
    /// The fragment in which it stands.
    pub(super) scope: BodyId,
    /// The definition in whose arguments it stands, if it has no name of its own.
    pub(super) owner: Option<DefinitionId>,
    /// Its name; none where it stands in another's arguments.
    pub(super) name: Option<Word<'t>>,
    pub(super) kind: Kind<'t>,
    pub(super) arguments: Vec<Argument<'t>>,
    /// From its type or `{` to its last `)`.
    pub(super) place: Place,
}

/// What is defined.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind<'t> {
    /// A primitive of this type.
    Primitive(Word<'t>),
    /// A fragment.
    Fragment(BodyId),
}

/// The inside of a fragment, besides its definitions.
#[derive(Debug, Default)]
pub(super) struct Body<'t> {
    /// The definition that it belongs to; none for the root.
    pub(super) definition: Option<DefinitionId>,
    /// Its out-ports.
    pub(super) outputs: Vec<Output<'t>>,
    /// Second names.
    pub(super) aliases: Vec<(Word<'t>, Word<'t>)>,
}

/// An out-port of a fragment.
#[derive(Debug)]
pub(super) struct Output<'t> {
    pub(super) name: Word<'t>,
    pub(super) source: Source<'t>,
}

/// What stands at an in-port or a parameter.
#[derive(Debug)]
pub(super) struct Argument<'t> {
    pub(super) name: Word<'t>,
    pub(super) value: Given<'t>,
}

/// A link or a parameter's text.
#[derive(Debug)]
pub(super) enum Given<'t> {
    Link(Source<'t>),
    /// The text between the quotes, as it stands.
    Text(Word<'t>),
}

/// One end of a link: an out-port.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'t> {
    pub(super) of: Subject<'t>,
    pub(super) port: Word<'t>,
}

/// Whose out-port.
#[derive(Clone, Copy, Debug)]
pub(super) enum Subject<'t> {
    Name(Word<'t>),
    Definition(DefinitionId),
}

impl Word<'_> {
    pub(super) fn place(self) -> Place {
        Place {
            start: self.at,
            end: self.at + self.text.len(),
        }
    }
}

impl<'t> Text<'t> {
    /// A place as a span. Texts are shorter than 4 GiB; the parser sees to it.
    pub(super) fn span(&self, place: Place) -> Span {
        let [start, end] = [place.start, place.end].map(|k| u32::try_from(k).unwrap_or(u32::MAX));
        Span::new(self.file, start, end)
    }

    /// Where a link stands, from its subject to its port.
    pub(super) fn source_place(&self, source: Source<'t>) -> Place {
        let start = match source.of {
            Subject::Name(word) => word.at,
            Subject::Definition(id) => self.definitions[id].place.start,
        };
        Place {
            start,
            end: source.port.place().end,
        }
    }

    /// Where the value of an argument stands.
    pub(super) fn argument_place(&self, argument: &Argument<'t>) -> Place {
        match argument.value {
            Given::Link(source) => self.source_place(source),
            Given::Text(word) => word.place(),
        }
    }

    /// The text at a place.
    pub(super) fn slice(&self, place: Place) -> &'t str {
        &self.text[place.start..place.end]
    }
}
