//! Parsed text of a net, with unresolved names.
//!
//! Definitions are stored in one list in the order of their first bytes, so that a definition comes before those inside
//! it.

use rpi_diag::{FileId, Span};

/// Text of a net with its definitions, arguments and fragments as parsed, before names and links are resolved.
#[derive(Debug)]
pub(super) struct ParsedText<'t> {
    /// File that contains the text, for locations in diagnostics.
    pub(super) file: FileId,
    /// Source text of the net.
    pub(super) text: &'t str,
    /// Definitions of all primitives and fragments in text order. A [`DefinitionId`] is an index into this list.
    pub(super) definitions: Vec<Definition>,
    /// Arguments of all definitions. Those of one definition are adjacent.
    pub(super) arguments: Vec<Argument>,
    /// Contents of all fragments. The first is the root.
    pub(super) fragments: Vec<Body>,
}

/// Range of byte offsets in the text, or range of indices in a list.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct TextRange {
    pub(super) start: u32,
    pub(super) end: u32,
}

/// Converts an offset or index to `u32`. It always fits, since the parser rejects texts of 4 GiB and more.
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

/// Byte range of a name, or of the content of a quoted text; [`ParsedText::str`] returns the characters.
pub(super) type Word = TextRange;

/// Index of a definition in [`ParsedText::definitions`].
pub(super) type DefinitionId = u32;
/// Index of a fragment in [`ParsedText::fragments`].
pub(super) type BodyId = u32;

/// Definition of a primitive or fragment in the text, with its arguments.
#[derive(Clone, Copy, Debug)]
pub(super) struct Definition {
    /// Fragment that contains the definition, directly or in the arguments of another definition.
    pub(super) scope: BodyId,
    /// Definition in whose arguments this definition is written; `None` if it is an entry of its fragment.
    pub(super) owner: Option<DefinitionId>,
    /// Name of the definition; `None` if it is written in the arguments of another definition, or only in an out-port.
    pub(super) name: Option<Word>,
    pub(super) kind: DefinitionKind,
    /// Range of the definition's arguments in [`ParsedText::arguments`].
    pub(super) arguments: TextRange,
    /// Byte range of the definition from its type or `{` to the last `)`.
    pub(super) place: TextRange,
}

/// Kind of a definition: primitive or fragment.
#[derive(Clone, Copy, Debug)]
pub(super) enum DefinitionKind {
    /// Primitive with its name as written, such as `Core::DoubleAdd`.
    Primitive(Word),
    /// Fragment written in braces, with the index of its content.
    Fragment(BodyId),
}

/// Content of a fragment: out-ports and aliases. The definitions in it refer to it as their scope.
#[derive(Debug, Default)]
pub(super) struct Body {
    /// Definition of the fragment; `None` for the root.
    pub(super) definition: Option<DefinitionId>,
    /// Out-ports of the fragment, in text order.
    pub(super) outputs: Vec<Output>,
    /// Aliases in the fragment, `name = other`: the new and the existing name.
    pub(super) aliases: Vec<(Word, Word)>,
}

/// Out-port of a fragment, `name = source.port`: its name and the source of its flow.
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

/// Value of an argument: a link to an out-port, or a text in quotes.
#[derive(Clone, Copy, Debug)]
pub(super) enum ArgumentValue {
    Link(Source),
    /// Text between the quotes, whose escapes are not resolved.
    Text(Word),
}

/// Source of a link: a definition and the name of one of its out-ports.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) subject: Subject,
    pub(super) port: Word,
}

/// Definition to which the out-port of a link belongs: by its name, or written in place.
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

    /// Returns all definition indices, in text order.
    pub(super) fn definition_ids(&self) -> impl Iterator<Item = DefinitionId> + use<> {
        (0..).take(self.definitions.len())
    }

    /// Returns the content of the fragment with this index.
    pub(super) fn body(&self, id: BodyId) -> &Body {
        &self.fragments[id as usize]
    }

    /// Returns all fragment indices; the first is that of the root.
    pub(super) fn body_ids(&self) -> impl Iterator<Item = BodyId> + use<> {
        (0..).take(self.fragments.len())
    }

    /// Returns the arguments of a definition, in text order.
    pub(super) fn arguments(&self, definition: &Definition) -> &[Argument] {
        &self.arguments[definition.arguments.range()]
    }

    /// Returns the characters in a byte range of the text.
    pub(super) fn str(&self, place: TextRange) -> &'t str {
        &self.text[place.range()]
    }

    /// Converts a byte range of the text to a span.
    pub(super) fn span(&self, place: TextRange) -> Span {
        Span::new(self.file, place.start, place.end)
    }

    /// Returns the byte range of a link, from the start of its definition or name to the end of its port.
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

    /// Returns the byte range of the value of an argument.
    pub(super) fn argument_place(&self, argument: &Argument) -> TextRange {
        match argument.value {
            ArgumentValue::Link(source) => self.source_place(source),
            ArgumentValue::Text(word) => word,
        }
    }
}
