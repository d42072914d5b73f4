//! Adds nodes to the net. A node whose result is known is folded instead.

use crate::elab::arrays;
use crate::elab::arrays::natural;
use crate::elab::deferred_arrays;
use crate::elab::node_budget;
use crate::elab::primitive_family::Family;
use crate::elab::primitive_family::member;
use crate::elab::signal::{Given, Signal, Wire, alias, alias_of, single};
use crate::elab::{At, Elab, Mode, NotConstant};
use crate::typed::Leaf;
use rpi_diag::{Code, Finding, Span};
use rpi_image::{InPort, Need, PortDefault, PortType, Scalar, ShapeArgs, Type, Value};
use rpi_net::prim;
use rpi_net::{FragmentId, Input, Inputs, Node, NodeId, Origin, PortRef, Types};
use rpi_prims::{FaultCode, PrimId, fold};
use smallvec::smallvec;

/// Adds a primitive with its inputs connected (`None` if open) and all its parameters. Returns the leaves of its
/// outputs.
pub(super) fn add_prim(
    elab: &mut Elab<'_>,
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
    add_prim_typed(elab, prim, inputs, params, at, span)
}

/// Like [`prim`](Self::prim), for inputs whose types are known including sizes.
pub(super) fn add_prim_typed(
    elab: &mut Elab<'_>,
    prim: PrimId,
    inputs: Given,
    params: Vec<Value>,
    at: At,
    span: Span,
) -> Wire {
    let mut connected = Inputs::with_capacity(inputs.len());
    for (port, given) in prim.desc().inputs.iter().zip(inputs) {
        let input = match given {
            Some((ty, wire)) => arrays::elab_input(elab, &wire, ty, at, span),
            None => open(port.need, port.ty),
        };
        connected.push(input);
    }
    add_connected(elab, prim, connected, params, at, span)
}

/// Adds a primitive whose inputs are ports or constants. Returns its folded result if that is constant.
fn add_connected(
    elab: &mut Elab<'_>,
    prim: PrimId,
    connected: Inputs,
    params: Vec<Value>,
    at: At,
    span: Span,
) -> Wire {
    let Some(outputs) = out_types(elab, prim, &connected, &params) else {
        return report_unknown_size(elab, prim, span);
    };
    if let Some(known) = try_fold(elab, prim, &connected, &params, &outputs, at, span) {
        return known;
    }
    if elab.mode == Mode::Constant {
        return elab.fail(NotConstant::Flow(span));
    }
    let node = add_node(elab, prim, connected, params, outputs, at.fragment, span);
    out_wire(elab, node)
}

/// Adds a primitive with inputs of one leaf and one output.
pub(super) fn add_simple(
    elab: &mut Elab<'_>,
    prim: PrimId,
    inputs: &[Signal],
    at: At,
    span: Span,
) -> Signal {
    let mut connected = Inputs::with_capacity(inputs.len());
    for (port, signal) in prim.desc().inputs.iter().zip(inputs) {
        let ty = natural(port.ty, 1);
        connected.push(arrays::elab_input(
            elab,
            std::slice::from_ref(signal),
            ty,
            at,
            span,
        ));
    }
    let wire = add_connected(elab, prim, connected, default_params(prim), at, span);
    wire.first().cloned().unwrap_or(Signal::Absent)
}

/// Adds the member of a family for a value type.
pub(super) fn add_family_member(
    elab: &mut Elab<'_>,
    family: Family,
    scalar: Scalar,
    inputs: &[Signal],
    at: At,
    span: Span,
) -> Signal {
    match member(family, scalar) {
        Some(prim) => add_simple(elab, prim, inputs, at, span),
        None => Signal::Absent,
    }
}

/// Adds a node that copies its input. Returns the port itself if its type has no such primitive.
pub(super) fn add_copy(
    elab: &mut Elab<'_>,
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
    let node = add_node(elab, prim, inputs, Vec::new(), outputs, fragment, span);
    Signal::Port(PortRef { node, port: 0 })
}

/// Adds a node.
pub(super) fn add_node(
    elab: &mut Elab<'_>,
    prim: PrimId,
    inputs: Inputs,
    params: Vec<Value>,
    outputs: Types,
    fragment: FragmentId,
    span: Span,
) -> NodeId {
    let name = numbered(&elab.naming.name, elab.naming.serial);
    // Over budget, node 0 is returned so that the elaboration can finish. The error has been reported.
    if !node_budget::charge_node(elab, &name, span) && !elab.net.nodes.is_empty() {
        return NodeId(0);
    }
    elab.naming.serial += 1;
    elab.net.add_node(Node {
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
pub(super) fn out_wire(elab: &Elab<'_>, node: NodeId) -> Wire {
    let outputs = &elab.net.node(node).outputs;
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

fn out_types(elab: &Elab<'_>, prim: PrimId, inputs: &[Input], params: &[Value]) -> Option<Types> {
    let desc = prim.desc();
    let simple = desc.outputs.iter().map(|port| match port.ty {
        PortType::One(scalar) => Some(Type::One(scalar)),
        _ => None,
    });
    if let Some(types) = simple.collect::<Option<Types>>() {
        return Some(types);
    }
    let types: Vec<Option<Type>> = inputs.iter().map(|input| input_type(elab, input)).collect();
    let args = ShapeArgs {
        inputs: &types,
        params,
    };
    (0..desc.outputs.len())
        .map(|port| desc.out_type(port, &args))
        .collect()
}

fn input_type(elab: &Elab<'_>, input: &Input) -> Option<Type> {
    match input {
        Input::Open => None,
        Input::Const(value) => value.ty(),
        Input::Port(port) if alias_of(*port).is_some() => {
            deferred_arrays::deferred_type(elab, *port)
        }
        Input::Port(port) => elab
            .net
            .node(port.node)
            .outputs
            .get(usize::from(port.port))
            .copied(),
    }
}

fn report_unknown_size(elab: &mut Elab<'_>, prim: PrimId, span: Span) -> Wire {
    let finding = Finding::new(
        Code::RPI2009,
        format!("size mismatch in the arguments of `{}`", prim.desc().name),
    )
    .at(
        span,
        "cannot infer the size of the result from these arguments",
    );
    elab.findings.push(finding);
    elab.fail(NotConstant::Faulty)
}

/// Returns the folded result if all inputs are constant and the primitive can be folded.
fn try_fold(
    elab: &mut Elab<'_>,
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
            report_constant_fault(elab, fault, at, span);
            None
        }
    }
}

/// Reports a fault that occurs in every cycle. Under a guard it may never be reached, so it is not reported.
fn report_constant_fault(elab: &mut Elab<'_>, fault: FaultCode, at: At, span: Span) {
    if at.guard.is_some() {
        return;
    }
    report_certain_fault(elab, fault_text(fault).to_owned(), span);
}

pub(super) fn report_certain_fault(elab: &mut Elab<'_>, what: String, span: Span) {
    match elab.mode {
        Mode::Constant => {
            elab.fail(NotConstant::Fault(span, what));
        }
        Mode::Net | Mode::Whole | Mode::Steps => elab
            .findings
            .push(Finding::new(Code::RPI2010, what).at(span, "in every cycle")),
    }
}

/// Reserves memory for `more` aliases.
pub(super) fn reserve_aliases(elab: &mut Elab<'_>, more: usize) {
    elab.aliases.signals.reserve(more);
    elab.aliases.types.reserve(more);
    elab.aliases.in_progress.reserve(more);
}

/// Creates an alias for a flow of a machine type.
pub(super) fn new_alias(elab: &mut Elab<'_>, scalar: Scalar) -> PortRef {
    elab.aliases.signals.push(None);
    elab.aliases.types.push(scalar);
    elab.aliases.in_progress.push(false);
    alias(elab.aliases.signals.len() - 1)
}

/// Returns the signal `first` of a fragment.
pub(super) fn first_port(elab: &mut Elab<'_>, fragment: FragmentId, span: Span) -> Signal {
    if let Some(port) = elab.cache.firsts.get(&fragment) {
        return Signal::Port(*port);
    }
    let signal = add_simple(elab, prim!("Rpi::First"), &[], At::fragment(fragment), span);
    if let Signal::Port(port) = signal {
        elab.cache.firsts.insert(fragment, port);
    }
    signal
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
pub(super) fn default_params(prim: PrimId) -> Vec<Value> {
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
pub(super) fn leaves(value: &Value) -> Vec<Leaf> {
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
