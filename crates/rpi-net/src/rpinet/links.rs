//! Resolves links: from a name, through the ports of fragments, to the out-port of a primitive.

use super::names::{PARENT, SymbolTable};
use super::parsed_text::{
    ArgumentValue, BodyId, DefinitionId, DefinitionKind, ParsedText, Source, Subject, Word,
};
use crate::net::{NodeId, PortRef};
use rpi_diag::{Code, Diagnostic, suggest};
use rpi_image::PortType;
use rpi_prims::PrimId;
use rustc_hash::FxHashMap;

/// Node and primitive for each definition of the text; `None` for fragments, repeated definitions and undefined
/// primitives.
pub(super) type Nodes = Vec<Option<(NodeId, PrimId)>>;

/// Resolver of the links in the text of a net. It follows each link across the borders of fragments to the primitive
/// from which the flow comes.
pub(super) struct LinkResolver<'a, 't> {
    pub(super) text: &'a ParsedText<'t>,
    pub(super) names: &'a SymbolTable<'t>,
    pub(super) nodes: &'a Nodes,
    /// Primitive of each node of the net, by node index.
    prims: Vec<PrimId>,
    ports: FxHashMap<BorderPort, Resolution>,
    /// Number of searches for similar names, for "did you mean" hints, that may still be made. It is limited, since a
    /// damaged net may have thousands of wrong names.
    hints: u32,
}

/// Port on the border of a fragment in the text.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum BorderPort {
    /// In-port: the definition of the fragment, and the index of the argument that connects the port.
    In(DefinitionId, usize),
    /// Out-port: the fragment, and the index of the port among its out-ports.
    Out(BodyId, usize),
}

/// State of the search for the source of a port on a border.
#[derive(Clone, Copy)]
enum Resolution {
    /// The search is in progress. If it reaches the port again, the port is connected to itself.
    InProgress,
    /// Out-port of a primitive from which the port gets its flow; `None` after an error that has been reported.
    Resolved(Option<PortRef>),
}

/// Result of following a link by one step: an out-port of a primitive, or another port on a border.
enum Step {
    Node(PortRef),
    Border(BorderPort),
}

/// Reason for which a link of the text cannot be resolved.
enum LinkError {
    /// The link names a definition with an error that is reported at the definition.
    AlreadyReported,
    /// The link names no definition of its fragment.
    UndefinedName,
    /// The link names a port that its definition does not have.
    UndefinedPort,
    /// The link begins with `parent` in the root fragment, which has no parent.
    NoParent,
}

impl<'a, 't> LinkResolver<'a, 't> {
    pub(super) fn new(
        text: &'a ParsedText<'t>,
        names: &'a SymbolTable<'t>,
        nodes: &'a Nodes,
    ) -> Self {
        LinkResolver {
            text,
            names,
            nodes,
            prims: nodes.iter().flatten().map(|(_, prim)| *prim).collect(),
            ports: FxHashMap::default(),
            hints: 32,
        }
    }

    /// Returns the out-port of a primitive from which the flow of a link comes; `None` after an error. `scope` is the
    /// fragment that contains the link.
    ///
    /// Reports errors of the first step only. An error of a later step is reported for the link in which it is.
    pub(super) fn resolve(
        &mut self,
        scope: BodyId,
        source: Source,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<PortRef> {
        match self.step(scope, source) {
            Ok(Step::Node(port)) => Some(port),
            Ok(Step::Border(port)) => self.follow(port, diagnostics),
            Err(broken) => {
                diagnostics.extend(self.report(broken, scope, source));
                None
            }
        }
    }

    /// Returns the type and name of an out-port of a node; `None` if it does not exist.
    pub(super) fn port_type(&self, port: PortRef) -> Option<(PortType, &'static str)> {
        let prim = self.prims.get(port.node.index())?;
        let output = prim.desc().outputs.get(usize::from(port.port))?;
        Some((output.ty, output.name))
    }

    /// Returns the out-port of the primitive from which a port on a border gets its flow, following further ports on
    /// borders; `None` after an error.
    fn follow(&mut self, first: BorderPort, diagnostics: &mut Vec<Diagnostic>) -> Option<PortRef> {
        let mut passed = Vec::new();
        let mut at = first;
        let found = loop {
            match self.ports.get(&at) {
                Some(Resolution::Resolved(known)) => break *known,
                Some(Resolution::InProgress) => {
                    diagnostics.push(self.dependency_cycle(at, &passed));
                    break None;
                }
                None => {}
            }
            self.ports.insert(at, Resolution::InProgress);
            passed.push(at);
            match self
                .link_of(at)
                .map(|(scope, source)| self.step(scope, source))
            {
                Some(Ok(Step::Node(port))) => break Some(port),
                Some(Ok(Step::Border(port))) => at = port,
                Some(Err(_)) | None => break None,
            }
        };
        for port in passed {
            self.ports.insert(port, Resolution::Resolved(found));
        }
        found
    }

    /// Returns the link that is connected to a port on a border, and the fragment that contains the link; `None` if a
    /// quoted value is connected.
    fn link_of(&self, port: BorderPort) -> Option<(BodyId, Source)> {
        match port {
            BorderPort::In(id, k) => {
                let definition = self.text.definition(id);
                match self.text.arguments(definition)[k].value {
                    ArgumentValue::Link(source) => Some((definition.scope, source)),
                    ArgumentValue::Text(_) => None,
                }
            }
            BorderPort::Out(body, k) => Some((body, self.text.body(body).outputs[k].source)),
        }
    }

    fn step(&self, scope: BodyId, source: Source) -> Result<Step, LinkError> {
        let id = match source.subject {
            Subject::Name(word) if self.str(word) == PARENT => return self.in_port(scope, source),
            Subject::Name(word) => self
                .names
                .definition(scope, self.str(word))
                .ok_or(LinkError::UndefinedName)?,
            Subject::Definition(id) => id,
        };
        match self.text.definition(id).kind {
            DefinitionKind::Fragment(body) => {
                let k = self
                    .names
                    .output(body, self.str(source.port))
                    .ok_or(LinkError::UndefinedPort)?;
                Ok(Step::Border(BorderPort::Out(body, k)))
            }
            DefinitionKind::Primitive(_) => {
                let (node, prim) = self.nodes[id as usize].ok_or(LinkError::AlreadyReported)?;
                let port = prim
                    .desc()
                    .output(self.str(source.port))
                    .ok_or(LinkError::UndefinedPort)?;
                let port = u8::try_from(port).map_err(|_| LinkError::AlreadyReported)?;
                Ok(Step::Node(PortRef { node, port }))
            }
        }
    }

    /// Follows a link of the form `parent.port` to the in-port of the fragment `scope`, which contains the link.
    fn in_port(&self, scope: BodyId, source: Source) -> Result<Step, LinkError> {
        let id = self
            .text
            .body(scope)
            .definition
            .ok_or(LinkError::NoParent)?;
        let k = self
            .names
            .input(id, self.str(source.port))
            .ok_or(LinkError::UndefinedPort)?;
        Ok(Step::Border(BorderPort::In(id, k)))
    }

    /// Returns the diagnostic for a link to a port with a fixed meaning, such as `inActive`, whose source has another
    /// type than `needed`; `None` if the types agree. `name` is the place of the port's name.
    pub(super) fn wrong_type_at(
        &self,
        port: PortRef,
        needed: PortType,
        name: Word,
    ) -> Option<Diagnostic> {
        let (ty, from) = self.port_type(port).filter(|(ty, _)| *ty != needed)?;
        let [given, needed] = [ty, needed].map(type_name);
        let to = self.str(name);
        let message = format!("type mismatch: `{from}` is {given}, `{to}` expects {needed}");
        let place = self.text.span(name);
        let diagnostic =
            Diagnostic::new(Code::RPI2101, message).primary(place, format!("expects {needed}"));
        Some(diagnostic.help(format!("connect an out-port that is {needed}")))
    }

    fn report(&mut self, broken: LinkError, scope: BodyId, source: Source) -> Option<Diagnostic> {
        match broken {
            LinkError::AlreadyReported => None,
            LinkError::UndefinedName => Some(self.undefined_name(scope, source)),
            LinkError::UndefinedPort => Some(self.undefined_port(scope, source)),
            LinkError::NoParent => {
                let place = self.text.span(self.text.source_place(source));
                let diagnostic =
                    Diagnostic::new(Code::RPI1105, "the root fragment has no in-ports");
                let diagnostic = diagnostic.primary(
                    place,
                    "`parent` is the enclosing fragment; the root has none",
                );
                Some(diagnostic.help("link to a primitive or fragment of the net by its name"))
            }
        }
    }

    fn undefined_name(&mut self, scope: BodyId, source: Source) -> Diagnostic {
        let Subject::Name(word) = source.subject else {
            return self.undefined_port(scope, source);
        };
        let message = format!("undefined name `{}`", self.str(word));
        let place = self.text.span(word);
        let diagnostic =
            Diagnostic::new(Code::RPI1104, message).primary(place, "not defined in this fragment");
        let text = self.text;
        let here = text.definitions.iter().filter(|d| d.scope == scope);
        let here = here.filter_map(|d| d.name).map(|n| text.str(n));
        if let Some(near) = self.hint(text.str(word), here) {
            return diagnostic.did_you_mean(place, Some(near));
        }
        let elsewhere = self.text.definitions.iter();
        let mut elsewhere =
            elsewhere.filter(|d| d.name.is_some_and(|n| text.str(n) == text.str(word)));
        match elsewhere.next().filter(|_| self.hints > 0) {
            Some(other) => diagnostic
                .secondary(self.text.span(other.place), "defined in another fragment")
                .help("route it through an out-port of its fragment, or an in-port of this one"),
            None => diagnostic.help("define it, or link to an existing primitive or fragment"),
        }
    }

    fn undefined_port(&mut self, scope: BodyId, source: Source) -> Diagnostic {
        let port = self.str(source.port);
        let (what, ports) = self.ports_of(scope, source);
        let message = format!("{what} has no port `{port}`");
        let place = self.text.span(source.port);
        let diagnostic = Diagnostic::new(Code::RPI1105, message).primary(place, "undefined port");
        match self.hint(port, ports.iter().copied()) {
            Some(near) => diagnostic.did_you_mean(place, Some(near)),
            None if ports.is_empty() => diagnostic.help("it has no ports"),
            None => diagnostic.help(format!("available ports: {}", list(&ports))),
        }
    }

    /// Returns a description of the definition that a link names, and the names of its ports from which a link may
    /// come.
    fn ports_of(&self, scope: BodyId, source: Source) -> (String, Vec<&'t str>) {
        let id = match source.subject {
            Subject::Name(word) if self.str(word) == PARENT => {
                return ("the enclosing fragment".into(), self.in_ports(scope));
            }
            Subject::Name(word) => self.names.definition(scope, self.str(word)),
            Subject::Definition(id) => Some(id),
        };
        match id.map(|id| (id, self.text.definition(id).kind)) {
            Some((_, DefinitionKind::Fragment(body))) => {
                let outputs = self.text.body(body).outputs.iter();
                (
                    "this fragment".into(),
                    outputs.map(|o| self.str(o.name)).collect(),
                )
            }
            Some((id, DefinitionKind::Primitive(ty))) => {
                let outputs =
                    self.nodes[id as usize].map_or(&[][..], |(_, prim)| prim.desc().outputs);
                let ports = outputs.iter().map(|o| o.name).collect();
                (format!("`{}`", self.str(ty)), ports)
            }
            None => ("this".into(), Vec::new()),
        }
    }

    /// Returns the names of the in-ports of a fragment; empty for the root.
    fn in_ports(&self, body: BodyId) -> Vec<&'t str> {
        let fragment = self.text.body(body).definition;
        let arguments = fragment.map(|d| self.text.arguments(self.text.definition(d)));
        let arguments = arguments.unwrap_or_default().iter();
        arguments.map(|a| self.str(a.name)).collect()
    }

    /// Diagnostic for a port that is connected to itself. `passed` are the ports on the way, and perhaps others before.
    fn dependency_cycle(&self, port: BorderPort, passed: &[BorderPort]) -> Diagnostic {
        let name_of = |port: BorderPort| match port {
            BorderPort::In(id, k) => self.text.arguments(self.text.definition(id))[k].name,
            BorderPort::Out(body, k) => self.text.body(body).outputs[k].name,
        };
        let name = name_of(port);
        let message = format!("`{}` is connected to itself", self.str(name));
        let diagnostic = Diagnostic::new(Code::RPI4002, message)
            .primary(self.text.span(name), "following this port leads back to it");
        let others = passed.iter().skip_while(|one| **one != port).skip(1);
        let diagnostic = others
            .take(MAX_SHOWN_PORTS)
            .fold(diagnostic, |diagnostic, one| {
                let name = name_of(*one);
                let text = format!("through `{}`", self.str(name));
                diagnostic.secondary(self.text.span(name), text)
            });
        diagnostic.help("connect one of these ports to the out-port of a primitive")
    }

    fn str(&self, word: Word) -> &'t str {
        self.text.str(word)
    }

    fn hint<'n>(&mut self, name: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
        self.hints = self.hints.checked_sub(1)?;
        suggest(name, names)
    }
}

/// Maximal number of ports of a dependency cycle that a diagnostic shows.
const MAX_SHOWN_PORTS: usize = 4;

/// Returns the type of a port in words for a message, such as "an array of int".
pub(super) fn type_name(ty: PortType) -> String {
    match ty {
        PortType::Scalar(s) => s.to_string(),
        PortType::Array(s) => format!("an array of {s}"),
        PortType::Matrix => "a matrix".into(),
    }
}

/// Returns names in backticks, separated by commas, for a message. At most eight names are shown.
pub(super) fn list(names: &[&str]) -> String {
    const SHOWN: usize = 8;
    let mut shown: Vec<String> = names.iter().take(SHOWN).map(|n| format!("`{n}`")).collect();
    if names.len() > SHOWN {
        shown.push(format!("{} more", names.len() - SHOWN));
    }
    shown.join(", ")
}
