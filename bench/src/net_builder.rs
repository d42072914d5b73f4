//! Builder for nets in tests, with the defaults from the declarations of primitives.

use rpi_diag::Span;
use rpi_image::desc::ShapeArgs;
use rpi_image::{Fallback, ParamType, PortType, Presence, Role, Scalar, Type, Value};
use rpi_net::{
    AbsentPolicy, Activation, Fragment, FragmentId, Input, Inputs, Net, Node, NodeId, Origin,
    PortRef, Restart, ResultKind, ResultPort, Termination,
};
use rpi_prims::PrimId;

/// A net under construction. Wrong names and types cause a panic, because the builder is for tests only.
#[derive(Clone, Debug)]
pub struct NetBuilder {
    /// The net as built so far.
    pub net: Net,
}

impl NetBuilder {
    /// An empty net.
    #[must_use]
    pub fn new(name: &str) -> Self {
        NetBuilder {
            net: Net::new(name),
        }
    }

    /// Adds a node. `inputs` are connected to its in-ports in declaration order; the other in-ports and the parameters
    /// take their defaults. Returns its first out-port.
    ///
    /// # Panics
    /// If the primitive does not exist, or the inputs do not match it.
    pub fn add(&mut self, fragment: FragmentId, prim: &str, inputs: &[Input]) -> PortRef {
        self.add_with(fragment, prim, inputs, &[])
    }

    /// Adds a node with parameters by name; see [`NetBuilder::add`].
    ///
    /// # Panics
    /// If the primitive does not exist, or inputs or parameters do not match it.
    pub fn add_with(
        &mut self,
        fragment: FragmentId,
        prim: &str,
        inputs: &[Input],
        params: &[(&str, Value)],
    ) -> PortRef {
        let id = PrimId::from_name(prim).unwrap_or_else(|| panic!("no primitive {prim}"));
        let name = format!("n{}", self.net.nodes.len());
        self.node(fragment, &name, id, inputs, params)
    }

    /// Adds a node with a name; see [`NetBuilder::add_with`].
    ///
    /// # Panics
    /// If inputs or parameters do not match the primitive.
    pub fn node(
        &mut self,
        fragment: FragmentId,
        name: &str,
        prim: PrimId,
        inputs: &[Input],
        params: &[(&str, Value)],
    ) -> PortRef {
        let desc = prim.desc();
        let param = |name: &str| params.iter().find(|p| p.0 == name).map(|p| p.1.clone());
        let params: Vec<Value> = desc
            .params
            .iter()
            .map(|p| param(p.name).unwrap_or_else(|| default_param(p)))
            .collect();
        let connected = |k: usize| inputs.get(k).cloned();
        let inputs: Inputs = (0..desc.inputs.len())
            .map(|k| connected(k).unwrap_or_else(|| default_input(&desc.inputs[k])))
            .collect();
        let types: Vec<Option<Type>> = inputs.iter().map(|i| self.ty(i)).collect();
        let args = ShapeArgs {
            inputs: &types,
            params: &params,
        };
        let outputs = (0..desc.outputs.len())
            .map(|k| desc.out_type(k, &args).expect("sizes fit"))
            .collect();
        let node = self.net.add_node(Node {
            name: name.into(),
            prim,
            fragment,
            inputs,
            params,
            outputs,
            origin: nowhere(),
        });
        PortRef { node, port: 0 }
    }

    /// Adds a delay that is present from its first cycle on, to be connected later. `None` if no such delay exists for
    /// the type.
    pub fn total_delay(&mut self, fragment: FragmentId, scalar: Scalar) -> Option<PortRef> {
        let is_total_delay = |p: &rpi_prims::Prim| {
            p.desc.role == Role::Delay
                && p.desc.outputs[0].presence == Presence::IfAll
                && p.desc.outputs[0].ty == PortType::Scalar(scalar)
        };
        let prim = rpi_prims::registry().iter().find(|p| is_total_delay(p))?;
        Some(self.add(fragment, prim.desc.name, &[]))
    }

    /// Type of an input; `None` if it is open or has no type.
    #[must_use]
    pub fn ty(&self, input: &Input) -> Option<Type> {
        match input {
            Input::Unconnected => None,
            Input::Const(value) => value.ty(),
            Input::Port(p) => Some(self.net.node(p.node).outputs[usize::from(p.port)]),
        }
    }

    /// Adds a fragment inside `parent` that is active while `when` is true.
    pub fn fragment(
        &mut self,
        parent: FragmentId,
        name: &str,
        when: PortRef,
        restart: Restart,
    ) -> FragmentId {
        self.net.add_fragment(Fragment {
            name: name.into(),
            parent: Some(parent),
            activation: Activation::When {
                condition: when,
                if_absent: AbsentPolicy::Inactive,
            },
            restart,
            is_clock: false,
            inputs: Vec::new(),
            outputs: Vec::new(),
            budget_ns: None,
            origin: nowhere(),
        })
    }

    /// Connects an in-port of a node that has been added already. Used for feedback, where the source is added after
    /// the reader.
    pub fn wire(&mut self, node: NodeId, port: usize, source: PortRef) {
        self.net.nodes[node.index()].inputs[port] = Input::Port(source);
    }

    /// Exports a real under `key`.
    pub fn export(&mut self, key: &str, source: PortRef) {
        let params = [("Key", Value::Str(key.into()))];
        let inputs = [Input::Port(source)];
        self.add_with(FragmentId::ROOT, "Core::DoubleNetcommOut", &inputs, &params);
    }

    /// Adds a named result.
    pub fn result(&mut self, name: &str, kind: ResultKind, when: PortRef) {
        let result = ResultPort {
            name: name.into(),
            kind,
            condition: Input::Port(when),
            origin: nowhere(),
        };
        match &mut self.net.termination {
            Termination::Results(results) => results.push(result),
            Termination::Ports { .. } => self.net.termination = Termination::Results(vec![result]),
        }
    }

    /// Ends the command when `when` is true.
    pub fn terminate(&mut self, when: PortRef) {
        self.net.termination = Termination::Ports {
            terminate: Some(Input::Port(when)),
            fail: None,
        };
    }
}

/// A real constant as an input.
#[must_use]
pub fn real(v: f64) -> Input {
    Input::constant(Value::real(v))
}

/// A Boolean constant as an input.
#[must_use]
pub fn boolean(v: bool) -> Input {
    Input::constant(Value::bool(v))
}

fn nowhere() -> Origin {
    Origin {
        span: Span::NONE,
        flow: None,
    }
}

fn default_param(p: &rpi_image::Param) -> Value {
    let ty = match p.ty {
        ParamType::Scalar(s) => Type::Scalar(s),
        ParamType::Array(s) => Type::Array(s, 0),
        ParamType::Str => {
            return p
                .default
                .value(Type::Scalar(Scalar::Bool))
                .unwrap_or(Value::Str(String::new()));
        }
    };
    p.default.value(ty).unwrap_or_else(|| Value::neutral(ty))
}

fn default_input(p: &rpi_image::InPort) -> Input {
    match (p.fallback, p.ty) {
        (Fallback::Param(_, default), PortType::Scalar(s)) => {
            Input::constant(default.value(Type::Scalar(s)).expect("a default"))
        }
        (Fallback::ComposedOfParams(names, make), _) => {
            Input::constant(make(&names.iter().map(|n| n.1).collect::<Vec<_>>()))
        }
        _ => Input::Unconnected,
    }
}
