//! Expansion of the calls in the C code of primitives that depend on the types of ports, such as `COPY`.

use crate::c_type::{CType, is_single, port_element};
use rpi_image::{PortType, PrimDesc, Scalar};
use rpi_prims::Prim;

/// Type of a name in the C code of a primitive.
#[derive(Clone, Copy)]
struct Operand {
    element: Scalar,
    /// True for a single value of one slot, which a pointer of the same name refers to.
    is_single: bool,
    is_array: bool,
}

impl Operand {
    fn slots(self) -> u32 {
        self.element.slots()
    }

    fn ty(self) -> CType {
        CType::of(self.element)
    }
}

/// Returns the C code of a primitive with all calls replaced.
pub(crate) fn expand(prim: &Prim, text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, name, after)) = next_call(rest) {
        out.push_str(before);
        let (arguments, following) = split_arguments(after);
        out.push_str(&replacement(prim, name, &arguments));
        rest = following;
    }
    out.push_str(rest);
    out
}

const CALLS: &[&str] = &[
    "COPY(", "GET(", "PUT(", "SLICE(", "NEUTRAL(", "LOAD(", "STORE(", "SLOTS(",
];

/// Returns the text before the first call, the call with its parenthesis, and the text after it.
fn next_call(text: &str) -> Option<(&str, &'static str, &str)> {
    let found = CALLS
        .iter()
        .filter_map(|call| Some((text.find(call)?, *call)));
    let (at, call) = found.min()?;
    Some((&text[..at], call, &text[at + call.len()..]))
}

/// Splits the text after an opening parenthesis into the arguments and the text after the closing one.
fn split_arguments(text: &str) -> (Vec<&str>, &str) {
    let (mut depth, mut start) = (0, 0);
    let mut arguments = Vec::new();
    for (at, c) in text.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ',' if depth == 0 => {
                arguments.push(text[start..at].trim());
                start = at + 1;
            }
            ')' if depth == 0 => {
                arguments.push(text[start..at].trim());
                return (arguments, &text[at + 1..]);
            }
            ')' | ']' => depth -= 1,
            _ => {}
        }
    }
    (arguments, "")
}

fn replacement(prim: &Prim, call: &str, arguments: &[&str]) -> String {
    match (call, arguments) {
        ("SLOTS(", [port]) => format!("{}U", operand(prim, port).slots()),
        ("COPY(", [to, from]) => copy(prim, to, from),
        ("GET(", [to, array, index]) => match operand(prim, to).slots() {
            1 => format!("*{to} = {array}[{index}]"),
            n => format!("memcpy({to}, {array} + {index} * {n}, {n}U * sizeof {to}[0])"),
        },
        ("PUT(", [array, index, from]) => match operand(prim, array).slots() {
            1 => format!("{array}[{index}] = {from}"),
            n => format!("memcpy({array} + {index} * {n}, {from}, {n}U * sizeof {array}[0])"),
        },
        ("SLICE(", [to, array, start]) => {
            let n = operand(prim, to).slots();
            let from = match *start {
                "0" => (*array).to_owned(),
                start => format!("{array} + {start} * {n}"),
            };
            format!("memcpy({to}, {from}, (size_t){to}_len * {n}U * sizeof {to}[0])")
        }
        ("NEUTRAL(", [to]) => neutral(operand(prim, to), to),
        ("LOAD(", [to, words]) => load(operand(prim, to), to, words),
        ("STORE(", [words, from]) => store(operand(prim, from), words, from),
        _ => String::new(),
    }
}

fn copy(prim: &Prim, to: &str, from: &str) -> String {
    let n = operand(prim, to).slots();
    match state_component(prim, from) {
        _ if n > 1 => format!("memcpy({to}, {from}, {n}U * sizeof {to}[0])"),
        Some(_) => format!("*{to} = *{from}"),
        None => format!("*{to} = {from}"),
    }
}

fn neutral(operand: Operand, to: &str) -> String {
    let unit = match operand.element {
        Scalar::Rotation => Some(3),
        Scalar::Pose => Some(6),
        _ => None,
    };
    let n = operand.slots();
    match (operand.is_single, operand.is_array, unit) {
        (true, _, _) if operand.ty() == CType::Bool => format!("*{to} = false"),
        (true, _, _) => format!("*{to} = 0"),
        (_, false, None) => format!("memset({to}, 0, {n}U * sizeof {to}[0])"),
        (_, false, Some(unit)) => {
            format!("memset({to}, 0, {n}U * sizeof {to}[0]);\n{to}[{unit}] = 1.0")
        }
        (_, true, unit) => {
            let clear = format!("memset({to}, 0, (size_t){to}_len * {n}U * sizeof {to}[0])");
            let Some(unit) = unit else { return clear };
            format!(
                "{clear};\n{{\n  int32_t k;\n  for (k = 0; k < {to}_len; k += 1) {{\n    {to}[k * {n} + {unit}] = 1.0;\n  }}\n}}"
            )
        }
    }
}

fn load(operand: Operand, to: &str, words: &str) -> String {
    match (operand.slots(), operand.ty()) {
        (1, CType::Bool) => format!("*{to} = {words}[0] != 0U"),
        (1, CType::Int) => format!("*{to} = rpi_integer({words}[0])"),
        (1, _) => format!("*{to} = rpi_real({words}[0])"),
        (n, _) => each(n, &format!("{to}[k] = rpi_real({words}[k]);")),
    }
}

fn store(operand: Operand, words: &str, from: &str) -> String {
    match (operand.slots(), operand.ty()) {
        (1, CType::Bool) => format!("{words}[0] = {from} ? 1U : 0U"),
        (1, CType::Int) => format!("{words}[0] = (uint64_t){from}"),
        (1, _) => format!("{words}[0] = rpi_bits({from})"),
        (n, _) => each(n, &format!("{words}[k] = rpi_bits({from}[k]);")),
    }
}

fn each(count: u32, statement: &str) -> String {
    format!("{{\n  size_t k;\n  for (k = 0U; k < {count}U; k += 1U) {{\n    {statement}\n  }}\n}}")
}

/// Returns the type of a name in the C code: a port, a parameter or a component of the state.
fn operand(prim: &Prim, name: &str) -> Operand {
    let of_port = |ty: PortType| Operand {
        element: port_element(ty),
        is_single: is_single(ty),
        is_array: matches!(ty, PortType::Array(_)),
    };
    let of_state = |element: Scalar| Operand {
        element,
        is_single: element.slots() == 1,
        is_array: false,
    };
    let found = port_type(&prim.desc, name).map(of_port);
    let found = found.or_else(|| state_component(prim, name).map(of_state));
    // The tests of all primitives compile every text, so that a wrong name does not stay undetected.
    found.unwrap_or(of_state(Scalar::Real))
}

fn port_type(desc: &PrimDesc, name: &str) -> Option<PortType> {
    let input = desc.inputs.iter().find(|p| p.name == name).map(|p| p.ty);
    let output = desc.outputs.iter().find(|p| p.name == name);
    input.or_else(|| output.map(|p| p.ty))
}

fn state_component(prim: &Prim, name: &str) -> Option<Scalar> {
    let index: usize = name.strip_prefix('s')?.parse().ok()?;
    prim.c?.state.get(index).copied()
}
