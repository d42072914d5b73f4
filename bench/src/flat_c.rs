//! A net as C, as one would write it by hand for speed: one function, a local variable for each primitive in the order of
//! the net, and a variable for each delay. It is the reference for the C that the compiler emits.

use crate::BenchError;
use rpi_image::{Role, Scalar, Type, Value};
use rpi_net::{Input, Net, Node};
use std::fmt::Write;

/// Returns a net as C, with functions whose names start with `Net`. The net must be plain: one fragment, reals and
/// Booleans, and sources before their readers except for those of delays.
///
/// # Errors
/// Returns an error for a primitive that the benchmarks do not use.
pub fn flat_c_text(net: &Net) -> Result<String, BenchError> {
    let mut delays = String::new();
    let mut body = String::new();
    let mut commit = String::new();
    for (k, node) in net.nodes.iter().enumerate() {
        let value = if node.desc().role == Role::Delay {
            let _ = writeln!(delays, "  double p{k};");
            let _ = writeln!(commit, "  s->p{k} = {};", operand(node, 0));
            format!("s->p{k}")
        } else {
            value(node)?
        };
        let _ = match node.outputs.first() {
            Some(ty) => writeln!(body, "  const {} v{k} = {value};", c_type(*ty)),
            None => writeln!(body, "  {value};"),
        };
    }
    Ok(format!(
        "#include <stdbool.h>\n#include <stdint.h>\n#include <string.h>\n\
         typedef struct {{ double x; }} Net_in;\ntypedef struct {{ double y; }} Net_out;\n\
         typedef struct {{\n{delays}  char unused;\n}} Net_state;\n\
         static void Net_init(Net_in *in) {{ memset(in, 0, sizeof *in); }}\n\
         static void Net_reset(Net_state *s) {{ memset(s, 0, sizeof *s); }}\n\
         __attribute__((noinline)) static void Net_step(Net_state *s, const Net_in *in, Net_out *out) {{\n\
         {body}{commit}}}\n"
    ))
}

/// Returns the C expression of a primitive.
fn value(node: &Node) -> Result<String, BenchError> {
    let name = node.desc().name;
    let [a, b, c] = [0, 1, 2].map(|k| operand(node, k));
    Ok(match name {
        "Core::DoubleNetcommIn" => "in->x".to_owned(),
        "Core::DoubleNetcommOut" => format!("out->y = {a}"),
        "Core::DoubleMultiply" => format!("{a} * {b}"),
        "Core::DoubleAdd" => format!("{a} + {b}"),
        "Rpi::DoubleSubtract" => format!("{a} - {b}"),
        "Core::DoubleGreater" => format!("{a} > {b}"),
        "Core::DoubleConditional" => format!("{a} ? {b} : {c}"),
        "Core::BooleanAnd" => format!("{a} && {b}"),
        "Core::BooleanOr" => format!("{a} || {b}"),
        "Core::BooleanNot" => format!("!{a}"),
        "Rpi::BooleanXor" => format!("{a} != {b}"),
        "Rpi::DoubleMaximum" => format!("{a} > {b} ? {a} : {b}"),
        "Rpi::DoubleMinimum" => format!("{a} < {b} ? {a} : {b}"),
        other => return Err(BenchError::new(format!("{other} has no flat C"))),
    })
}

/// Returns the C text of an operand; an empty text for a port that the primitive does not have.
fn operand(node: &Node, port: usize) -> String {
    match node.inputs.get(port) {
        Some(Input::Port(source)) => format!("v{}", source.node.index()),
        Some(Input::Const(value)) => constant(value),
        _ => String::new(),
    }
}

/// Returns a scalar constant as C text.
fn constant(value: &Value) -> String {
    match value {
        Value::Slots { ty, cells } => match (ty, cells.first()) {
            (Type::Scalar(Scalar::Real), Some(bits)) => format!("({:?})", f64::from_bits(*bits)),
            (_, Some(bits)) => (*bits != 0).to_string(),
            (_, None) => String::new(),
        },
        Value::Str(_) => String::new(),
    }
}

fn c_type(ty: Type) -> &'static str {
    match ty {
        Type::Scalar(Scalar::Bool) => "bool",
        _ => "double",
    }
}
