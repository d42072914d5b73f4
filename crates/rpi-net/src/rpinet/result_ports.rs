//! Converts the results and exports of a command to the ports and primitives of the reference system's nets.
//!
//! A command ends with named results and exports flows (M10). A net of the reference system ends by its out-port
//! `outTerminate`, with the error number in `outFail`, and publishes by primitives. So each result becomes a published
//! Boolean that is true in the cycle in which the result is chosen, and a `yield` waits for a successor. Properties
//! that a `.rpinet` file cannot express are reported.

use crate::fragment_tree::FragmentTree;
use crate::net::{
    FragmentId, Input, Net, Node, NodeId, Origin, PortRef, ResultKind, ResultPort, Termination,
};
use crate::passes::writers::{SAME_MOTION, resource};
use crate::passes::{Analysis, FlowPresence, Presences, analyse};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::{
    CommandFlow, OutPort, Param, ParamType, PortType, PrimDesc, Role, Scalar, Type, Value,
};
use rpi_prims::{PrimId, registry};

/// Returns a copy of an analysed net with ports and primitives in place of its results and exports, and diagnostics for all
/// that is lost.
#[must_use]
pub fn results_to_ports(analysis: &Analysis) -> (Net, Vec<Diagnostic>) {
    let net = &analysis.net;
    let mut ending = ResultConverter {
        presences: &analysis.presences,
        tree: FragmentTree::new(net),
        net: net.clone(),
        diagnostics: Vec::new(),
    };
    ending.exports();
    ending.results();
    let mut diagnostics = ending.diagnostics;
    diagnostics.extend(lost_budgets(net));
    diagnostics.extend(lost_alternatives(net));
    diagnostics.extend(clock_dependency_cycle(net));
    (ending.net, diagnostics)
}

/// Converter of results and exports to ports: the net under construction and the analyses that it needs.
struct ResultConverter<'a> {
    net: Net,
    tree: FragmentTree,
    presences: &'a Presences,
    diagnostics: Vec<Diagnostic>,
}

impl ResultConverter<'_> {
    fn exports(&mut self) {
        for export in std::mem::take(&mut self.net.exports) {
            let node = self.net.node(export.source.node);
            let ty = node.outputs[usize::from(export.source.port)];
            let source = Input::Port(export.source);
            if self.publish(&export.key, source, ty).is_none() {
                let message = format!("`{}` cannot be published in a `.rpinet` net", export.key);
                let diagnostic = Diagnostic::new(Code::RPI9102, message);
                let why = format!("no primitive publishes {ty}");
                self.diagnostics
                    .push(diagnostic.primary(export.origin.span, why));
            }
        }
    }

    fn results(&mut self) {
        let Termination::Results(results) = &mut self.net.termination else {
            return;
        };
        let results = std::mem::take(results);
        let conditions: Vec<Input> = results.iter().map(|r| self.condition(r)).collect();
        let is_fail = |k: &usize| results[*k].kind == ResultKind::Fail;
        let (fails, others): (Vec<usize>, Vec<usize>) = (0..results.len()).partition(is_fail);
        let mut any = Input::Const(Box::new(Value::bool(false)));
        for k in fails.iter().chain(&others) {
            let free = self.add_primitive("Core::BooleanNot", vec![any.clone()]);
            let chosen = self.add_primitive("Core::BooleanAnd", vec![conditions[*k].clone(), free]);
            self.publish(&results[*k].name, chosen, Type::Scalar(Scalar::Bool));
            any = self.add_primitive("Core::BooleanOr", vec![any, conditions[*k].clone()]);
        }
        let mut error = Input::Const(Box::new(Value::int(0)));
        // In reverse order, so that the first `fail` in the text decides the error number.
        for (number, k) in (1..).zip(&fails).collect::<Vec<_>>().into_iter().rev() {
            let number = Input::Const(Box::new(Value::int(number)));
            let inputs = vec![conditions[*k].clone(), number, error];
            error = self.add_primitive("Core::IntConditional", inputs);
        }
        self.net.termination = Termination::Ports {
            terminate: Some(any),
            fail: (!fails.is_empty()).then_some(error),
        };
    }

    /// Returns the condition of a result. A `yield` also needs a successor.
    fn condition(&mut self, result: &ResultPort) -> Input {
        let condition = self.or_false(&result.condition);
        let takeover = registry().iter().map(|prim| prim.desc);
        let mut takeover = takeover.filter(|d| d.role == Role::Flow(CommandFlow::Takeover));
        match (result.kind, takeover.next()) {
            (ResultKind::Yield, Some(desc)) => {
                let covered = self.add_primitive(desc.name, Vec::new());
                self.add_primitive("Core::BooleanAnd", vec![condition, covered])
            }
            _ => condition,
        }
    }

    /// Returns a Boolean that is false where `condition` is absent.
    fn or_false(&mut self, condition: &Input) -> Input {
        let no = Input::Const(Box::new(Value::bool(false)));
        let seen = Some(self.presences);
        let seen = seen.map(|p| p.presence_at(&self.net, &self.tree, FragmentId::ROOT, condition));
        match (condition, seen) {
            (Input::Unconnected, _) => no,
            (Input::Const(_), _) | (_, Some(FlowPresence::Total)) => condition.clone(),
            _ => {
                let absent = self.add_primitive("Core::BooleanIsNull", vec![condition.clone()]);
                let inputs = vec![absent, no, condition.clone()];
                self.add_primitive("Core::BooleanConditional", inputs)
            }
        }
    }

    /// Adds a primitive to the root and returns its first out-port.
    fn add_primitive(&mut self, name: &str, inputs: Vec<Input>) -> Input {
        match PrimId::from_name(name) {
            Some(prim) => {
                let node = self.add(name, prim, inputs, "");
                Input::Port(PortRef { node, port: 0 })
            }
            None => Input::Unconnected,
        }
    }

    fn publish(&mut self, key: &str, source: Input, ty: Type) -> Option<()> {
        let takes = |desc: &PrimDesc| {
            let port = desc.inputs.first().map(|port| port.ty);
            let of_this_net = desc.param("Key").is_some() && desc.param("RemoteNet").is_none();
            let is_same_type =
                matches!((port, ty), (Some(PortType::Scalar(a)), Type::Scalar(b)) if a == b);
            desc.role == Role::Export && of_this_net && is_same_type
        };
        let desc = registry().iter().map(|prim| prim.desc).find(takes)?;
        self.add(key, PrimId::from_name(desc.name)?, vec![source], key);
        Some(())
    }

    /// Adds a primitive to the root. Its parameters have their defaults, except `Key`, which is set to `key`.
    fn add(&mut self, name: &str, prim: PrimId, inputs: Vec<Input>, key: &str) -> NodeId {
        let desc = prim.desc();
        let param = |param: &Param| match param.name {
            "Key" => Some(Value::Str(key.to_owned())),
            _ => param.default.value(match param.ty {
                ParamType::Scalar(scalar) => Type::Scalar(scalar),
                ParamType::Array(scalar) => Type::Array(scalar, 0),
                ParamType::Str => Type::Scalar(Scalar::Bool),
            }),
        };
        let output = |port: &OutPort| match port.ty {
            PortType::Scalar(scalar) => Some(Type::Scalar(scalar)),
            PortType::Array(_) | PortType::Matrix => None,
        };
        self.net.add_node(Node {
            name: name.rsplit("::").next().unwrap_or(name).to_owned(),
            prim,
            fragment: FragmentId::ROOT,
            inputs: inputs.into(),
            params: desc.params.iter().filter_map(param).collect(),
            outputs: desc.outputs.iter().filter_map(output).collect(),
            origin: Origin {
                span: Span::NONE,
                flow: None,
            },
        })
    }
}

/// Diagnostics for declared budgets, which a `.rpinet` file cannot express.
fn lost_budgets(net: &Net) -> impl Iterator<Item = Diagnostic> + '_ {
    let stated = net.fragments.iter().filter(|f| f.budget_ns.is_some());
    stated.map(|fragment| {
        let what = match fragment.name.as_str() {
            "" => "the command".to_owned(),
            name => format!("`{name}`"),
        };
        let message = format!("the budget of {what} is lost in the `.rpinet` text");
        Diagnostic::new(Code::RPI9102, message)
            .primary(fragment.origin.span, "has a budget")
            .help("emit an image to keep it, or delete the budget if the text is enough")
    })
}

/// Diagnostic for mutually dependent clocks. In a `.rpinet` net all operations of a condition form one step, so flows
/// of two clocks that depend on each other are a dependency cycle.
fn clock_dependency_cycle(net: &Net) -> Option<Diagnostic> {
    if !net.fragments.iter().any(|fragment| fragment.is_clock) {
        return None;
    }
    let mut grouped = net.clone();
    for fragment in &mut grouped.fragments {
        fragment.is_clock = false;
    }
    let mut found = analyse(grouped, |_| false).ok()?.diagnostics.into_iter();
    let ring = found.find(|diagnostic| diagnostic.code == Code::RPI4001)?;
    let message = "flows of several clocks form a dependency cycle in a `.rpinet` net";
    let diagnostic = Diagnostic::new(Code::RPI9102, message)
        .primary(ring.span(), "part of the dependency cycle");
    Some(
        diagnostic
            .help("move the flow out of its clock and sample it where the other clock reads it"),
    )
}

/// Diagnostics for mutually exclusive device ports, which a `.rpinet` file cannot express. Those of arms are known to
/// the reference system.
fn lost_alternatives(net: &Net) -> impl Iterator<Item = Diagnostic> + '_ {
    let written = |device: &str, port: &str| {
        let mut nodes = net.nodes.iter();
        nodes.find(|node| resource(node).is_some_and(|r| r.device == device && r.port == port))
    };
    net.alternatives.iter().filter_map(move |group| {
        let ports = group.ports.iter();
        let ports = ports.filter(|port| !SAME_MOTION.contains(&port.as_str()));
        let both: Vec<(&String, &Node)> = ports
            .filter_map(|port| Some((port, written(&group.device, port)?)))
            .collect();
        let [(a, first), (b, second), ..] = both[..] else {
            return None;
        };
        let device = &group.device;
        let message = format!(
            "the conflict of `{device}.{a}` and `{device}.{b}` is lost in the `.rpinet` text"
        );
        let diagnostic =
            Diagnostic::new(Code::RPI9102, message).primary(first.origin.span, "set here");
        let diagnostic = diagnostic.secondary(second.origin.span, "and here");
        Some(diagnostic.help("set only one of the two, or emit an image, which keeps the conflict"))
    })
}
