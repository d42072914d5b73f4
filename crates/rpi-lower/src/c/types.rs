//! Inference of the C types of registers.

use crate::flat_net::{FlatNet, OpKind};
use crate::passes::traversal::ops_in_order;
use crate::registers::Register;
use rpi_image::image::Signal;
use rpi_image::operands::{OperandRole, operand_layout};
use rpi_image::{ParamType, PortType, PrimDesc, Scalar, Type};

/// Returns the C type of one memory slot of a value whose elements have this type.
pub(super) const fn c_type(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::Bool => "bool",
        Scalar::Int | Scalar::Time => "int64_t",
        _ => "double",
    }
}

/// Returns the scalar type of a value: the type itself, or the element type of an array or a matrix.
pub(super) const fn scalar(ty: Type) -> Scalar {
    match ty {
        Type::Scalar(s) | Type::Array(s, _) => s,
        Type::Matrix(..) => Scalar::Real,
    }
}

/// Infers the scalar type of each register, by register number. Registers whose type cannot be inferred are presences
/// and count as Boolean.
pub(super) fn types(flat: &FlatNet) -> Vec<Scalar> {
    let mut types = vec![Scalar::Bool; flat.registers.len()];
    let mut set = |s: Signal| types[s.start as usize] = scalar(s.ty);
    flat.tables.sensors.iter().for_each(|(s, _)| set(s.value));
    flat.tables.flows.iter().for_each(|f| set(f.value));
    flat.tables.inputs.iter().for_each(|i| {
        set(i.value);
        i.last_updated.into_iter().for_each(&mut set);
    });
    flat.tables.probes.iter().for_each(|p| set(p.2));
    let order = ops_in_order(flat);
    // The type of a delay's state follows from its output or its input, so two passes suffice.
    for _ in 0..2 {
        for (number, _) in &order {
            operation(flat, *number, &mut types);
        }
        for (from, to) in flat.scopes.iter().flat_map(|s| &s.latches) {
            if flat.registers.region(*from) != crate::registers::Region::Constant {
                types[to.index()] = types[from.index()];
            }
        }
    }
    types
}

fn operation(flat: &FlatNet, number: u32, types: &mut [Scalar]) {
    let op = flat.ops[number as usize];
    let words = flat.words(op);
    match op.kind {
        OpKind::Run(prim, form) => {
            let mut at = 0;
            for field in operand_layout(prim.desc(), form) {
                if let OperandRole::Output(k) = field.role {
                    types[words[at] as usize] = port(prim.desc().outputs[k].ty);
                }
                at += field.words();
            }
        }
        OpKind::Copy => {
            let (from, to) = (words[0] as usize, words[1] as usize);
            match flat.registers.region(Register(words[0])) {
                crate::registers::Region::State(_) if types[to] != Scalar::Bool => {
                    types[from] = types[to]
                }
                _ => types[to] = types[from],
            }
        }
        OpKind::Actuate(..) | OpKind::Call(..) => {}
    }
}

const fn port(ty: PortType) -> Scalar {
    match ty {
        PortType::Scalar(s) | PortType::Array(s) => s,
        PortType::Matrix => Scalar::Real,
    }
}

/// Returns the scalar type that a primitive declares for one of its operands; it determines the C notation of a
/// constant.
pub(super) const fn expected(desc: &PrimDesc, part: OperandRole) -> Scalar {
    match part {
        OperandRole::Input(k) => port(desc.inputs[k].ty),
        OperandRole::Output(k) => port(desc.outputs[k].ty),
        OperandRole::Param(k) => match desc.params[k].ty {
            ParamType::Scalar(s) | ParamType::Array(s) => s,
            ParamType::Str => Scalar::Bool,
        },
        OperandRole::State => Scalar::Real,
    }
}
