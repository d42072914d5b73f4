//! Parsed text of a net, with unresolved names.
//!
//! Definitions are stored in one list in the order of their first bytes, so that a definition comes before those inside
//! it.

use rpi_diag::{FileId, Span};

/// Text of a net with its parsed definitions, arguments and fragments.
#[derive(Debug)]
pub(super) struct ParsedText<'t> {
    /// File that contains the text.
    pub(super) file: FileId,
    /// Whole text.
    pub(super) text: &'t str,
    /// Definitions of all nodes of the text, in text order. Other items refer to ranges of this list.
    pub(super) definitions: Vec<Definition>,
    /// All arguments. The arguments of one definition are adjacent.
    pub(super) arguments: Vec<Argument>,
    /// All fragments; the first is the root.
    pub(super) fragments: Vec<Body>,
}

/// Range of bytes in the text, or range of indices in a list.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct TextRange {
    pub(super) start: u32,
    pub(super) end: u32,
}

/// Converts an offset or index to `u32`. The parser rejects texts of 4 GiB and more.
pub(super) fn to_u32(k: usize) -> u32 {
    u32::try_from(k).unwrap_or(u32::MAX)
}

impl TextRange {
    pub(super) fn new(start: usize, end: usize) -> Self {
        let [start, end] = [start, end].map(to_u32);
        TextRange { start, end }
    }

    pub(super) const EMPTY: TextRange = TextRange { start: 0, end: 0 };

    fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// Range of a name or of the content of a quoted text; [`Text::str`] returns the characters.
pub(super) type Word = TextRange;

/// Index into [`Text::definitions`].
pub(super) type DefinitionId = u32;
/// Index into [`Text::fragments`].
pub(super) type BodyId = u32;

/// Definition of a primitive or fragment in the text, with its arguments.
#[derive(Clone, Copy, Debug)]
pub(super) struct Definition {
    /// Fragment that contains the definition.
    pub(super) scope: BodyId,
    /// Definition in whose arguments this one is written, if it has no name of its own.
    pub(super) owner: Option<DefinitionId>,
    /// Name of the definition; `None` if it is written in the arguments of another one.
    pub(super) name: Option<Word>,
    pub(super) kind: DefinitionKind,
    /// Range of its arguments in [`Text::arguments`], which holds the arguments of all definitions.
    pub(super) arguments: TextRange,
    /// Location from the type or `{` to the last `)`.
    pub(super) place: TextRange,
}

/// Kind of a definition: primitive or fragment.
#[derive(Clone, Copy, Debug)]
pub(super) enum DefinitionKind {
    /// Primitive with this type name.
    Primitive(Word),
    /// Fragment with this content.
    Fragment(BodyId),
}

/// Content of a fragment besides its definitions.
#[derive(Debug, Default)]
pub(super) struct Body {
    /// Definition of the fragment; `None` for the root.
    pub(super) definition: Option<DefinitionId>,
    /// Out-ports of the fragment.
    pub(super) outputs: Vec<Output>,
    /// Aliases: new name and existing name.
    pub(super) aliases: Vec<(Word, Word)>,
}

/// Out-port of a fragment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Output {
    pub(super) name: Word,
    pub(super) source: Source,
}

/// Argument of a definition: an in-port or parameter with its value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Argument {
    pub(super) name: Word,
    pub(super) value: ArgumentValue,
}

/// What an argument of a node is: a link to an out-port, or a text in quotes.
#[derive(Clone, Copy, Debug)]
pub(super) enum ArgumentValue {
    Link(Source),
    /// Text between the quotes, with its escapes.
    Text(Word),
}

/// Source of a link: an out-port.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) subject: Subject,
    pub(super) port: Word,
}

/// Definition that a link names as the owner of the out-port.
#[derive(Clone, Copy, Debug)]
pub(super) enum Subject {
    Name(Word),
    Definition(DefinitionId),
}

impl<'t> ParsedText<'t> {
    /// Returns the definition with this index.
    pub(super) fn definition(&self, id: DefinitionId) -> &Definition {
        &self.definitions[id as usize]
    }

    /// All definition indices, in the order of the text.
    pub(super) fn definition_ids(&self) -> impl Iterator<Item = DefinitionId> + use<> {
        (0..).take(self.definitions.len())
    }

    /// Returns the fragment with this index.
    pub(super) fn body(&self, id: BodyId) -> &Body {
        &self.fragments[id as usize]
    }

    /// All fragment indices; the first is the root's.
    pub(super) fn body_ids(&self) -> impl Iterator<Item = BodyId> + use<> {
        (0..).take(self.fragments.len())
    }

    /// Returns the slice of [`Text::arguments`] that belongs to a definition.
    pub(super) fn arguments(&self, definition: &Definition) -> &[Argument] {
        &self.arguments[definition.arguments.range()]
    }

    /// Returns the part of the source text in a range of byte offsets.
    pub(super) fn str(&self, place: TextRange) -> &'t str {
        &self.text[place.range()]
    }

    /// Converts a range to a span.
    pub(super) fn span(&self, place: TextRange) -> Span {
        Span::new(self.file, place.start, place.end)
    }

    /// Location of a link, from its subject to its port.
    pub(super) fn source_place(&self, source: Source) -> TextRange {
        let start = match source.subject {
            Subject::Name(word) => word.start,
            Subject::Definition(id) => self.definition(id).place.start,
        };
        TextRange {
            start,
            end: source.port.end,
        }
    }

    /// Location of the value of an argument.
    pub(super) fn argument_place(&self, argument: &Argument) -> TextRange {
        match argument.value {
            ArgumentValue::Link(source) => self.source_place(source),
            ArgumentValue::Text(word) => word,
        }
    }
}
