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

/// Node and primitive for each definition of the text; `None` for fragments and undefined primitives.
pub(super) type Nodes = Vec<Option<(NodeId, PrimId)>>;

/// Resolver of the links in the text of a net: it follows them across fragment borders to a primitive.
pub(super) struct LinkResolver<'a, 't> {
    pub(super) text: &'a ParsedText<'t>,
    pub(super) names: &'a SymbolTable<'t>,
    pub(super) nodes: &'a Nodes,
    /// Primitive of each node, by node index.
    prims: Vec<PrimId>,
    ports: FxHashMap<BorderPort, Resolution>,
    /// Remaining name searches for "did you mean" hints. The number is limited, since a broken net may have thousands
    /// of wrong names.
    hints: u32,
}

/// Port on the border of a fragment.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum BorderPort {
    /// In-port: index of the fragment's definition, and of its argument.
    In(DefinitionId, usize),
    /// Out-port: index of the fragment, and of the port in it.
    Out(BodyId, usize),
}

/// State of the resolution of a border port.
#[derive(Clone, Copy)]
enum Resolution {
    /// Resolution is in progress; reaching the port again is a dependency cycle.
    InProgress,
    /// Out-port that the border port is an alias of; `None` after an error that was already reported.
    Resolved(Option<PortRef>),
}

/// Result of following a link by one step: a primitive, or a further port on a border.
enum Step {
    Node(PortRef),
    Border(BorderPort),
}

/// Reason why a link cannot be resolved.
enum LinkError {
    /// The name belongs to a definition with an error that is reported there.
    AlreadyReported,
    /// The link names a definition that does not exist.
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

    /// Returns the out-port of a primitive from which a link originates. Reports errors of the first step only; an
    /// error of a later step is reported for the link that contains it.
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

    /// Type and name of an out-port of a node.
    pub(super) fn port_type(&self, port: PortRef) -> Option<(PortType, &'static str)> {
        let prim = self.prims.get(port.node.index())?;
        let output = prim.desc().outputs.get(usize::from(port.port))?;
        Some((output.ty, output.name))
    }

    /// Follows ports on borders until a primitive is reached.
    fn follow(&mut self, first: BorderPort, diagnostics: &mut Vec<Diagnostic>) -> Option<PortRef> {
        let mut passed = Vec::new();
        let mut at = first;
        let found = loop {
            match self.ports.get(&at) {
                Some(Resolution::Resolved(known)) => break *known,
                Some(Resolution::InProgress) => {
                    diagnostics.push(self.dependency_cycle(at));
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

    /// Link that is connected to a border port, and the fragment that contains the link.
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

    /// Resolves a link to an in-port of the fragment that contains the link (`parent.port`).
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

    /// Returns the type mismatch of a link to a port with a fixed meaning; `None` if the types agree.
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

    /// Description of the definition that a link names, and the names of its ports from which a link may originate.
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

    /// Names of the in-ports of a body's fragment; empty for the root.
    fn in_ports(&self, body: BodyId) -> Vec<&'t str> {
        let fragment = self.text.body(body).definition;
        let arguments = fragment.map(|d| self.text.arguments(self.text.definition(d)));
        let arguments = arguments.unwrap_or_default().iter();
        arguments.map(|a| self.str(a.name)).collect()
    }

    fn dependency_cycle(&self, port: BorderPort) -> Diagnostic {
        let name = match port {
            BorderPort::In(id, k) => self.text.arguments(self.text.definition(id))[k].name,
            BorderPort::Out(body, k) => self.text.body(body).outputs[k].name,
        };
        let message = format!("`{}` is connected to itself", self.str(name));
        Diagnostic::new(Code::RPI4002, message)
            .primary(self.text.span(name), "following this port leads back to it")
            .help("connect one of the ports on the way to a primitive")
    }

    fn str(&self, word: Word) -> &'t str {
        self.text.str(word)
    }

    fn hint<'n>(&mut self, name: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
        self.hints = self.hints.checked_sub(1)?;
        suggest(name, names)
    }
}

/// Describes a port's type with an article where needed.
pub(super) fn type_name(ty: PortType) -> String {
    match ty {
        PortType::Scalar(s) => s.to_string(),
        PortType::Array(s) => format!("an array of {s}"),
        PortType::Matrix => "a matrix".into(),
    }
}

/// Joins names for a message. At most eight names are shown.
pub(super) fn list(names: &[&str]) -> String {
    const SHOWN: usize = 8;
    let mut shown: Vec<String> = names.iter().take(SHOWN).map(|n| format!("`{n}`")).collect();
    if names.len() > SHOWN {
        shown.push(format!("{} more", names.len() - SHOWN));
    }
    shown.join(", ")
}
