//! Converts the arguments of a primitive in a net's text to inputs and parameters.

use super::links::{Links, list, type_name};
use super::text::{Argument, Definition, Given, Place, Source, Word, number};
use super::value::{flow_type, neutral, parse};
use crate::net::{Input, Inputs, PortRef};
use rpi_diag::{Code, Finding, suggest};
use rpi_image::{InPort, Need, Param, ParamType, PortDefault, PortType, PrimDesc, Value};
use rpi_literal::LiteralError;
use smallvec::SmallVec;

/// Inputs and parameters of a primitive.
pub(super) struct Connected {
    pub(super) inputs: Inputs,
    pub(super) params: Vec<Value>,
}

/// Reads the arguments of one primitive and checks them against its descriptor.
pub(super) struct Arguments<'a, 'b, 't> {
    pub(super) links: &'a mut Links<'b, 't>,
    pub(super) findings: &'a mut Vec<Finding>,
    pub(super) desc: &'static PrimDesc,
    pub(super) definition: &'a Definition,
    /// Whether the text has no syntax errors. Missing arguments are reported only then, since an error may have hidden
    /// them.
    pub(super) intact: bool,
}

/// Connected in-port, by index. Its origin is `None` if the error was already reported.
type Link = (usize, Option<PortRef>);
/// Parameter with its value.
type Setting<'t> = (&'t str, Value);

impl<'t> Arguments<'_, '_, 't> {
    /// Returns all inputs and parameters. Errors are reported as diagnostics, and a neutral value replaces a wrong one.
    pub(super) fn read(mut self) -> Connected {
        let definition = self.definition;
        let mut links: SmallVec<[Link; 4]> = SmallVec::new();
        let mut settings: SmallVec<[Setting<'t>; 2]> = SmallVec::new();
        for argument in self.links.text.arguments(definition) {
            match argument.value {
                Given::Link(source) => links.extend(self.link(argument, source)),
                Given::Text(text) => settings.extend(self.setting(argument, text)),
            }
        }
        self.report_twice();
        if self.intact {
            self.report_missing(&links, &settings);
        }
        connect(self.desc, &links, &settings)
    }

    fn link(&mut self, argument: &Argument, source: Source) -> Option<Link> {
        let scope = self.definition.scope;
        let origin = self.links.origin(scope, source, self.findings);
        let Some(port) = self.desc.input(self.str(argument.name)) else {
            let finding = self.no_input(argument.name);
            self.findings.push(finding);
            return None;
        };
        let wrong = origin.and_then(|o| self.wrong_type(port, o, source));
        self.findings.extend(wrong);
        Some((port, origin))
    }

    fn setting(&mut self, argument: &Argument, text: Word) -> Option<Setting<'t>> {
        let name = self.str(argument.name);
        let Some(ty) = parameter_type(self.desc, name) else {
            let finding = self.no_parameter(argument.name);
            self.findings.push(finding);
            return None;
        };
        let value = parse(self.str(text), ty).unwrap_or_else(|error| {
            let finding = self.no_value(argument.name, text, &error);
            self.findings.push(finding);
            neutral(ty)
        });
        Some((name, value))
    }

    fn wrong_type(&self, port: usize, origin: PortRef, source: Source) -> Option<Finding> {
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
            Finding::new(Code::RPI2101, message)
                .at(self.span(place), format!("this is {from}"))
                .also(
                    self.span(self.type_place()),
                    format!("`{}` expects {to}", input.name),
                )
                .help(format!("connect an out-port that is {to}")),
        )
    }

    fn no_input(&self, word: Word) -> Finding {
        let name = self.str(word);
        let ports: Vec<&str> = self.desc.inputs.iter().map(|p| p.name).collect();
        let message = format!("`{}` has no in-port `{}`", self.desc.name, name);
        let finding = Finding::new(Code::RPI1102, message)
            .at(self.span(word), "this link is ignored")
            .note("the reference's Java core ignores such links, its C++ core rejects the net");
        if parameter_type(self.desc, name).is_some() {
            return finding.help("this is a parameter: write its value in quotes");
        }
        advise(finding, name, &ports)
    }

    fn no_parameter(&self, word: Word) -> Finding {
        let name = self.str(word);
        let parameters = parameters(self.desc);
        let message = format!("`{}` has no parameter `{}`", self.desc.name, name);
        let finding = Finding::new(Code::RPI1103, message).at(self.span(word), "unknown parameter");
        if self.desc.input(name).is_some() {
            return finding.help("this is an in-port: connect it to an out-port, `name.outPort`");
        }
        advise(finding, name, &parameters)
    }

    fn no_value(&self, name: Word, text: Word, error: &LiteralError) -> Finding {
        let start = text.start.saturating_add(number(error.at)).min(text.end);
        let place = Place { start, ..text };
        let (name, prim) = (self.str(name), self.desc.name);
        let message = format!("`{name}` of `{prim}`: {}", error.message);
        Finding::new(Code::RPI2102, message)
            .at(self.span(place), error.message.clone())
            .help("see the page of this code for the syntax of values")
    }

    fn report_twice(&mut self) {
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
                let finding = Finding::new(Code::RPI1107, message)
                    .at(self.span(places[1]), "given again here")
                    .also(self.span(places[0]), "first given here")
                    .help("an in-port has one source: delete one of them");
                self.findings.push(finding);
            }
        }
    }

    fn report_missing(&mut self, links: &[Link], settings: &[Setting<'t>]) {
        let linked = |k: usize| links.iter().any(|(i, _)| *i == k);
        let given = |name: &str| settings.iter().any(|(n, _)| *n == name);
        let ports = self.desc.inputs.iter().enumerate();
        let ports = ports
            .filter(|(k, _)| !linked(*k))
            .filter_map(|(_, p)| match p.need {
                Need::Required => Some(p.name),
                Need::Param(name, PortDefault::Required) if !given(name) => Some(name),
                _ => None,
            });
        let params = self.desc.params.iter();
        let params = params.filter(|p| matches!(p.default, PortDefault::Required));
        let missing: Vec<&str> = ports
            .chain(params.map(|p| p.name).filter(|n| !given(n)))
            .collect();
        if missing.is_empty() {
            return;
        }
        let message = format!(
            "missing argument of `{}`: {}",
            self.desc.name,
            list(&missing)
        );
        let finding = Finding::new(Code::RPI2103, message)
            .at(self.span(self.type_place()), "not connected here")
            .help(format!("connect it: `{}=name.outPort`", missing[0]));
        self.findings.push(finding);
    }

    /// Location of the primitive's type name.
    fn type_place(&self) -> Place {
        let start = self.definition.place.start;
        Place {
            start,
            end: start + number(self.desc.name.len()),
        }
    }

    fn str(&self, word: Word) -> &'t str {
        self.links.text.str(word)
    }

    fn span(&self, place: Place) -> rpi_diag::Span {
        self.links.text.span(place)
    }
}

fn advise(finding: Finding, name: &str, names: &[&str]) -> Finding {
    match suggest(name, names.iter().copied()) {
        Some(near) => {
            let place = finding.span();
            finding.did_you_mean(place, Some(near))
        }
        None if names.is_empty() => finding.help("it has none: delete this argument"),
        None => finding.help(format!("available: {}", list(names))),
    }
}

fn connect(desc: &PrimDesc, links: &[Link], settings: &[Setting<'_>]) -> Connected {
    let given = |name: &str| {
        let mut found = settings.iter().filter(|(n, _)| *n == name);
        found.next().map(|(_, v)| v.clone())
    };
    let input = |(k, port): (usize, &InPort)| match links.iter().find(|(i, _)| *i == k) {
        Some((_, origin)) => origin.map_or(Input::Open, Input::Port),
        None => stand_in(port, given).map_or(Input::Open, Input::constant),
    };
    let param = |p: &Param| {
        let default = || p.default.value(flow_type(p.ty));
        given(p.name)
            .or_else(default)
            .unwrap_or_else(|| neutral(p.ty))
    };
    Connected {
        inputs: desc.inputs.iter().enumerate().map(input).collect(),
        params: desc.params.iter().map(param).collect(),
    }
}

/// Value of the parameters that replace a missing link; `None` if the in-port has no such parameter.
fn stand_in(port: &InPort, given: impl Fn(&str) -> Option<Value>) -> Option<Value> {
    match port.need {
        Need::Required | Need::Absent => None,
        Need::Param(name, default) => {
            given(name).or_else(|| default.value(flow_type(port_parameter(port.ty)?)))
        }
        Need::Params(parts, make) => {
            let real = |(name, default): &(&str, f64)| {
                given(name).and_then(|v| v.as_real()).unwrap_or(*default)
            };
            Some(make(&parts.iter().map(real).collect::<Vec<f64>>()))
        }
    }
}

/// Type of the parameter with this name, if there is one.
fn parameter_type(desc: &PrimDesc, name: &str) -> Option<ParamType> {
    if let Some(k) = desc.param(name) {
        return Some(desc.params[k].ty);
    }
    let port = &desc.inputs[desc.fallback(name)?];
    match port.need {
        Need::Params(..) => Some(ParamType::One(rpi_image::Scalar::Real)),
        _ => port_parameter(port.ty),
    }
}

/// Type of the parameter that replaces an in-port; `None` for a matrix, which has no text form.
fn port_parameter(ty: PortType) -> Option<ParamType> {
    match ty {
        PortType::One(s) => Some(ParamType::One(s)),
        PortType::Array(s) => Some(ParamType::Array(s)),
        PortType::Matrix => None,
    }
}

/// Names of all parameters, including those that replace in-ports.
fn parameters(desc: &PrimDesc) -> Vec<&'static str> {
    let ports = desc.inputs.iter().flat_map(|p| match p.need {
        Need::Param(name, _) => vec![name],
        Need::Params(parts, _) => parts.iter().map(|(n, _)| *n).collect(),
        Need::Required | Need::Absent => Vec::new(),
    });
    desc.params.iter().map(|p| p.name).chain(ports).collect()
}
