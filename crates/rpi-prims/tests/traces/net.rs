//! Reader of the recorded nets: fragments and named primitives. Inline primitives do not occur in them.

use std::collections::HashMap;

/// Primitive of a net.
pub(crate) struct Prim {
    /// Name with the names of its fragments, `frag/p1`.
    pub(crate) path: String,
    /// Registered name of the type.
    pub(crate) ty: String,
    /// Connected in-ports, each with the out-port that it reads, `frag/p1.outValue`.
    pub(crate) inputs: Vec<(String, String)>,
    /// Parameters as text.
    pub(crate) params: Vec<(String, String)>,
    /// Out-ports that activate the enclosing fragments.
    pub(crate) gates: Vec<String>,
}

/// Reads all primitives of a net.
pub(crate) fn read(text: &str) -> Vec<Prim> {
    let mut reader = Reader {
        text,
        at: 0,
        prims: Vec::new(),
        aliases: HashMap::new(),
    };
    reader.fragment("");
    let Reader {
        mut prims, aliases, ..
    } = reader;
    for prim in &mut prims {
        let sources = prim.inputs.iter_mut().map(|(_, source)| source);
        for source in sources.chain(prim.gates.iter_mut()) {
            while let Some(behind) = aliases.get(source) {
                source.clone_from(behind);
            }
        }
    }
    prims
}

/// Pairs of a name and its text.
type Pairs = Vec<(String, String)>;

struct Reader<'a> {
    text: &'a str,
    at: usize,
    prims: Vec<Prim>,
    /// Ports of fragments, each with the port that it stands for.
    aliases: HashMap<String, String>,
}

impl Reader<'_> {
    fn peek(&self) -> u8 {
        self.text.as_bytes()[self.at]
    }

    fn take(&mut self, byte: u8) -> bool {
        let there = self.peek() == byte;
        self.at += usize::from(there);
        there
    }

    fn expect(&mut self, byte: u8) {
        assert!(self.take(byte), "{} at {}", char::from(byte), self.at);
    }

    fn until(&mut self, ends: &[u8]) -> String {
        let rest = &self.text[self.at..];
        let len = rest.bytes().position(|b| ends.contains(&b));
        let word = &rest[..len.unwrap_or(rest.len())];
        self.at += word.len();
        word.to_owned()
    }

    /// Reads `{ name=Type(...), name={...}(...), outName=source }` below `path`.
    fn fragment(&mut self, path: &str) {
        self.expect(b'{');
        while !self.take(b'}') {
            let name = self.until(b"=");
            self.expect(b'=');
            if self.peek() == b'{' {
                self.inner(path, &name);
            } else {
                self.prim_or_output(path, name);
            }
            self.take(b',');
        }
    }

    fn inner(&mut self, path: &str, name: &str) {
        let below = format!("{path}{name}/");
        let active = format!("{below}parent.inActive");
        let first = self.prims.len();
        self.fragment(&below);
        let (inputs, _) = self.arguments(path);
        if inputs.iter().any(|(port, _)| port == "inActive") {
            for prim in &mut self.prims[first..] {
                prim.gates.push(active.clone());
            }
        }
        for (port, source) in inputs {
            self.aliases.insert(format!("{below}parent.{port}"), source);
        }
    }

    fn prim_or_output(&mut self, path: &str, name: String) {
        let word = self.until(b"(,}");
        if self.peek() != b'(' {
            let fragment = path.strip_suffix('/').unwrap_or(path);
            let source = format!("{path}{word}");
            self.aliases.insert(format!("{fragment}.{name}"), source);
            return;
        }
        let (inputs, params) = self.arguments(path);
        self.prims.push(Prim {
            path: format!("{path}{name}"),
            ty: word,
            inputs,
            params,
            gates: Vec::new(),
        });
    }

    /// Reads `(inX=source,X='text')`. Sources are relative to `path`.
    fn arguments(&mut self, path: &str) -> (Pairs, Pairs) {
        let (mut inputs, mut params) = (Vec::new(), Vec::new());
        self.expect(b'(');
        while !self.take(b')') {
            let name = self.until(b"=[");
            if self.peek() == b'[' {
                self.until(b"=");
            }
            self.expect(b'=');
            if self.take(b'\'') {
                params.push((name, self.until(b"'")));
                self.expect(b'\'');
            } else {
                let source = self.until(b",)");
                inputs.push((name, format!("{path}{source}")));
            }
            self.take(b',');
        }
        (inputs, params)
    }
}
