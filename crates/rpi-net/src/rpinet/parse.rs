//! From characters to [`Text`]: a cursor and recursive descent, linear in the length of the text.
//!
//! After a fault the parser goes on behind the next comma of the same list, so that one run reports every independent
//! one. Nesting is limited: no text can exhaust the stack.

use super::text::{
    Argument, Body, BodyId, Definition, DefinitionId, Given, Kind, Output, Place, Source, Subject,
    Text, Word, number,
};
use rpi_diag::{Code, FileId, Finding};

mod cursor;

/// Deepest nesting of fragments and primitives within each other. The reference's nets have at most 5.
pub const MAX_DEPTH: usize = 100;

/// Takes a net's text apart.
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
    // A fault that stops the whole net is among the findings.
    let _ = parser.net();
    (parser.out, parser.findings)
}

/// The fault is among the findings; whoever called goes on where it can.
struct Stop;

type Parsed<T> = Result<T, Stop>;

struct Parser<'t> {
    out: Text<'t>,
    at: usize,
    depth: usize,
    /// Arguments of the definitions that are not closed yet, the innermost last.
    open: Vec<Argument>,
    findings: Vec<Finding>,
}

/// What an entry of a list stands in.
#[derive(Clone, Copy)]
struct List {
    /// Where its bracket stands.
    open: usize,
    close: u8,
    /// What the bracket belongs to: the fragment of the entries.
    scope: BodyId,
    /// The definition whose arguments these are.
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

    /// Entries or arguments, separated by commas, up to and with the closing bracket.
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

    /// Skips to the next comma of this list, or its end.
    fn recover(&mut self, list: List) -> Parsed<()> {
        let mut depth = 0_usize;
        loop {
            self.space();
            match self.peek() {
                None => return Err(Stop),
                Some(b',') if depth == 0 => return Ok(()),
                Some(c) if c == list.close && depth == 0 => return Ok(()),
                // The bracket of the list around: this one was not closed.
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

    /// `name = primitive`, `name = primitive.port`, `name = other`.
    fn entry(&mut self, scope: BodyId) -> Parsed<()> {
        let name = self.word("the name of a primitive or out-port")?;
        self.debug_time()?;
        self.expect(b'=', "`=` stands between a name and what it means")?;
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

    /// In `name = Type(..).port` the name is the port's, and the primitive has none.
    fn rename(&mut self, of: Subject) {
        if let Subject::Definition(id) = of {
            self.definition(id).name = None;
        }
    }

    /// `inPort = primitive.port` or `Parameter = 'text'`.
    fn argument(&mut self, scope: BodyId, owner: DefinitionId) -> Parsed<()> {
        let name = self.word("the name of an in-port or parameter")?;
        self.debug_time()?;
        self.expect(b'=', "`=` stands between a port or parameter and its value")?;
        self.space();
        let value = if self.peek() == Some(b'\'') {
            Given::Text(self.quoted()?)
        } else {
            let of = self.subject(scope, Some(owner), None)?;
            self.expect(b'.', "a link ends at an out-port: `name.outPort`")?;
            let port = self.word("the name of an out-port")?;
            Given::Link(Source { of, port })
        };
        self.open.push(Argument { name, value });
        Ok(())
    }

    /// `name`, `Type(..)` or `{..}(..)`.
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

    /// Enters a definition, as a fragment until it is known to be a primitive.
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
            let message =
                format!("more than {MAX_DEPTH} primitives and fragments within each other");
            let finding = Finding::new(Code::RPI0103, message)
                .at(self.span(start, self.at), "this is too deep")
                .help("give inner primitives a name and link to them by it");
            return Err(self.fault(finding));
        }
        self.depth += 1;
        let result = inner(self);
        self.depth -= 1;
        result
    }

    /// `[seconds]`: the reference records this link for so long. Read over, since everything can be recorded here.
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
            .at(self.span(start, self.at), "not a time")
            .help("delete the brackets: recordings are asked for when a net is run");
        Err(self.fault(finding))
    }
}
