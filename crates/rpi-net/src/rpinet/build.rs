//! Builds a [`Net`] from a parsed [`Text`].

use super::arguments::Arguments;
use super::links::{LinkResolver, Nodes};
use super::names::SymbolTable;
use super::parsed_text::{
    Argument, ArgumentValue, BodyId, DefinitionId, DefinitionKind, ParsedText, Source, Word,
};
use crate::net::{
    AbsentPolicy, Activation, Fragment, FragmentId, FragmentPort, Input, Inputs, Net, Node, Origin,
    PortRef, Restart, Termination, Types,
};
use rpi_diag::{Code, Diagnostic, Fix, suggest};
use rpi_image::{PortType, Scalar};
use rpi_prims::{PrimId, registry};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Name of the in-port of a fragment that activates it.
pub(super) const ACTIVATION: &str = "inActive";
/// Name of the out-port of the root fragment that ends the net.
pub(super) const TERMINATE: &str = "outTerminate";
/// Name of the out-port of the root fragment that carries the error number of the net (0: no error).
pub(super) const FAIL: &str = "outFail";

/// Name of the in-port of a fragment that resets its state while it is true. The reference system does not have this
/// port.
pub(super) const RESTART: &str = "rpi:restart";
/// Quoted value of the in-port [`RESTART`] with which the state is reset whenever the fragment becomes active.
pub(super) const RESTART_ON_ACTIVATION: &str = "activation";

/// Builds the net for a parsed text. The net is valid only if `diagnostics` contains no errors afterwards.
pub(super) fn build(name: &str, text: &ParsedText<'_>, diagnostics: &mut Vec<Diagnostic>) -> Net {
    let intact = diagnostics.is_empty();
    let names = SymbolTable::new(text, diagnostics);
    let mut builder = Builder {
        text,
        names: &names,
        net: Net::new(name),
        nodes: vec![None; text.definitions.len()],
        fragments: vec![FragmentId::ROOT; text.fragments.len()],
        prims: FxHashMap::default(),
        unnamed: 0,
        diagnostics,
    };
    builder.net.nodes.reserve_exact(text.definitions.len());
    builder.declare();
    let Builder {
        mut net,
        nodes,
        fragments,
        ..
    } = builder;
    let mut connector = Linker {
        text,
        links: LinkResolver::new(text, &names, &nodes),
        fragments: &fragments,
        net: &mut net,
        diagnostics,
        is_error_free: intact,
    };
    connector.definitions(&names);
    connector.outputs(&names);
    net
}

/// First pass over the text: creates all nodes and fragments, without links.
struct Builder<'a, 't> {
    text: &'a ParsedText<'t>,
    names: &'a SymbolTable<'t>,
    net: Net,
    nodes: Nodes,
    fragments: Vec<FragmentId>,
    prims: FxHashMap<&'t str, Option<PrimId>>,
    unnamed: u32,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl<'t> Builder<'_, 't> {
    fn declare(&mut self) {
        let mut unknown: BTreeMap<&str, Vec<Word>> = BTreeMap::new();
        for id in self.text.definition_ids() {
            if self.names.is_duplicate(id) {
                continue;
            }
            match self.text.definition(id).kind {
                DefinitionKind::Fragment(body) => self.declare_fragment(id, body),
                DefinitionKind::Primitive(ty) => match self.prim(self.text.str(ty)) {
                    Some(prim) => self.declare_node(id, prim),
                    None => unknown.entry(self.text.str(ty)).or_default().push(ty),
                },
            }
        }
        let unknown = unknown.into_values().map(|at| unknown_type(self.text, &at));
        self.diagnostics.extend(unknown);
    }

    /// Returns the primitive with a registered name; `None` if there is none. Searches of the registry are cached.
    fn prim(&mut self, name: &'t str) -> Option<PrimId> {
        *self
            .prims
            .entry(name)
            .or_insert_with(|| PrimId::from_name(name))
    }

    fn declare_fragment(&mut self, id: DefinitionId, body: BodyId) {
        let fragment = Fragment {
            name: self.name(id),
            parent: Some(self.enclosing_fragment(id)),
            activation: Activation::Always,
            restart: Restart::Never,
            is_clock: false,
            inputs: Vec::new(),
            outputs: Vec::new(),
            budget_ns: None,
            origin: self.origin(id),
        };
        self.fragments[body as usize] = self.net.add_fragment(fragment);
    }

    /// Returns the fragment of the net that directly contains a definition of the text.
    fn enclosing_fragment(&self, id: DefinitionId) -> FragmentId {
        self.fragments[self.text.definition(id).scope as usize]
    }

    fn declare_node(&mut self, id: DefinitionId, prim: PrimId) {
        let node = Node {
            name: self.name(id),
            prim,
            fragment: self.enclosing_fragment(id),
            inputs: Inputs::new(),
            params: Vec::new(),
            outputs: Types::new(),
            origin: self.origin(id),
        };
        self.nodes[id as usize] = Some((self.net.add_node(node), prim));
    }

    /// Returns the name of a definition, or an unused generated name if it has none.
    fn name(&mut self, id: DefinitionId) -> String {
        let definition = self.text.definition(id);
        if let Some(name) = definition.name {
            return self.text.str(name).to_owned();
        }
        loop {
            self.unnamed += 1;
            let name = format!("_{}", self.unnamed);
            if !self.names.is_taken(definition.scope, &name) {
                return name;
            }
        }
    }

    fn origin(&self, id: DefinitionId) -> Origin {
        Origin {
            span: self.text.span(self.text.definition(id).place),
            flow: None,
        }
    }
}

/// Second pass over the text: connects the in-ports of the nodes and fragments.
struct Linker<'a, 'b, 't> {
    text: &'b ParsedText<'t>,
    links: LinkResolver<'b, 't>,
    fragments: &'a [FragmentId],
    net: &'a mut Net,
    diagnostics: &'a mut Vec<Diagnostic>,
    is_error_free: bool,
}

impl<'t> Linker<'_, '_, 't> {
    fn definitions(&mut self, names: &SymbolTable<'t>) {
        let text = self.text;
        for (id, definition) in text.definition_ids().zip(&text.definitions) {
            if names.is_duplicate(id) {
                continue;
            }
            match definition.kind {
                DefinitionKind::Fragment(body) => {
                    self.fragment(definition.scope, body, text.arguments(definition))
                }
                DefinitionKind::Primitive(_) => self.node(id),
            }
        }
    }

    fn node(&mut self, id: DefinitionId) {
        let Some((node, prim)) = self.links.nodes[id as usize] else {
            return;
        };
        let arguments = Arguments {
            links: &mut self.links,
            diagnostics: self.diagnostics,
            desc: prim.desc(),
            definition: self.text.definition(id),
            is_error_free: self.is_error_free,
        };
        let connected = arguments.read();
        let node = &mut self.net.nodes[node.index()];
        node.inputs = connected.inputs;
        node.params = connected.params;
    }

    fn fragment(&mut self, scope: BodyId, body: BodyId, arguments: &[Argument]) {
        let at = self.fragments[body as usize].index();
        for argument in arguments {
            if restarts_on_activation(self.text, argument) {
                self.net.fragments[at].restart = Restart::OnActivation;
                continue;
            }
            let Some(port) = self.argument(scope, argument) else {
                continue;
            };
            let name = argument.name;
            let label = self.text.str(name);
            if matches!(label, ACTIVATION | RESTART) {
                self.check_port_type(port, PortType::Scalar(Scalar::Bool), name);
            }
            let fragment = &mut self.net.fragments[at];
            match label {
                ACTIVATION => {
                    fragment.activation = Activation::When {
                        condition: port,
                        if_absent: AbsentPolicy::Active,
                    };
                }
                RESTART => fragment.restart = Restart::Every(port),
                name => fragment.inputs.push(FragmentPort {
                    name: name.to_owned(),
                    source: Input::Port(port),
                }),
            }
        }
    }

    /// Returns the out-port to which the text connects an in-port of a fragment; `None` if an error was reported.
    /// `scope` is the fragment around that fragment.
    fn argument(&mut self, scope: BodyId, argument: &Argument) -> Option<PortRef> {
        match argument.value {
            ArgumentValue::Link(source) => self.links.resolve(scope, source, self.diagnostics),
            ArgumentValue::Text(_) => {
                let name = argument.name;
                let label = self.text.str(name);
                let message = format!("fragments have no parameters, found `{label}`");
                let place = self.text.span(self.text.argument_place(argument));
                let diagnostic =
                    Diagnostic::new(Code::RPI1103, message).primary(place, "quoted value");
                let value = "connect it to a constant: `name=Core::DoubleValue(Value='..')`";
                self.diagnostics.push(diagnostic.help(value));
                None
            }
        }
    }

    fn outputs(&mut self, names: &SymbolTable<'t>) {
        for body in self.text.body_ids() {
            let definition = self.text.body(body).definition;
            if definition.is_some_and(|d| names.is_duplicate(d)) {
                continue;
            }
            self.body_outputs(body, names);
        }
    }

    fn body_outputs(&mut self, body: BodyId, names: &SymbolTable<'t>) {
        let (mut terminate, mut fail) = (None, None);
        let mut outputs = Vec::new();
        for (k, output) in self.text.body(body).outputs.iter().enumerate() {
            let label = self.text.str(output.name);
            if names.output(body, label) != Some(k) {
                continue;
            }
            let Some(port) = self.output(body, output.source) else {
                continue;
            };
            match label {
                TERMINATE if body == 0 => {
                    self.check_port_type(port, PortType::Scalar(Scalar::Bool), output.name);
                    terminate = Some(Input::Port(port));
                }
                FAIL if body == 0 => {
                    self.check_port_type(port, PortType::Scalar(Scalar::Int), output.name);
                    fail = Some(Input::Port(port));
                }
                name => outputs.push(FragmentPort {
                    name: name.to_owned(),
                    source: Input::Port(port),
                }),
            }
        }
        self.net.fragments[self.fragments[body as usize].index()].outputs = outputs;
        if body == 0 {
            self.net.termination = Termination::Ports { terminate, fail };
        }
    }

    fn output(&mut self, body: BodyId, source: Source) -> Option<PortRef> {
        self.links.resolve(body, source, self.diagnostics)
    }

    /// Reports an error if the source `port` of a port with a fixed meaning, such as `inActive`, has another type than
    /// `needed`.
    fn check_port_type(&mut self, port: PortRef, needed: PortType, name: Word) {
        let diagnostic = self.links.wrong_type_at(port, needed, name);
        self.diagnostics.extend(diagnostic);
    }
}

fn restarts_on_activation(text: &ParsedText<'_>, argument: &Argument) -> bool {
    let whenever = |t| text.str(t) == RESTART_ON_ACTIVATION;
    matches!(argument.value, ArgumentValue::Text(t) if whenever(t))
        && text.str(argument.name) == RESTART
}

fn unknown_type(text: &ParsedText<'_>, places: &[Word]) -> Diagnostic {
    const SHOWN: usize = 4;
    let name = text.str(places[0]);
    let diagnostic = Diagnostic::new(Code::RPI1101, format!("undefined primitive `{name}`"));
    let labelled = places.iter().take(SHOWN);
    let diagnostic = labelled.fold(diagnostic, |f, word| {
        f.primary(text.span(*word), "unknown primitive")
    });
    let diagnostic = match places.len().saturating_sub(SHOWN) {
        0 => diagnostic,
        more => diagnostic.note(format!(
            "and at {}",
            rpi_diag::with_noun(more, "more place")
        )),
    };
    match suggest(name, registry().iter().map(|p| p.desc.name)) {
        Some(near) => {
            let fix = Fix::maybe(format!("write `{near}`"));
            let fix = places
                .iter()
                .fold(fix, |fix, word| fix.replace(text.span(*word), near.clone()));
            diagnostic.help(format!("did you mean `{near}`?")).fix(fix)
        }
        None => diagnostic.help("the primitive reference lists all primitives"),
    }
}
