//! Converts the arguments of a primitive in a net's text to inputs and parameters.

use super::links::{LinkResolver, list, type_name};
use super::parsed_text::{Argument, ArgumentValue, Definition, Source, TextRange, Word, to_u32};
use super::value::{flow_type, neutral, parse};
use crate::net::{Input, Inputs, PortRef};
use rpi_diag::{Code, Diagnostic, suggest};
use rpi_image::{
    Fallback, InPort, Param, ParamType, PortDefault, PortType, PrimDesc, Scalar, Value,
};
use rpi_literal::LiteralError;
use smallvec::SmallVec;

/// Sources of the in-ports and values of the parameters of a primitive, as read from the text of a net.
pub(super) struct PrimitiveInputs {
    pub(super) inputs: Inputs,
    pub(super) params: Vec<Value>,
}

/// Reader of the arguments of one primitive. It checks them against the primitive's declaration.
pub(super) struct Arguments<'a, 'b, 't> {
    pub(super) links: &'a mut LinkResolver<'b, 't>,
    pub(super) diagnostics: &'a mut Vec<Diagnostic>,
    pub(super) desc: &'static PrimDesc,
    pub(super) definition: &'a Definition,
    /// Whether the text has no syntax errors. Missing arguments are reported only then, since a syntax error may have
    /// hidden them.
    pub(super) is_error_free: bool,
}

/// Index of an in-port that the text connects, with the out-port it is connected to; `None` if the link has an error
/// that has been reported.
type ConnectedPort = (usize, Option<PortRef>);
/// Name of a parameter with the value that the text gives to it.
type Setting<'t> = (&'t str, Value);

impl<'t> Arguments<'_, '_, 't> {
    /// Returns the sources of all in-ports and the values of all parameters. Reports errors as diagnostics, and
    /// replaces wrong values by neutral ones.
    pub(super) fn read(mut self) -> PrimitiveInputs {
        let definition = self.definition;
        let mut links: SmallVec<[ConnectedPort; 4]> = SmallVec::new();
        let mut settings: SmallVec<[Setting<'t>; 2]> = SmallVec::new();
        for argument in self.links.text.arguments(definition) {
            match argument.value {
                ArgumentValue::Link(source) => links.extend(self.link(argument, source)),
                ArgumentValue::Text(text) => settings.extend(self.setting(argument, text)),
            }
        }
        self.report_duplicates();
        if self.is_error_free {
            self.report_missing(&links, &settings);
        }
        connect(self.desc, &links, &settings)
    }

    fn link(&mut self, argument: &Argument, source: Source) -> Option<ConnectedPort> {
        let scope = self.definition.scope;
        let origin = self.links.resolve(scope, source, self.diagnostics);
        let Some(port) = self.desc.input(self.str(argument.name)) else {
            let diagnostic = self.unknown_input(argument.name);
            self.diagnostics.push(diagnostic);
            return None;
        };
        let wrong = origin.and_then(|o| self.wrong_type(port, o, source));
        self.diagnostics.extend(wrong);
        Some((port, origin))
    }

    fn setting(&mut self, argument: &Argument, text: Word) -> Option<Setting<'t>> {
        let name = self.str(argument.name);
        let Some(ty) = parameter_type(self.desc, name) else {
            let diagnostic = self.unknown_parameter(argument.name);
            self.diagnostics.push(diagnostic);
            return None;
        };
        let value = parse(self.str(text), ty).unwrap_or_else(|error| {
            let diagnostic = self.invalid_value(argument.name, text, (&error, ty));
            self.diagnostics.push(diagnostic);
            neutral(ty)
        });
        Some((name, value))
    }

    fn wrong_type(&self, port: usize, origin: PortRef, source: Source) -> Option<Diagnostic> {
        let input = &self.desc.inputs[port];
        let (ty, name) = self.links.port_type(origin)?;
        if ty == input.ty {
            return None;
        }
        let [from, to] = [ty, input.ty].map(type_name);
        let message = format!(
            "type mismatch: `{name}` is {from}, `{}` expects {to}",
            input.name
        );
        let place = self.links.text.source_place(source);
        Some(
            Diagnostic::new(Code::RPI2101, message)
                .primary(self.span(place), format!("this is {from}"))
                .secondary(
                    self.span(self.type_place()),
                    format!("`{}` expects {to}", input.name),
                )
                .help(format!("connect an out-port that is {to}")),
        )
    }

    fn unknown_input(&self, word: Word) -> Diagnostic {
        let name = self.str(word);
        let ports: Vec<&str> = self.desc.inputs.iter().map(|p| p.name).collect();
        let message = format!("`{}` has no in-port `{}`", self.desc.name, name);
        let diagnostic = Diagnostic::new(Code::RPI1102, message)
            .primary(self.span(word), "this link is ignored")
            .note("the reference's Java core ignores such links, its C++ core rejects the net");
        if parameter_type(self.desc, name).is_some() {
            return diagnostic.help("this is a parameter: write its value in quotes");
        }
        advise(diagnostic, name, &ports)
    }

    fn unknown_parameter(&self, word: Word) -> Diagnostic {
        let name = self.str(word);
        let parameters = parameters(self.desc);
        let message = format!("`{}` has no parameter `{}`", self.desc.name, name);
        let diagnostic =
            Diagnostic::new(Code::RPI1103, message).primary(self.span(word), "unknown parameter");
        if self.desc.input(name).is_some() {
            return diagnostic
                .help("this is an in-port: connect it to an out-port, `name.outPort`");
        }
        advise(diagnostic, name, &parameters)
    }

    fn invalid_value(
        &self,
        name: Word,
        text: Word,
        (error, ty): (&LiteralError, ParamType),
    ) -> Diagnostic {
        let start = text
            .start
            .saturating_add(to_u32(error.offset))
            .min(text.end);
        let place = TextRange { start, ..text };
        let (name, prim) = (self.str(name), self.desc.name);
        let message = format!("`{name}` of `{prim}`: {}", error.message);
        Diagnostic::new(Code::RPI2102, message)
            .primary(self.span(place), error.message.clone())
            .help(match ty {
                ParamType::Scalar(Scalar::Bool) => "write `true` or `false`",
                ParamType::Scalar(Scalar::Int) => "write an integer, such as `1`",
                ParamType::Scalar(Scalar::Real) => "write a number, such as `1.0`",
                _ => "`rpic explain RPI2102` shows the syntax of the values of each type",
            })
    }

    fn report_duplicates(&mut self) {
        let text = self.links.text;
        let arguments = text.arguments(self.definition);
        for (k, second) in arguments.iter().enumerate() {
            let earlier = arguments[..k].iter();
            let name = text.str(second.name);
            let mut earlier = earlier.filter(|a| text.str(a.name) == name);
            let Some(first) = earlier.next() else {
                continue;
            };
            let places = [first, second].map(|a| text.argument_place(a));
            if text.str(places[0]) != text.str(places[1]) {
                let message = format!("duplicate argument `{name}`");
                let diagnostic = Diagnostic::new(Code::RPI1107, message)
                    .primary(self.span(places[1]), "given again here")
                    .secondary(self.span(places[0]), "first given here")
                    .help("an in-port has one source: delete one of them");
                self.diagnostics.push(diagnostic);
            }
        }
    }

    /// Returns the names of the in-ports and parameters that need a value and have none in the text.
    fn missing(&self, links: &[ConnectedPort], settings: &[Setting<'t>]) -> Vec<&'static str> {
        let linked = |k: usize| links.iter().any(|(i, _)| *i == k);
        let is_set = |name: &str| settings.iter().any(|(n, _)| *n == name);
        let ports = self.desc.inputs.iter().enumerate();
        let ports = ports
            .filter(|(k, _)| !linked(*k))
            .filter_map(|(_, p)| match p.fallback {
                Fallback::Required => Some(p.name),
                Fallback::Param(name, PortDefault::Required) if !is_set(name) => Some(name),
                _ => None,
            });
        let params = self.desc.params.iter();
        let params = params.filter(|p| matches!(p.default, PortDefault::Required));
        ports
            .chain(params.map(|p| p.name).filter(|n| !is_set(n)))
            .collect()
    }

    fn report_missing(&mut self, links: &[ConnectedPort], settings: &[Setting<'t>]) {
        let missing = self.missing(links, settings);
        if missing.is_empty() {
            return;
        }
        let message = format!(
            "missing argument of `{}`: {}",
            self.desc.name,
            list(&missing)
        );
        let diagnostic = Diagnostic::new(Code::RPI2103, message)
            .primary(self.span(self.type_place()), "not connected here")
            .help(format!("connect it: `{}=name.outPort`", missing[0]));
        self.diagnostics.push(diagnostic);
    }

    /// Returns the location of the primitive's name in its definition.
    fn type_place(&self) -> TextRange {
        let start = self.definition.place.start;
        TextRange {
            start,
            end: start + to_u32(self.desc.name.len()),
        }
    }

    fn str(&self, word: Word) -> &'t str {
        self.links.text.str(word)
    }

    fn span(&self, place: TextRange) -> rpi_diag::Span {
        self.links.text.span(place)
    }
}

fn advise(diagnostic: Diagnostic, name: &str, names: &[&str]) -> Diagnostic {
    match suggest(name, names.iter().copied()) {
        Some(near) => {
            let place = diagnostic.span();
            diagnostic.did_you_mean(place, Some(near))
        }
        None if names.is_empty() => diagnostic.help("it has none: delete this argument"),
        None => diagnostic.help(format!("available: {}", list(names))),
    }
}

fn connect(desc: &PrimDesc, links: &[ConnectedPort], settings: &[Setting<'_>]) -> PrimitiveInputs {
    let setting = |name: &str| {
        let mut found = settings.iter().filter(|(n, _)| *n == name);
        found.next().map(|(_, v)| v.clone())
    };
    let input = |(k, port): (usize, &InPort)| match links.iter().find(|(i, _)| *i == k) {
        Some((_, origin)) => origin.map_or(Input::Unconnected, Input::Port),
        None => default_input(port, setting).map_or(Input::Unconnected, Input::constant),
    };
    let param = |p: &Param| {
        let default = || p.default.value(flow_type(p.ty));
        setting(p.name)
            .or_else(default)
            .unwrap_or_else(|| neutral(p.ty))
    };
    PrimitiveInputs {
        inputs: desc.inputs.iter().enumerate().map(input).collect(),
        params: desc.params.iter().map(param).collect(),
    }
}

/// Returns the constant that replaces an unconnected in-port, made from the parameters that stand for the in-port;
/// `None` if it has no such parameters. `setting` returns the value that the text gives to a parameter.
fn default_input(port: &InPort, setting: impl Fn(&str) -> Option<Value>) -> Option<Value> {
    match port.fallback {
        Fallback::Required | Fallback::AbsentValue => None,
        Fallback::Param(name, default) => {
            setting(name).or_else(|| default.value(flow_type(port_parameter(port.ty)?)))
        }
        Fallback::ComposedOfParams(parts, make) => {
            let real = |(name, default): &(&str, f64)| {
                setting(name).and_then(|v| v.as_real()).unwrap_or(*default)
            };
            Some(make(&parts.iter().map(real).collect::<Vec<f64>>()))
        }
    }
}

/// Returns the type of the parameter with this name; `None` if the primitive has none.
fn parameter_type(desc: &PrimDesc, name: &str) -> Option<ParamType> {
    if let Some(k) = desc.param(name) {
        return Some(desc.params[k].ty);
    }
    let port = &desc.inputs[desc.in_port_of_param(name)?];
    match port.fallback {
        Fallback::ComposedOfParams(..) => Some(ParamType::Scalar(Scalar::Real)),
        _ => port_parameter(port.ty),
    }
}

/// Returns the type of the parameter that can replace an in-port of the type `ty`; `None` for a matrix, which has no
/// text form.
fn port_parameter(ty: PortType) -> Option<ParamType> {
    match ty {
        PortType::Scalar(s) => Some(ParamType::Scalar(s)),
        PortType::Array(s) => Some(ParamType::Array(s)),
        PortType::Matrix => None,
    }
}

/// Returns the names of all parameters of a primitive, including those that replace unconnected in-ports.
fn parameters(desc: &PrimDesc) -> Vec<&'static str> {
    let ports = desc.inputs.iter().flat_map(|p| match p.fallback {
        Fallback::Param(name, _) => vec![name],
        Fallback::ComposedOfParams(parts, _) => parts.iter().map(|(n, _)| *n).collect(),
        Fallback::Required | Fallback::AbsentValue => Vec::new(),
    });
    desc.params.iter().map(|p| p.name).chain(ports).collect()
}
