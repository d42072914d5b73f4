//! Recursive descent parser from characters to [`Text`], linear in the length of the text.
//!
//! After an error the parser resumes behind the next comma of the same list, so that one run reports every independent
//! error. The nesting depth is limited so that no text can overflow the stack.

use super::text::{
    Argument, Body, BodyId, Definition, DefinitionId, Given, Kind, Output, Place, Source, Subject,
    Text, Word, number,
};
use rpi_diag::{Code, FileId, Finding};

mod cursor;

/// Maximal nesting depth of fragments and primitives. Nets of the reference system have at most 5 levels.
pub const MAX_DEPTH: usize = 100;

/// Parses the text of a net.
pub(super) fn parse(file: FileId, text: &str) -> (Text<'_>, Vec<Finding>) {
    let mut parser = Parser {
        out: Text {
            file,
            text,
            definitions: Vec::new(),
            arguments: Vec::new(),
            fragments: vec![Body::default()],
        },
        at: 0,
        depth: 0,
        open: Vec::new(),
        findings: Vec::new(),
    };
    // An error that aborts the whole net is already among the diagnostics.
    let _ = parser.net();
    (parser.out, parser.findings)
}

/// Marker for a syntax error that was already reported. The caller recovers where it can.
struct Stop;

type Parsed<T> = Result<T, Stop>;

struct Parser<'t> {
    out: Text<'t>,
    at: usize,
    depth: usize,
    /// Arguments of the definitions that are not closed yet, innermost last.
    open: Vec<Argument>,
    findings: Vec<Finding>,
}

/// List that is being parsed: entries of a fragment, or arguments of a definition.
#[derive(Clone, Copy)]
struct List {
    /// Byte offset of the opening bracket.
    open: usize,
    close: u8,
    /// Fragment that contains the items of the list.
    scope: BodyId,
    /// Definition whose arguments the list contains; `None` for the entries of a fragment.
    owner: Option<DefinitionId>,
}

impl<'t> Parser<'t> {
    fn net(&mut self) -> Parsed<()> {
        if u32::try_from(self.out.text.len()).is_err() {
            let message = "this net is longer than 4 GiB";
            return Err(self.fault(Finding::new(Code::RPI0101, message)));
        }
        self.space();
        let open = self.at;
        self.expect(b'{', "a net begins with `{`")?;
        self.list(List {
            open,
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

    /// Parses entries or arguments, separated by commas, including the closing bracket.
    fn list(&mut self, list: List) -> Parsed<()> {
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

    fn not_separated(&mut self, list: List) -> Parsed<()> {
        if self.peek().is_none() {
            return Err(self.unclosed(list));
        }
        let close = char::from(list.close);
        self.unexpected(&format!("`,` or `{close}`"));
        Ok(())
    }

    /// Skips to the next comma of this list, or to its end.
    fn recover(&mut self, list: List) -> Parsed<()> {
        let mut depth = 0_usize;
        loop {
            self.space();
            match self.peek() {
                None => return Err(Stop),
                Some(b',') if depth == 0 => return Ok(()),
                Some(c) if c == list.close && depth == 0 => return Ok(()),
                // Closing bracket of the enclosing list: this list was not closed.
                Some(b'}') if depth == 0 => return Err(Stop),
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

    /// Parses `name = primitive`, `name = primitive.port` or `name = other`.
    fn entry(&mut self, scope: BodyId) -> Parsed<()> {
        let name = self.word("the name of a primitive or out-port")?;
        self.debug_time()?;
        self.expect(b'=', "write `=` between a name and its definition")?;
        let of = self.subject(scope, None, Some(name))?;
        self.space();
        if self.eat(b'.') {
            let port = self.word("the name of an out-port")?;
            self.rename(of);
            let source = Source { of, port };
            self.body(scope).outputs.push(Output { name, source });
        } else if let Subject::Name(other) = of {
            self.body(scope).aliases.push((name, other));
        }
        Ok(())
    }

    /// Removes the name of a definition: in `name = Type(..).port` the name belongs to the out-port.
    fn rename(&mut self, of: Subject) {
        if let Subject::Definition(id) = of {
            self.definition(id).name = None;
        }
    }

    /// Parses `inPort = primitive.port` or `Parameter = 'text'`.
    fn argument(&mut self, scope: BodyId, owner: DefinitionId) -> Parsed<()> {
        let name = self.word("the name of an in-port or parameter")?;
        self.debug_time()?;
        self.expect(b'=', "write `=` between a port or parameter and its value")?;
        self.space();
        let value = if self.peek() == Some(b'\'') {
            Given::Text(self.quoted()?)
        } else {
            let of = self.subject(scope, Some(owner), None)?;
            self.expect(b'.', "a link needs an out-port: `name.outPort`")?;
            let port = self.word("the name of an out-port")?;
            Given::Link(Source { of, port })
        };
        self.open.push(Argument { name, value });
        Ok(())
    }

    /// Parses `name`, `Type(..)` or `{..}(..)`.
    fn subject(
        &mut self,
        scope: BodyId,
        owner: Option<DefinitionId>,
        name: Option<Word>,
    ) -> Parsed<Subject> {
        self.space();
        let start = self.at;
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
        self.definition(id).kind = Kind::Primitive(word);
        self.nested(start, |p| p.arguments(id))?;
        Ok(Subject::Definition(id))
    }

    /// Adds a definition. Its kind is a fragment until the caller has parsed a primitive.
    fn define(
        &mut self,
        scope: BodyId,
        owner: Option<DefinitionId>,
        name: Option<Word>,
        start: usize,
    ) -> DefinitionId {
        let id = number(self.out.definitions.len());
        self.out.definitions.push(Definition {
            scope,
            owner,
            name,
            kind: Kind::Fragment(0),
            arguments: Place::EMPTY,
            place: Place::new(start, start),
        });
        id
    }

    fn fragment(&mut self, id: DefinitionId) -> Parsed<()> {
        let scope = number(self.out.fragments.len());
        self.out.fragments.push(Body {
            definition: Some(id),
            ..Body::default()
        });
        self.definition(id).kind = Kind::Fragment(scope);
        let open = self.at;
        self.bump();
        self.list(List {
            open,
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

    fn arguments(&mut self, id: DefinitionId) -> Parsed<()> {
        let (scope, open) = (self.definition(id).scope, self.at);
        let first = self.open.len();
        self.bump();
        let parsed = self.list(List {
            open,
            close: b')',
            scope,
            owner: Some(id),
        });
        let start = self.out.arguments.len();
        self.out.arguments.extend(self.open.drain(first..));
        let (arguments, end) = (Place::new(start, self.out.arguments.len()), number(self.at));
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

    fn nested(&mut self, start: usize, inner: impl FnOnce(&mut Self) -> Parsed<()>) -> Parsed<()> {
        if self.depth == MAX_DEPTH {
            let message = format!("primitives and fragments are nested more than {MAX_DEPTH} deep");
            let finding = Finding::new(Code::RPI0103, message)
                .at(self.span(start, self.at), "nested too deeply")
                .help("name the inner primitives and link to them by name");
            return Err(self.fault(finding));
        }
        self.depth += 1;
        let result = inner(self);
        self.depth -= 1;
        result
    }

    /// Skips `[seconds]`, for which the reference system records the link. It has no effect here, since every flow can
    /// be recorded.
    fn debug_time(&mut self) -> Parsed<()> {
        self.space();
        let start = self.at;
        if !self.eat(b'[') {
            return Ok(());
        }
        let text = &self.out.text[self.at..];
        let inside = text
            .find([']', ',', '=', '(', ')', '{', '}'])
            .unwrap_or(text.len());
        self.at += inside;
        let seconds = text[..inside].trim().parse::<f64>();
        if seconds.is_ok_and(|s| s >= 0.0) && self.eat(b']') {
            return Ok(());
        }
        let finding = Finding::new(Code::RPI0101, "expected a recording time `[seconds]`")
            .at(self.span(start, self.at), "not a recording time")
            .help("delete the brackets: recorded flows are selected when a net is run");
        Err(self.fault(finding))
    }
}
