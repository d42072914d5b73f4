//! Conversion of primitives to equations.

use rpi_image::{Fallback, PortDefault, PortType, PrimDesc, Role, Scalar, Type, Value};
use rpi_net::{FragmentId, Input, Node, NodeId, PortRef};

use super::{Writer, operators, values};

impl Writer<'_> {
    /// Returns the type declaration of a node that is a delay, `None` for other nodes. A delay in a dependency cycle
    /// needs a declaration, because the type cannot be inferred there.
    pub(super) fn declaration(&self, id: NodeId) -> Option<String> {
        let node = self.net.node(id);
        let [ty] = node.outputs[..] else { return None };
        is_delay(node).then(|| format!("{}: {}?;\n", self.names.node(id), type_text(ty)))
    }

    pub(super) fn equation(&self, id: NodeId) -> String {
        let node = self.net.node(id);
        let (name, value) = (self.names.node(id), self.value(node));
        // The original name is kept as a comment if it is not valid here.
        let own = match node.name == name.trim_start_matches('_') {
            true => String::new(),
            false => format!(" -- {}", node.name),
        };
        format!("{name} = {value};{own}\n")
    }

    /// Returns the expression that computes the value of a node, as read in its own fragment.
    fn value(&self, node: &Node) -> String {
        let operator = self.operands(node);
        let operator =
            operator.and_then(|given| operators::operator_expr(node.desc().name, &given));
        operator.unwrap_or_else(|| self.call(node))
    }

    /// Returns the sources of all in-ports as expressions, so that the node can be written as an operator; `None` if an
    /// in-port has no source. Returns `None` also for a selection with a constant condition or constant branches, which
    /// the compiler would fold.
    fn operands(&self, node: &Node) -> Option<Vec<String>> {
        let is_flow = |input: &Input| self.constant(input).is_none();
        if let [condition, branches @ ..] = &node.inputs[..]
            && branches.len() > 1
            && !(is_flow(condition) && branches.iter().any(is_flow))
        {
            return None;
        }
        let mut inputs = node.inputs.iter();
        inputs.try_fold(Vec::new(), |mut texts, input| {
            texts.push(self.source(input, node.fragment)?);
            Some(texts)
        })
    }

    /// Returns the constant that an in-port reads, directly or from a constant node without an equation; `None` if the
    /// in-port reads no constant.
    pub(super) fn constant<'v>(&'v self, input: &'v Input) -> Option<&'v Value> {
        match input {
            Input::Unconnected => None,
            Input::Const(value) => Some(value),
            Input::Port(port) if self.constants.contains(&port.node) => {
                self.net.node(port.node).params.first()
            }
            Input::Port(_) => None,
        }
    }

    fn call(&self, node: &Node) -> String {
        let desc = node.desc();
        let params = desc.params.iter().zip(&node.params);
        let params = params
            .filter(|(param, value)| !is_default(param.default, value))
            .map(|(param, value)| format!("{}: {}", param.name, values::value(value)));
        let params: Vec<String> = params.collect();
        let statics = match params.is_empty() {
            true => String::new(),
            false => format!("<<{}>>", params.join(", ")),
        };
        format!("{}{statics}({})", desc.name, self.arguments(node, desc))
    }

    fn arguments(&self, node: &Node, desc: &PrimDesc) -> String {
        let given = desc.inputs.iter().zip(&node.inputs);
        let given = given
            .filter(|(port, input)| !is_port_default(port.fallback, port.ty, input))
            .filter_map(|(port, input)| {
                let source = self.source(input, node.fragment)?;
                Some(format!("{}: {source}", port.name))
            });
        given.collect::<Vec<String>>().join(", ")
    }

    /// Returns the source of an in-port as an expression in the fragment `at`; `None` if the in-port is not connected.
    pub(super) fn source(&self, input: &Input, at: FragmentId) -> Option<String> {
        match (self.constant(input), input) {
            (Some(value), _) => Some(values::value(value)),
            (None, Input::Port(port)) => Some(self.flow(*port, at)),
            (None, _) => None,
        }
    }

    /// Returns the expression by which the fragment `at` reads an out-port: a name with the path to it, a literal or a
    /// selection.
    pub(super) fn flow(&self, port: PortRef, at: FragmentId) -> String {
        if let Some(value) = self.constant(&Input::Port(port)) {
            return values::value(value);
        }
        let node = self.net.node(port.node);
        if self.choices.contains(&port.node) {
            return self.value(node);
        }
        let path = self.fragment_path(node.fragment);
        let around = self.fragment_path(at);
        let shared = path.iter().zip(&around).take_while(|(a, b)| a == b).count();
        let mut parts = path[shared..].to_vec();
        parts.push(self.names.node(port.node));
        if let (true, Some(out)) = (
            node.outputs.len() > 1,
            node.desc().outputs.get(usize::from(port.port)),
        ) {
            parts.push(out.name);
        }
        parts.join(".")
    }
}

/// Returns whether a node is a delay: its output depends on its input in an earlier cycle.
pub(super) fn is_delay(node: &Node) -> bool {
    matches!(node.desc().role, Role::Delay)
}

fn is_default(default: PortDefault, value: &Value) -> bool {
    let ty = value.ty().unwrap_or(Type::Scalar(Scalar::Bool));
    default.value(ty).as_ref() == Some(value)
}

/// Returns whether the constant at an in-port equals the default of the in-port, so that the argument can be omitted.
fn is_port_default(need: Fallback, ty: PortType, input: &Input) -> bool {
    let Input::Const(value) = input else {
        return false;
    };
    match (need, ty) {
        (Fallback::Param(_, default), PortType::Scalar(_)) => is_default(default, value),
        (Fallback::ComposedOfParams(parts, make), _) => {
            let reals: Vec<f64> = parts.iter().map(|(_, default)| *default).collect();
            make(&reals) == **value
        }
        _ => false,
    }
}

fn type_text(ty: Type) -> String {
    let name = |scalar: Scalar| match scalar {
        Scalar::Bool => "bool",
        Scalar::Int => "int",
        Scalar::Real => "real",
        other => other.name(),
    };
    match ty {
        Type::Scalar(scalar) => name(scalar).to_owned(),
        Type::Array(scalar, n) => format!("{}^{n}", name(scalar)),
        Type::Matrix(rows, cols) => format!("real^{cols}^{rows}"),
    }
}
