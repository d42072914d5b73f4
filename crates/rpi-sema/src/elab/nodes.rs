//! Adds nodes to the net. A node whose result is known is folded instead.

use crate::elab::families::{Family, member};
use crate::elab::pack::natural;
use crate::elab::signal::{Given, Signal, Wire, alias, alias_of, single};
use crate::elab::{At, Elab, Mode, NotConstant};
use crate::typed::Leaf;
use rpi_diag::{Code, Finding, Span};
use rpi_image::{InPort, Need, PortDefault, PortType, Scalar, ShapeArgs, Type, Value};
use rpi_net::prim;
use rpi_net::{FragmentId, Input, Inputs, Node, NodeId, Origin, PortRef, Types};
use rpi_prims::{FaultCode, PrimId, fold};
use smallvec::smallvec;

impl Elab<'_> {
    /// Adds a primitive with its inputs connected (`None` if open) and all its parameters. Returns the leaves of its
    /// outputs.
    pub(in crate::elab) fn prim(
        &mut self,
        prim: PrimId,
        inputs: Vec<Option<Wire>>,
        params: Vec<Value>,
        at: At,
        span: Span,
    ) -> Wire {
        let shaped = |(port, wire): (&InPort, Option<Wire>)| {
            wire.map(|wire| (natural(port.ty, wire.len()), wire))
        };
        let inputs = prim.desc().inputs.iter().zip(inputs).map(shaped).collect();
        self.prim_shaped(prim, inputs, params, at, span)
    }

    /// Like [`prim`](Self::prim), for inputs whose types are known including sizes.
    pub(in crate::elab) fn prim_shaped(
        &mut self,
        prim: PrimId,
        inputs: Given,
        params: Vec<Value>,
        at: At,
        span: Span,
    ) -> Wire {
        let mut connected = Inputs::with_capacity(inputs.len());
        for (port, given) in prim.desc().inputs.iter().zip(inputs) {
            let input = match given {
                Some((ty, wire)) => self.input(&wire, ty, at, span),
                None => open(port.need, port.ty),
            };
            connected.push(input);
        }
        self.connected(prim, connected, params, at, span)
    }

    /// Adds a primitive whose inputs are ports or constants. Returns its folded result if that is constant.
    fn connected(
        &mut self,
        prim: PrimId,
        connected: Inputs,
        params: Vec<Value>,
        at: At,
        span: Span,
    ) -> Wire {
        let Some(outputs) = self.out_types(prim, &connected, &params) else {
            return self.no_sizes(prim, span);
        };
        if let Some(known) = self.folded(prim, &connected, &params, &outputs, at, span) {
            return known;
        }
        if self.mode == Mode::Constant {
            return self.fail(NotConstant::Flow(span));
        }
        let node = self.node(prim, connected, params, outputs, at.fragment, span);
        self.out_wire(node)
    }

    /// Adds a primitive with inputs of one leaf and one output.
    pub(in crate::elab) fn simple(
        &mut self,
        prim: PrimId,
        inputs: &[Signal],
        at: At,
        span: Span,
    ) -> Signal {
        let mut connected = Inputs::with_capacity(inputs.len());
        for (port, signal) in prim.desc().inputs.iter().zip(inputs) {
            let ty = natural(port.ty, 1);
            connected.push(self.input(std::slice::from_ref(signal), ty, at, span));
        }
        let wire = self.connected(prim, connected, default_params(prim), at, span);
        wire.first().cloned().unwrap_or(Signal::Absent)
    }

    /// Adds the member of a family for a value type.
    pub(in crate::elab) fn family(
        &mut self,
        family: Family,
        scalar: Scalar,
        inputs: &[Signal],
        at: At,
        span: Span,
    ) -> Signal {
        match member(family, scalar) {
            Some(prim) => self.simple(prim, inputs, at, span),
            None => Signal::Absent,
        }
    }

    /// Adds a node that copies its input. Returns the port itself if its type has no such primitive.
    pub(in crate::elab) fn passing_on(
        &mut self,
        port: PortRef,
        scalar: Scalar,
        fragment: FragmentId,
        span: Span,
    ) -> Signal {
        let Some(prim) = member(Family::Conditional, scalar) else {
            return Signal::Port(port);
        };
        let always = Input::constant(Value::bool(true));
        let inputs = smallvec![always, Input::Port(port), Input::Port(port)];
        let outputs = Types::from([Type::One(scalar)]);
        let node = self.node(prim, inputs, Vec::new(), outputs, fragment, span);
        Signal::Port(PortRef { node, port: 0 })
    }

    /// Adds a node.
    pub(in crate::elab) fn node(
        &mut self,
        prim: PrimId,
        inputs: Inputs,
        params: Vec<Value>,
        outputs: Types,
        fragment: FragmentId,
        span: Span,
    ) -> NodeId {
        let name = numbered(&self.name, self.serial);
        // Over budget, node 0 is returned so that the elaboration can finish. The error has been reported.
        if !self.may_add(&name, span) && !self.net.nodes.is_empty() {
            return NodeId(0);
        }
        self.serial += 1;
        self.net.add_node(Node {
            name,
            prim,
            fragment,
            inputs,
            params,
            outputs,
            origin: Origin { span, flow: None },
        })
    }

    /// Returns the leaves of a node's outputs.
    pub(in crate::elab) fn out_wire(&self, node: NodeId) -> Wire {
        let outputs = &self.net.node(node).outputs;
        if let [Type::One(_)] = outputs[..] {
            return single(Signal::Port(PortRef { node, port: 0 }));
        }
        let mut wire = Vec::new();
        for (port, ty) in (0..).zip(outputs) {
            let port = PortRef { node, port };
            match ty {
                Type::One(_) => wire.push(Signal::Port(port)),
                Type::Array(_, n) => wire.extend((0..*n).map(|k| Signal::Element(port, k))),
                Type::Matrix(rows, cols) => {
                    wire.extend((0..rows * cols).map(|k| Signal::Element(port, k)));
                }
            }
        }
        wire.into()
    }

    fn out_types(&self, prim: PrimId, inputs: &[Input], params: &[Value]) -> Option<Types> {
        let desc = prim.desc();
        let simple = desc.outputs.iter().map(|port| match port.ty {
            PortType::One(scalar) => Some(Type::One(scalar)),
            _ => None,
        });
        if let Some(types) = simple.collect::<Option<Types>>() {
            return Some(types);
        }
        let types: Vec<Option<Type>> = inputs.iter().map(|input| self.input_type(input)).collect();
        let args = ShapeArgs {
            inputs: &types,
            params,
        };
        (0..desc.outputs.len())
            .map(|port| desc.out_type(port, &args))
            .collect()
    }

    fn input_type(&self, input: &Input) -> Option<Type> {
        match input {
            Input::Open => None,
            Input::Const(value) => value.ty(),
            Input::Port(port) if alias_of(*port).is_some() => self.promised_type(*port),
            Input::Port(port) => self
                .net
                .node(port.node)
                .outputs
                .get(usize::from(port.port))
                .copied(),
        }
    }

    fn no_sizes(&mut self, prim: PrimId, span: Span) -> Wire {
        let finding = Finding::new(
            Code::RPI2009,
            format!("size mismatch in the arguments of `{}`", prim.desc().name),
        )
        .at(
            span,
            "cannot infer the size of the result from these arguments",
        );
        self.findings.push(finding);
        self.fail(NotConstant::Faulty)
    }

    /// Returns the folded result if all inputs are constant and the primitive can be folded.
    fn folded(
        &mut self,
        prim: PrimId,
        inputs: &[Input],
        params: &[Value],
        outputs: &[Type],
        at: At,
        span: Span,
    ) -> Option<Wire> {
        let constant = |input: &Input| matches!(input, Input::Const(_));
        if !inputs.iter().all(constant) {
            return None;
        }
        let values = inputs.iter().filter_map(|input| match input {
            Input::Const(value) => Some(&**value),
            _ => None,
        });
        let values: Vec<&Value> = values.collect();
        match fold(prim, &values, params, outputs)? {
            Ok(results) => Some(results.iter().flat_map(leaves).map(Signal::Const).collect()),
            Err(fault) => {
                self.constant_fault(fault, at, span);
                None
            }
        }
    }

    /// Reports a fault that occurs in every cycle. Under a guard it may never be reached, so it is not reported.
    fn constant_fault(&mut self, fault: FaultCode, at: At, span: Span) {
        if at.guard.is_some() {
            return;
        }
        self.certain_fault(fault_text(fault).to_owned(), span);
    }

    pub(in crate::elab) fn certain_fault(&mut self, what: String, span: Span) {
        match self.mode {
            Mode::Constant => {
                self.fail(NotConstant::Fault(span, what));
            }
            Mode::Net | Mode::Whole | Mode::Steps => self
                .findings
                .push(Finding::new(Code::RPI2010, what).at(span, "in every cycle")),
        }
    }

    /// Reserves memory for `more` aliases.
    pub(in crate::elab) fn expect_aliases(&mut self, more: usize) {
        self.aliases.reserve(more);
        self.alias_types.reserve(more);
        self.settling.reserve(more);
    }

    /// Creates an alias for a flow of a machine type.
    pub(in crate::elab) fn new_alias(&mut self, scalar: Scalar) -> PortRef {
        self.aliases.push(None);
        self.alias_types.push(scalar);
        self.settling.push(false);
        alias(self.aliases.len() - 1)
    }

    /// Returns the signal `first` of a fragment.
    pub(in crate::elab) fn first(&mut self, fragment: FragmentId, span: Span) -> Signal {
        if let Some(port) = self.firsts.get(&fragment) {
            return Signal::Port(*port);
        }
        let signal = self.simple(prim!("Rpi::First"), &[], At::fragment(fragment), span);
        if let Signal::Port(port) = signal {
            self.firsts.insert(fragment, port);
        }
        signal
    }
}

/// Formats `name#serial`. Written by hand because every node gets such a name and formatting is slow.
fn numbered(name: &str, serial: u32) -> String {
    let digits = serial.checked_ilog10().unwrap_or(0);
    let digit = |k| char::from_digit(serial / 10_u32.pow(k) % 10, 10);
    let mut text = String::with_capacity(name.len() + digits as usize + 2);
    text.push_str(name);
    text.push('#');
    text.extend((0..=digits).rev().filter_map(digit));
    text
}

/// Returns the defaults of all parameters of a primitive.
pub(in crate::elab) fn default_params(prim: PrimId) -> Vec<Value> {
    prim.desc()
        .params
        .iter()
        .filter_map(crate::check::param_default)
        .collect()
}

/// Returns the input of an unconnected port: its default, or open.
fn open(need: Need, ty: PortType) -> Input {
    let PortType::One(scalar) = ty else {
        return Input::Open;
    };
    match need {
        Need::Param(_, default) => default_input(default, scalar),
        Need::Params(parts, make) => {
            let reals: Vec<f64> = parts.iter().map(|(_, default)| *default).collect();
            Input::constant(make(&reals))
        }
        Need::Required | Need::Absent => Input::Open,
    }
}

fn default_input(default: PortDefault, scalar: Scalar) -> Input {
    default
        .value(Type::One(scalar))
        .map_or(Input::Open, Input::constant)
}

/// Splits a value into its leaves, the elements of an array.
pub(in crate::elab) fn leaves(value: &Value) -> Vec<Leaf> {
    let (scalar, count) = match value.ty() {
        None | Some(Type::One(_)) => return vec![value.clone()],
        Some(Type::Array(scalar, n)) => (scalar, n),
        Some(Type::Matrix(rows, cols)) => (Scalar::Real, rows * cols),
    };
    let element = |cells: &[u64]| Value::Cells {
        ty: Type::One(scalar),
        cells: cells.into(),
    };
    let chunks = value.cells().chunks(scalar.cells() as usize);
    chunks.take(count as usize).map(element).collect()
}

fn fault_text(fault: FaultCode) -> &'static str {
    match fault {
        FaultCode::IntegerOverflow => "the result does not fit into 64 bits",
        FaultCode::DivisionByZero => "division by zero",
        FaultCode::LossyConversion => "the real number cannot be converted to `int`",
        FaultCode::IndexOutOfRange => "the index is out of bounds",
        FaultCode::OutsideSubrange => "the value is outside its subrange",
        FaultCode::ShapeMismatch => "size mismatch",
        _ => "this expression cannot be evaluated",
    }
}
