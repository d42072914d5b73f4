//! Adds nodes to the net. A node whose result is known is folded instead.

use crate::elab::arrays;
use crate::elab::arrays::default_port_type;
use crate::elab::deferred_arrays;
use crate::elab::node_budget;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::primitive_family::member;
use crate::elab::signal::{PrimInputs, Signal, Wire, alias_of, resolve_alias, single_wire};
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::typed::Leaf;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::{Fallback, InPort, PortDefault, PortType, Scalar, ShapeArgs, Type, Value};
use rpi_net::prim;
use rpi_net::{FragmentId, Input, Inputs, Node, NodeId, Origin, PortRef, Types};
use rpi_prims::{FaultCode, PrimId, fold};
use smallvec::smallvec;

/// Adds a primitive to the net with its inputs (`None` for an unconnected one) and the values of all its parameters.
/// Returns the signals of its outputs.
pub(super) fn add_prim(
    elab: &mut Elaborator<'_>,
    prim: PrimId,
    inputs: Vec<Option<Wire>>,
    params: Vec<Value>,
    at: Position,
    span: Span,
) -> Wire {
    let shaped = |(port, wire): (&InPort, Option<Wire>)| {
        wire.map(|wire| (default_port_type(port.ty, wire.len()), wire))
    };
    let inputs = prim.desc().inputs.iter().zip(inputs).map(shaped).collect();
    add_prim_typed(elab, prim, inputs, params, at, span)
}

/// Adds a primitive to the net whose inputs have known types, including array sizes. Returns the signals of its
/// outputs.
pub(super) fn add_prim_typed(
    elab: &mut Elaborator<'_>,
    prim: PrimId,
    inputs: PrimInputs,
    params: Vec<Value>,
    at: Position,
    span: Span,
) -> Wire {
    let mut connected = Inputs::with_capacity(inputs.len());
    for (port, given) in prim.desc().inputs.iter().zip(inputs) {
        let input = match given {
            Some((ty, wire)) => arrays::elab_input(elab, &wire, ty, at, span),
            None => unconnected_input(port.fallback, port.ty),
        };
        connected.push(input);
    }
    add_connected(elab, prim, connected, params, at, span)
}

/// Adds a primitive to the net whose inputs are ports or constants, and returns the signals of its outputs. If the
/// result is constant, it is computed and no node is added.
fn add_connected(
    elab: &mut Elaborator<'_>,
    prim: PrimId,
    connected: Inputs,
    params: Vec<Value>,
    at: Position,
    span: Span,
) -> Wire {
    let Some(outputs) = out_types(elab, prim, &connected, &params) else {
        return report_unknown_size(elab, prim, span);
    };
    if let Some(known) = try_fold(elab, prim, &connected, &params, &outputs, at, span) {
        return known;
    }
    if elab.mode == ElabMode::Constant {
        return elab.fail(NotConstantError::RunTime(span));
    }
    let node = add_node(elab, prim, connected, params, outputs, at.fragment, span);
    out_wire(elab, node)
}

/// Adds a primitive to the net that has scalar inputs and one output, and returns the signal of the output.
pub(super) fn add_simple(
    elab: &mut Elaborator<'_>,
    prim: PrimId,
    inputs: &[Signal],
    at: Position,
    span: Span,
) -> Signal {
    let mut connected = Inputs::with_capacity(inputs.len());
    for (port, signal) in prim.desc().inputs.iter().zip(inputs) {
        let ty = default_port_type(port.ty, 1);
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

/// Adds the primitive that a family of primitives, such as `Conditional`, has for a type of values, and returns the
/// signal of its output.
pub(super) fn add_family_member(
    elab: &mut Elaborator<'_>,
    family: PrimitiveFamily,
    scalar: Scalar,
    inputs: &[Signal],
    at: Position,
    span: Span,
) -> Signal {
    match member(family, scalar) {
        Some(prim) => add_simple(elab, prim, inputs, at, span),
        None => Signal::Absent,
    }
}

/// Adds a net node that copies its input, and returns its output. Returns the port itself if there is no such primitive
/// for its type.
pub(super) fn add_copy(
    elab: &mut Elaborator<'_>,
    port: PortRef,
    scalar: Scalar,
    fragment: FragmentId,
    span: Span,
) -> Signal {
    let Some(prim) = member(PrimitiveFamily::Conditional, scalar) else {
        return Signal::Port(port);
    };
    let always = Input::constant(Value::bool(true));
    let inputs = smallvec![always, Input::Port(port), Input::Port(port)];
    let outputs = Types::from([Type::Scalar(scalar)]);
    let node = add_node(elab, prim, inputs, Vec::new(), outputs, fragment, span);
    Signal::Port(PortRef { node, port: 0 })
}

/// Adds a node with a primitive to a fragment of the net and returns its identifier.
pub(super) fn add_node(
    elab: &mut Elaborator<'_>,
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

/// Returns the signals of all outputs of a net node, leaf by leaf (scalar part).
pub(super) fn out_wire(elab: &Elaborator<'_>, node: NodeId) -> Wire {
    let outputs = &elab.net.node(node).outputs;
    if let [Type::Scalar(_)] = outputs[..] {
        return single_wire(Signal::Port(PortRef { node, port: 0 }));
    }
    let mut wire = Vec::new();
    for (port, ty) in (0..).zip(outputs) {
        let port = PortRef { node, port };
        match ty {
            Type::Scalar(_) => wire.push(Signal::Port(port)),
            Type::Array(_, n) => wire.extend((0..*n).map(|k| Signal::Element(port, k))),
            Type::Matrix(rows, cols) => {
                wire.extend((0..rows * cols).map(|k| Signal::Element(port, k)));
            }
        }
    }
    wire.into()
}

fn out_types(
    elab: &Elaborator<'_>,
    prim: PrimId,
    inputs: &[Input],
    params: &[Value],
) -> Option<Types> {
    let desc = prim.desc();
    let simple = desc.outputs.iter().map(|port| match port.ty {
        PortType::Scalar(scalar) => Some(Type::Scalar(scalar)),
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

fn input_type(elab: &Elaborator<'_>, input: &Input) -> Option<Type> {
    match input {
        Input::Unconnected => None,
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

fn report_unknown_size(elab: &mut Elaborator<'_>, prim: PrimId, span: Span) -> Wire {
    let diagnostic = Diagnostic::new(
        Code::RPI2009,
        format!("size mismatch in the arguments of `{}`", prim.desc().name),
    )
    .primary(
        span,
        "cannot infer the size of the result from these arguments",
    );
    elab.diagnostics.push(diagnostic);
    elab.fail(NotConstantError::Reported)
}

/// Returns the constant result of a primitive if all its inputs are constant and it can be evaluated at compile time;
/// `None` otherwise. Reports a fault in the evaluation.
fn try_fold(
    elab: &mut Elaborator<'_>,
    prim: PrimId,
    inputs: &[Input],
    params: &[Value],
    outputs: &[Type],
    at: Position,
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

/// Reports a fault that occurs in every cycle in which the operation runs. Under a guard the operation may never run,
/// so that the fault is not reported.
fn report_constant_fault(elab: &mut Elaborator<'_>, fault: FaultCode, at: Position, span: Span) {
    if at.guard.is_some() {
        return;
    }
    report_certain_fault(elab, fault_text(fault).to_owned(), span);
}

pub(super) fn report_certain_fault(elab: &mut Elaborator<'_>, what: String, span: Span) {
    match elab.mode {
        ElabMode::Constant => {
            elab.fail(NotConstantError::Fault(span, what));
        }
        ElabMode::Net | ElabMode::Dependencies | ElabMode::DependencySteps => {
            let diagnostic =
                Diagnostic::new(Code::RPI2010, what).primary(span, "a fault in every cycle");
            elab.diagnostics
                .push(match elab.inlining.call_spans.last() {
                    Some(call) => diagnostic
                        .secondary(*call, "with the arguments of this call")
                        .help("pass other arguments, or correct the operation"),
                    None => diagnostic.help("correct this operation, or the values that it reads"),
                });
        }
    }
}

/// Reserves memory for `more` placeholder ports.
pub(super) fn reserve_aliases(elab: &mut Elaborator<'_>, more: usize) {
    elab.aliases.signals.reserve(more);
    elab.aliases.types.reserve(more);
    elab.aliases.in_progress.reserve(more);
}

/// Adds a placeholder port for a signal of this machine type that is not known yet, and returns it.
pub(super) fn new_alias(elab: &mut Elaborator<'_>, scalar: Scalar) -> PortRef {
    elab.aliases.signals.push(None);
    elab.aliases.types.push(scalar);
    elab.aliases.in_progress.push(false);
    resolve_alias(elab.aliases.signals.len() - 1)
}

/// Returns the signal that is true in the first cycle of a fragment. Its net node is added on first use.
pub(super) fn first_port(elab: &mut Elaborator<'_>, fragment: FragmentId, span: Span) -> Signal {
    if let Some(port) = elab.cache.firsts.get(&fragment) {
        return Signal::Port(*port);
    }
    let signal = add_simple(
        elab,
        prim!("Rpi::First"),
        &[],
        Position::in_fragment(fragment),
        span,
    );
    if let Signal::Port(port) = signal {
        elab.cache.firsts.insert(fragment, port);
    }
    signal
}

/// Returns the text `name#serial`. The text is not built by `format!`, which is slow, because every net node gets such
/// a name.
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
        .filter_map(crate::ty::machine_types::param_default)
        .collect()
}

/// Returns the input of a net node for a port that is not connected: its default, or none.
fn unconnected_input(need: Fallback, ty: PortType) -> Input {
    let PortType::Scalar(scalar) = ty else {
        return Input::Unconnected;
    };
    match need {
        Fallback::Param(_, default) => default_input(default, scalar),
        Fallback::ComposedOfParams(parts, make) => {
            let reals: Vec<f64> = parts.iter().map(|(_, default)| *default).collect();
            Input::constant(make(&reals))
        }
        Fallback::Required | Fallback::AbsentValue => Input::Unconnected,
    }
}

fn default_input(default: PortDefault, scalar: Scalar) -> Input {
    default
        .value(Type::Scalar(scalar))
        .map_or(Input::Unconnected, Input::constant)
}

/// Returns the leaves (scalar parts) of a value: the elements of an array or matrix, or the value itself.
pub(super) fn leaves(value: &Value) -> Vec<Leaf> {
    let (scalar, count) = match value.ty() {
        None | Some(Type::Scalar(_)) => return vec![value.clone()],
        Some(Type::Array(scalar, n)) => (scalar, n),
        Some(Type::Matrix(rows, cols)) => (Scalar::Real, rows * cols),
    };
    let element = |cells: &[u64]| Value::Slots {
        ty: Type::Scalar(scalar),
        cells: cells.into(),
    };
    let chunks = value.slots().chunks(scalar.slots() as usize);
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
