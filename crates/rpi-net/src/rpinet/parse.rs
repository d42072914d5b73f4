//! Recursive descent parser from characters to [`Text`], linear in the length of the text.
//!
//! After an error the parser resumes behind the next comma of the same list, so that one run reports every independent
//! error. The nesting depth is limited so that no text can overflow the stack.

use super::parsed_text::{
    Argument, ArgumentValue, Body, BodyId, Definition, DefinitionId, DefinitionKind, Output,
    ParsedText, Source, Subject, TextRange, Word, to_u32,
};
use rpi_diag::{Code, Diagnostic, FileId};

mod cursor;

/// Maximum nesting depth of fragments and primitives in a text. Nets of the reference system have at most 5 levels.
pub const MAX_DEPTH: usize = 100;

/// Parses the text of a net without resolving its names and links. Returns the definitions found, and the diagnostics.
pub(super) fn parse(file: FileId, text: &str) -> (ParsedText<'_>, Vec<Diagnostic>) {
    let mut parser = Parser {
        out: ParsedText {
            file,
            text,
            definitions: Vec::new(),
            arguments: Vec::new(),
            fragments: vec![Body::default()],
        },
        offset: 0,
        depth: 0,
        open: Vec::new(),
        diagnostics: Vec::new(),
    };
    // An error that aborts the whole net is already among the diagnostics.
    let _ = parser.net();
    (parser.out, parser.diagnostics)
}

/// Error: a syntax error that has been reported. The caller continues after it where it can.
struct SyntaxError;

type ParseResult<T> = Result<T, SyntaxError>;

struct Parser<'t> {
    out: ParsedText<'t>,
    offset: usize,
    depth: usize,
    /// Arguments of the definitions that are not complete yet, innermost last.
    open: Vec<Argument>,
    diagnostics: Vec<Diagnostic>,
}

/// List that is being parsed: the entries of a fragment, or the arguments of a definition.
#[derive(Clone, Copy)]
struct List {
    /// Byte offset of the list's opening bracket.
    open_offset: usize,
    close: u8,
    /// Fragment that contains the elements of the list.
    scope: BodyId,
    /// Definition whose arguments the list contains; `None` for the entries of a fragment.
    owner: Option<DefinitionId>,
}

impl<'t> Parser<'t> {
    fn net(&mut self) -> ParseResult<()> {
        if u32::try_from(self.out.text.len()).is_err() {
            let message = "this net is longer than 4 GiB";
            return Err(self.error(Diagnostic::new(Code::RPI0101, message)));
        }
        self.space();
        let open = self.offset;
        self.expect(b'{', "a net begins with `{`")?;
        self.list(List {
            open_offset: open,
            close: b'}',
            scope: 0,
            owner: None,
        })?;
        self.space();
        match self.peek() {
            None => Ok(()),
            Some(_) => Err(self.unexpected("the end of the text")),
        }
    }

    /// Parses the entries of a fragment or the arguments of a definition, separated by commas, up to and including the
    /// closing bracket.
    fn list(&mut self, list: List) -> ParseResult<()> {
        loop {
            self.space();
            if self.eat(list.close) {
                return Ok(());
            }
            if self.peek().is_none() {
                return Err(self.unclosed(list));
            }
            let item = match list.owner {
                None => self.entry(list.scope),
                Some(owner) => self.argument(list.scope, owner),
            };
            if item.is_ok() {
                self.space();
                if !matches!(self.peek(), Some(c) if c == b',' || c == list.close) {
                    self.not_separated(list)?;
                    self.recover(list)?;
                }
            } else {
                self.recover(list)?;
            }
            self.eat(b',');
        }
    }

    fn not_separated(&mut self, list: List) -> ParseResult<()> {
        if self.peek().is_none() {
            return Err(self.unclosed(list));
        }
        let close = char::from(list.close);
        self.unexpected(&format!("`,` or `{close}`"));
        Ok(())
    }

    /// Continues after an error: skips to the next comma of the list, or to its closing bracket.
    fn recover(&mut self, list: List) -> ParseResult<()> {
        let mut depth = 0_usize;
        loop {
            self.space();
            match self.peek() {
                None => return Err(SyntaxError),
                Some(b',') if depth == 0 => return Ok(()),
                Some(c) if c == list.close && depth == 0 => return Ok(()),
                // Closing bracket of the enclosing list: this list was not closed.
                Some(b'}') if depth == 0 => return Err(SyntaxError),
                Some(b'\'') => drop(self.quoted()),
                Some(c) => {
                    depth = match c {
                        b'(' | b'{' => depth + 1,
                        b')' | b'}' => depth.saturating_sub(1),
                        _ => depth,
                    };
                    self.bump();
                }
            }
        }
    }

    /// Parses an entry of a fragment: `name = primitive`, `name = primitive.port` or `name = other`.
    fn entry(&mut self, scope: BodyId) -> ParseResult<()> {
        let name = self.word("the name of a primitive or out-port")?;
        self.recording_time()?;
        self.expect(b'=', "write `=` between a name and its definition")?;
        let of = self.subject(scope, None, Some(name))?;
        self.space();
        if self.eat(b'.') {
            let port = self.word("the name of an out-port")?;
            self.clear_name(of);
            let source = Source { subject: of, port };
            self.body(scope).outputs.push(Output { name, source });
        } else if let Subject::Name(other) = of {
            self.body(scope).aliases.push((name, other));
        }
        Ok(())
    }

    /// Removes the name of a definition: in `name = Type(..).port` the name is that of an out-port.
    fn clear_name(&mut self, of: Subject) {
        if let Subject::Definition(id) = of {
            self.definition(id).name = None;
        }
    }

    /// Parses an argument of a definition: `inPort = primitive.port` or `Parameter = 'text'`. `owner` is the
    /// definition.
    fn argument(&mut self, scope: BodyId, owner: DefinitionId) -> ParseResult<()> {
        let name = self.word("the name of an in-port or parameter")?;
        self.recording_time()?;
        self.expect(b'=', "write `=` between a port or parameter and its value")?;
        self.space();
        let value = if self.peek() == Some(b'\'') {
            ArgumentValue::Text(self.quoted()?)
        } else {
            let of = self.subject(scope, Some(owner), None)?;
            self.expect(b'.', "a link needs an out-port: `name.outPort`")?;
            let port = self.word("the name of an out-port")?;
            ArgumentValue::Link(Source { subject: of, port })
        };
        self.open.push(Argument { name, value });
        Ok(())
    }

    /// Parses a name, a primitive `Type(..)` or a fragment `{..}(..)`. `owner` is the definition in whose arguments it
    /// is written; `name` is its name in an entry.
    fn subject(
        &mut self,
        scope: BodyId,
        owner: Option<DefinitionId>,
        name: Option<Word>,
    ) -> ParseResult<Subject> {
        self.space();
        let start = self.offset;
        if self.peek() == Some(b'{') {
            let id = self.define(scope, owner, name, start);
            return self
                .nested(start, |p| p.fragment(id))
                .map(|()| Subject::Definition(id));
        }
        let word = self.word("a name, a type or `{`")?;
        self.space();
        if self.peek() != Some(b'(') {
            return Ok(Subject::Name(word));
        }
        let id = self.define(scope, owner, name, start);
        self.definition(id).kind = DefinitionKind::Primitive(word);
        self.nested(start, |p| p.arguments(id))?;
        Ok(Subject::Definition(id))
    }

    /// Adds a definition that begins at byte offset `start`. Its kind is a fragment until the caller has parsed a
    /// primitive.
    fn define(
        &mut self,
        scope: BodyId,
        owner: Option<DefinitionId>,
        name: Option<Word>,
        start: usize,
    ) -> DefinitionId {
        let id = to_u32(self.out.definitions.len());
        self.out.definitions.push(Definition {
            scope,
            owner,
            name,
            kind: DefinitionKind::Fragment(0),
            arguments: TextRange::EMPTY,
            place: TextRange::new(start, start),
        });
        id
    }

    fn fragment(&mut self, id: DefinitionId) -> ParseResult<()> {
        let scope = to_u32(self.out.fragments.len());
        self.out.fragments.push(Body {
            definition: Some(id),
            ..Body::default()
        });
        self.definition(id).kind = DefinitionKind::Fragment(scope);
        let open = self.offset;
        self.bump();
        self.list(List {
            open_offset: open,
            close: b'}',
            scope,
            owner: None,
        })?;
        self.space();
        match self.peek() {
            Some(b'(') => self.arguments(id),
            _ => Err(self.unexpected("`(` with the in-ports of this fragment")),
        }
    }

    fn arguments(&mut self, id: DefinitionId) -> ParseResult<()> {
        let (scope, open) = (self.definition(id).scope, self.offset);
        let first = self.open.len();
        self.bump();
        let parsed = self.list(List {
            open_offset: open,
            close: b')',
            scope,
            owner: Some(id),
        });
        let start = self.out.arguments.len();
        self.out.arguments.extend(self.open.drain(first..));
        let (arguments, end) = (
            TextRange::new(start, self.out.arguments.len()),
            to_u32(self.offset),
        );
        let definition = self.definition(id);
        definition.arguments = arguments;
        definition.place.end = end;
        parsed
    }

    fn definition(&mut self, id: DefinitionId) -> &mut Definition {
        &mut self.out.definitions[id as usize]
    }

    fn body(&mut self, id: BodyId) -> &mut Body {
        &mut self.out.fragments[id as usize]
    }

    fn nested(
        &mut self,
        start: usize,
        inner: impl FnOnce(&mut Self) -> ParseResult<()>,
    ) -> ParseResult<()> {
        if self.depth == MAX_DEPTH {
            let message = format!("primitives and fragments are nested more than {MAX_DEPTH} deep");
            let diagnostic = Diagnostic::new(Code::RPI0103, message)
                .primary(self.span(start, self.offset), "nested too deeply")
                .help("name the inner primitives and link to them by name");
            return Err(self.error(diagnostic));
        }
        self.depth += 1;
        let result = inner(self);
        self.depth -= 1;
        result
    }

    /// Skips `[seconds]` after a name, if present. For this time the reference system records the link; here it has no
    /// effect, since every flow can be recorded.
    fn recording_time(&mut self) -> ParseResult<()> {
        self.space();
        let start = self.offset;
        if !self.eat(b'[') {
            return Ok(());
        }
        let text = &self.out.text[self.offset..];
        let inside = text
            .find([']', ',', '=', '(', ')', '{', '}'])
            .unwrap_or(text.len());
        self.offset += inside;
        let seconds = text[..inside].trim().parse::<f64>();
        if seconds.is_ok_and(|s| s >= 0.0) && self.eat(b']') {
            return Ok(());
        }
        let diagnostic = Diagnostic::new(Code::RPI0101, "expected a recording time `[seconds]`")
            .primary(self.span(start, self.offset), "not a recording time")
            .help("delete the brackets: recorded flows are selected when a net is run");
        Err(self.error(diagnostic))
    }
}
