//! Slots that the steps of an image read and write, with their types.

use crate::c_type::{CType, element, port_element};
use rpi_image::image::{CommandEnd, Form, Image, Signal, SlotRange, Step, TRUE};
use rpi_image::operands::{Operand, OperandRole, group_words, operand_layout};
use rpi_image::{DeviceResponse, ParamType, PortType, PrimDesc};
use rpi_prims::{Prim, PrimId};

/// Access of a step or table to adjacent slots.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Access {
    pub(crate) slots: SlotRange,
    /// C type of the slots; `None` if the access does not determine it.
    pub(crate) ty: Option<CType>,
    pub(crate) writes: bool,
    /// True if the slots must be adjacent elements of one C array.
    pub(crate) is_array: bool,
}

impl Access {
    pub(crate) fn new(start: u32, len: u32, ty: Option<CType>, writes: bool) -> Access {
        let slots = SlotRange { start, len };
        Access {
            slots,
            ty,
            writes,
            is_array: false,
        }
    }

    pub(crate) fn array(self) -> Access {
        Access {
            is_array: self.slots.len > 1,
            ..self
        }
    }
}

/// Primitive that an image uses, by its index in [`Image::prims_used`].
pub(crate) fn used_prim(image: &Image, prim: u16) -> Option<&'static Prim> {
    let used = image.prims_used.get(usize::from(prim))?;
    PrimId::from_name(&used.name).map(PrimId::prim)
}

/// Operand of one call of a primitive, with its words in the code of the image.
pub(crate) type CallOperand<'a> = (Operand, &'a [u32]);

/// Returns the operands of each call of a `Run` step.
pub(crate) fn calls<'a>(
    image: &'a Image,
    desc: &PrimDesc,
    form: Form,
    words: SlotRange,
) -> Vec<Vec<CallOperand<'a>>> {
    let layout = operand_layout(desc, form);
    let code = image.code.get(words.range()).unwrap_or(&[]);
    let split = |mut group: &'a [u32]| {
        let mut operands = Vec::with_capacity(layout.len());
        for operand in &layout {
            let (own, rest) = group.split_at(operand.words());
            group = rest;
            operands.push((*operand, own));
        }
        operands
    };
    let groups = code.chunks_exact(group_words(&layout).max(1));
    groups.map(split).collect()
}

/// Returns the number of slots of an operand whose element has `each` slots.
pub(crate) fn operand_len(operand: Operand, words: &[u32], each: u32) -> u32 {
    let sizes = &words[1..=operand.size_words];
    sizes.iter().product::<u32>().saturating_mul(each)
}

/// Appends the accesses of one call of a primitive.
pub(crate) fn call_accesses(prim: &Prim, operands: &[CallOperand<'_>], out: &mut Vec<Access>) {
    for (operand, words) in operands {
        let writes = matches!(operand.role, OperandRole::Output(_));
        let port = |ty: PortType| {
            let scalar = port_element(ty);
            let len = operand_len(*operand, words, scalar.slots());
            Access::new(words[0], len, Some(CType::of(scalar)), writes).array()
        };
        match operand.role {
            OperandRole::Input(k) => out.push(port(prim.desc.inputs[k].ty)),
            OperandRole::Output(k) => out.push(port(prim.desc.outputs[k].ty)),
            OperandRole::Param(k) => out.push(port(param_port(prim.desc.params[k].ty))),
            OperandRole::State => state_accesses(prim, words, out),
        }
        if operand.has_presence {
            let present = words[words.len() - 1];
            out.push(Access::new(present, 1, Some(CType::Bool), writes));
        }
    }
}

/// Returns the port type that corresponds to the type of a parameter. Texts have no operand.
pub(crate) const fn param_port(ty: ParamType) -> PortType {
    match ty {
        ParamType::Scalar(s) => PortType::Scalar(s),
        ParamType::Array(s) => PortType::Array(s),
        ParamType::Str => PortType::Scalar(rpi_image::Scalar::Bool),
    }
}

fn state_accesses(prim: &Prim, words: &[u32], out: &mut Vec<Access>) {
    if let [start, len] = *words {
        out.push(Access::new(start, len, Some(CType::Word), true).array());
        return;
    }
    let mut at = words[0];
    for scalar in prim.c.map_or(&[][..], |c| c.state) {
        let len = scalar.slots();
        out.push(Access::new(at, len, Some(CType::of(*scalar)), true).array());
        at += len;
    }
}

/// Returns the accesses of a step, except those of [`Step::Reset`] and [`Step::Copy`].
pub(crate) fn step_accesses(image: &Image, step: &Step) -> Vec<Access> {
    let mut out = Vec::new();
    match *step {
        Step::Run {
            prim,
            form,
            start,
            len,
        } => {
            let Some(prim) = used_prim(image, prim) else {
                return out;
            };
            for call in calls(image, &prim.desc, form, SlotRange { start, len }) {
                call_accesses(prim, &call, &mut out);
            }
        }
        Step::Skip { unless, .. } | Step::Reset { unless, .. } => {
            out.push(Access::new(unless, 1, Some(CType::Bool), false));
        }
        Step::Actuate { actuator } => {
            let actuator = &image.actuators[actuator as usize];
            let inputs = actuator.inputs.iter();
            out.extend(inputs.map(|i| Access::new(i.start, i.len, None, false)));
            let responses = actuator.responses.iter();
            out.extend(responses.map(|r| Access::new(r.1, 1, Some(response_type(r.0)), true)));
        }
        Step::Call { function } => {
            let function = &image.functions[function as usize];
            if let Some(external) = &function.external {
                crate::external::accesses(function, external, &mut out);
                return out;
            }
            let arguments = function.arguments.iter();
            out.extend(arguments.map(|a| Access::new(a.start, a.len, None, false)));
            let results = function.results.iter();
            out.extend(results.map(|r| Access::new(r.start, r.len, None, true)));
            if function.present != TRUE {
                out.push(Access::new(function.present, 1, Some(CType::Bool), true));
            }
        }
        Step::Copy { .. } => {}
    }
    out
}

/// Returns the C type of a response of a device.
pub(crate) const fn response_type(response: DeviceResponse) -> CType {
    match response {
        DeviceResponse::ErrorCode => CType::Int,
        _ => CType::Bool,
    }
}

/// Returns the pairs (source, destination) of a copy.
pub(crate) fn copies(image: &Image, at: u32, len: u32) -> Vec<(u32, u32)> {
    let words = image.code.get(SlotRange { start: at, len }.range());
    let pairs = words.unwrap_or(&[]).chunks_exact(2);
    pairs.map(|pair| (pair[0], pair[1])).collect()
}

/// Returns the flows in the tables of an image: those that come from outside, and those that are read after the steps.
pub(crate) fn table_signals(image: &Image) -> (Vec<Signal>, Vec<Signal>) {
    let sensors = image.sensors.iter().map(|s| s.value);
    let inputs = image.inputs.iter();
    let inputs = inputs.flat_map(|i| std::iter::once(i.value).chain(i.last_updated));
    let flows = image.flows.iter().map(|f| f.value);
    let external = sensors.chain(inputs).chain(flows).collect();
    let exports = image.exports.iter().map(|e| e.value);
    let ends: Vec<Signal> = match &image.end {
        CommandEnd::Results(results) => results.iter().map(|r| r.condition).collect(),
        CommandEnd::Ports { terminate, fail } => terminate.iter().chain(fail).copied().collect(),
    };
    (external, exports.chain(ends).collect())
}

/// Returns the accesses to the value and the presence of a flow.
pub(crate) fn signal_accesses(signal: Signal, writes: bool) -> [Access; 2] {
    let ty = Some(CType::of(element(signal.ty)));
    let value = Access::new(signal.start, signal.ty.slots(), ty, writes).array();
    let present = Access::new(signal.present, 1, Some(CType::Bool), writes);
    [value, present]
}

/// Returns the type in which a slot is handed to a device: its own, or a word for a constant.
pub(crate) const fn shared_type(ty: Option<CType>) -> CType {
    match ty {
        Some(ty) => ty,
        None => CType::Word,
    }
}
