//! Builder for nets in tests, with the defaults from the declarations of primitives.

use rpi_diag::Span;
use rpi_image::desc::ShapeArgs;
use rpi_image::{Fallback, ParamType, PortType, Presence, Role, Scalar, Type, Value};
use rpi_net::{
    AbsentPolicy, Activation, Fragment, FragmentId, Input, Inputs, Net, Node, NodeId, Origin,
    PortRef, Restart, ResultKind, ResultPort, Termination,
};
use rpi_prims::PrimId;

/// Builder of a net for tests and benchmarks. Unconnected in-ports and missing parameters have the defaults of the
/// primitive. Wrong names and types cause a panic.
#[derive(Clone, Debug)]
pub struct NetBuilder {
    /// Net with the parts that have been added so far.
    pub net: Net,
}

impl NetBuilder {
    /// Creates a builder with an empty net of this name.
    #[must_use]
    pub fn new(name: &str) -> Self {
        NetBuilder {
            net: Net::new(name),
        }
    }

    /// Adds a node with the primitive named `prim` to a fragment. `inputs` are connected to its in-ports in declaration
    /// order; the other in-ports and the parameters have their defaults. Returns the first out-port of the node.
    ///
    /// # Panics
    /// Panics if the primitive does not exist, or the inputs do not fit it.
    pub fn add(&mut self, fragment: FragmentId, prim: &str, inputs: &[Input]) -> PortRef {
        self.add_with(fragment, prim, inputs, &[])
    }

    /// Adds a node like [`NetBuilder::add`], with values of parameters by their names.
    ///
    /// # Panics
    /// Panics if the primitive does not exist, or inputs or parameters do not fit it.
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

    /// Adds a node like [`NetBuilder::add_with`], with a name for the node.
    ///
    /// # Panics
    /// Panics if inputs or parameters do not fit the primitive.
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

    /// Adds a delay whose output is present from the first cycle on, with an in-port to be connected by
    /// [`NetBuilder::wire`]. Returns its out-port; `None` if no such delay exists for the type.
    pub fn total_delay(&mut self, fragment: FragmentId, scalar: Scalar) -> Option<PortRef> {
        let is_total_delay = |p: &rpi_prims::Prim| {
            p.desc.role == Role::Delay
                && p.desc.outputs[0].presence == Presence::IfAll
                && p.desc.outputs[0].ty == PortType::Scalar(scalar)
        };
        let prim = rpi_prims::registry().iter().find(|p| is_total_delay(p))?;
        Some(self.add(fragment, prim.desc.name, &[]))
    }

    /// Returns the type of an input of a node; `None` if it is not connected, or is a text.
    #[must_use]
    pub fn ty(&self, input: &Input) -> Option<Type> {
        match input {
            Input::Unconnected => None,
            Input::Const(value) => value.ty(),
            Input::Port(p) => Some(self.net.node(p.node).outputs[usize::from(p.port)]),
        }
    }

    /// Adds a fragment inside the fragment `parent`. It is active in the cycles in which the Boolean `when` is true.
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

    /// Connects in-port number `port` of an existing node to `source`. Used for feedback, where the source is added
    /// after the node that reads it.
    pub fn wire(&mut self, node: NodeId, port: usize, source: PortRef) {
        self.net.nodes[node.index()].inputs[port] = Input::Port(source);
    }

    /// Exports the real flow `source` under the name `key`.
    pub fn export(&mut self, key: &str, source: PortRef) {
        let params = [("Key", Value::Str(key.into()))];
        let inputs = [Input::Port(source)];
        self.add_with(FragmentId::ROOT, "Core::DoubleNetcommOut", &inputs, &params);
    }

    /// Adds a named result: the command ends with it in a cycle in which the Boolean `when` is true.
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

    /// Makes the command end in a cycle in which the Boolean `when` is true, without a named result.
    pub fn terminate(&mut self, when: PortRef) {
        self.net.termination = Termination::Ports {
            terminate: Some(Input::Port(when)),
            fail: None,
        };
    }
}

/// Returns a constant of type real as the input of a node.
#[must_use]
pub fn real(v: f64) -> Input {
    Input::constant(Value::real(v))
}

/// Returns a Boolean constant as the input of a node.
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
