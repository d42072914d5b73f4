//! C functions of primitives.

use crate::c_type::{CType, is_single, port_element};
use crate::expansion::expand;
use crate::identifiers::mentions;
use rpi_image::{PortType, StateSize};
use rpi_prims::Prim;
use rpi_prims::c_code::CForm;

use crate::access::param_port;

/// Part of an operand that a parameter of a C function passes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Part {
    Value,
    /// Length of an array or rows of a matrix: word 1 of the operand.
    FirstSize,
    /// Columns of a matrix: word 2 of the operand.
    SecondSize,
    Presence,
}

/// Argument of the C function of a primitive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Argument {
    Context,
    Place,
    Input(usize, Part),
    Param(usize, Part),
    Output(usize, Part),
    State(usize),
    Ring,
    RingLength,
}

/// Parameter of the C function of a primitive: the argument, its name in the text, and its declaration.
#[derive(Clone, Debug)]
pub(crate) struct Parameter {
    pub(crate) argument: Argument,
    pub(crate) name: String,
    pub(crate) declaration: String,
}

/// C function of a primitive.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) name: String,
    pub(crate) parameters: Vec<Parameter>,
    /// Text of the definition.
    pub(crate) text: String,
    /// Expression that the function returns; `None` if the function writes its results itself.
    pub(crate) expression: Option<&'static str>,
}

/// Returns the C function of a primitive. `as_value` selects the form for ports that are all present, if there is one.
pub(crate) fn function(prim: &Prim, as_value: bool) -> Option<Function> {
    let (form, outputs) = (prim.c?.form, prim.desc.outputs);
    let single = outputs.len() == 1 && is_single(outputs[0].ty);
    let value = match form {
        CForm::Value(text) | CForm::Both(text, _) if as_value && single => Some(text),
        _ => None,
    };
    let body = match form {
        CForm::Value(text) | CForm::Code(text) | CForm::Both(_, text) => text,
    };
    let body = expand(prim, value.unwrap_or(body));
    let mut parameters = parameters(prim);
    parameters.retain(|p| mentions(&body, &p.name));
    let name = format!("rpi_{}", prim.desc.name.replace("::", "_"));
    let name = if value.is_some() {
        name
    } else {
        format!("{name}_step")
    };
    let result = match value {
        Some(_) => CType::of(port_element(outputs[0].ty)).name(),
        None => "void",
    };
    let list: Vec<&str> = parameters.iter().map(|p| p.declaration.as_str()).collect();
    let list = if list.is_empty() {
        "void".to_owned()
    } else {
        list.join(", ")
    };
    let body = match value {
        Some(_) => format!("  return {body};\n"),
        None => body.trim().lines().map(|l| format!("  {l}\n")).collect(),
    };
    Some(Function {
        text: format!("static inline {result} {name}({list}) {{\n{body}}}\n"),
        name,
        parameters,
        expression: value,
    })
}

/// Returns all parameters that the C code of a primitive may use.
fn parameters(prim: &Prim) -> Vec<Parameter> {
    let mut list = ParameterList(Vec::new());
    list.add(Argument::Context, "cx", "rpi_context *cx");
    list.add(Argument::Place, "at", "int32_t at");
    for (k, port) in prim.desc.inputs.iter().enumerate() {
        list.port(port.name, port.ty, true, &|part| Argument::Input(k, part));
    }
    for (k, param) in prim.desc.params.iter().enumerate() {
        list.port(param.name, param_port(param.ty), true, &|part| {
            Argument::Param(k, part)
        });
    }
    for (k, port) in prim.desc.outputs.iter().enumerate() {
        list.port(port.name, port.ty, false, &|part| Argument::Output(k, part));
    }
    for (k, scalar) in prim.c.map_or(&[][..], |c| c.state).iter().enumerate() {
        let name = format!("s{k}");
        let declaration = format!("{} *{name}", CType::of(*scalar).name());
        list.add(Argument::State(k), &name, &declaration);
    }
    if matches!(prim.desc.state, StateSize::Computed(_)) {
        list.add(Argument::Ring, "ring", "uint64_t *ring");
        list.add(Argument::RingLength, "ring_len", "size_t ring_len");
    }
    list.0
}

struct ParameterList(Vec<Parameter>);

impl ParameterList {
    fn add(&mut self, argument: Argument, name: &str, declaration: &str) {
        self.0.push(Parameter {
            argument,
            name: name.to_owned(),
            declaration: declaration.to_owned(),
        });
    }

    fn port(
        &mut self,
        name: &str,
        ty: PortType,
        is_input: bool,
        argument: &dyn Fn(Part) -> Argument,
    ) {
        let c_type = CType::of(port_element(ty)).name();
        let (value, presence) = match (is_input, is_single(ty)) {
            (true, true) => (format!("{c_type} {name}"), "bool "),
            (true, false) => (format!("const {c_type} *{name}"), "bool "),
            (false, _) => (format!("{c_type} *{name}"), "bool *"),
        };
        self.add(argument(Part::Value), name, &value);
        let sizes: &[(&str, Part)] = match ty {
            PortType::Scalar(_) => &[],
            PortType::Array(_) => &[("len", Part::FirstSize)],
            PortType::Matrix => &[("rows", Part::FirstSize), ("cols", Part::SecondSize)],
        };
        for (suffix, part) in sizes {
            let size = format!("{name}_{suffix}");
            self.add(argument(*part), &size, &format!("int32_t {size}"));
        }
        let present = format!("{name}_present");
        self.add(
            argument(Part::Presence),
            &present,
            &format!("{presence}{present}"),
        );
    }
}
