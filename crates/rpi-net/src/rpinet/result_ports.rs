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

/// Returns a copy of an analysed net in which ports and primitives replace results and exports, which the text form
/// does not have. The diagnostics report everything that cannot be replaced.
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

/// Converter of results and exports to ports and primitives: the changed net, and the analyses that it needs.
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

    /// Returns the condition under which the command ends with a result. A `yield` also needs a successor.
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

    /// Returns a Boolean with the value of `condition`, and false in cycles in which `condition` is absent.
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

    /// Adds a node with the primitive `name` to the root fragment, and returns its first out-port as a source.
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

    /// Adds a node with the primitive `prim` to the root fragment. Its parameters have their defaults, except `Key`,
    /// which is set to `key`.
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

/// Returns diagnostics for declared execution time budgets, which a `.rpinet` file cannot express.
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
            .help("use the image (`rpic compile` without `--emit`) to keep it, or delete the budget if the text is enough")
    })
}

/// Returns a diagnostic if flows of several clocks depend on one another, so that the net has a dependency cycle as a
/// `.rpinet` file; `None` otherwise.
///
/// In such a file, all operations of a condition are evaluated in one step.
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
    let mut diagnostic = Diagnostic::new(Code::RPI9102, message);
    diagnostic.labels = ring.labels;
    for (k, label) in diagnostic.labels.iter_mut().enumerate() {
        label.text = match k {
            0 => "depends on itself through the clocks of the flows",
            _ => "also on the dependency cycle",
        }
        .to_owned();
    }
    Some(
        diagnostic
            .note("in a net, all flows of one clock are computed in one step")
            .help("use the image (`rpic compile` without `--emit`), in which each flow is a step of its own, or compute these flows in all cycles by `if` instead of `when`"),
    )
}

/// Returns diagnostics for pairs of written device ports that drive the same actuator, which a `.rpinet` file cannot
/// express. The reference system knows such ports of arms.
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
            "a `.rpinet` net allows both `{device}.{a}` and `{device}.{b}` in one cycle"
        );
        let diagnostic =
            Diagnostic::new(Code::RPI9102, message).primary(first.origin.span, "set here");
        let diagnostic = diagnostic.secondary(second.origin.span, "the same actuator, also set here");
        Some(diagnostic.help("set only one of the two ports, or use the image (`rpic compile` without `--emit`), which allows only one of them per cycle"))
    })
}
