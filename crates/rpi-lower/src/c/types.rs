//! Inference of the C types of registers.

use crate::flat::{Flat, Work};
use crate::passes::order::ops;
use crate::slots::Slot;
use rpi_image::image::Signal;
use rpi_image::operands::{Part, fields};
use rpi_image::{ParamType, PortType, PrimDesc, Scalar, Type};

/// C type of one memory slot of a value.
pub(super) const fn c_type(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::Bool => "bool",
        Scalar::Int | Scalar::Time => "int64_t",
        _ => "double",
    }
}

/// Scalar of a type; the element type for arrays.
pub(super) const fn scalar(ty: Type) -> Scalar {
    match ty {
        Type::One(s) | Type::Array(s, _) => s,
        Type::Matrix(..) => Scalar::Real,
    }
}

/// The scalar type of each register. Registers of unknown type are presences, which are Boolean.
pub(super) fn types(flat: &Flat) -> Vec<Scalar> {
    let mut types = vec![Scalar::Bool; flat.slots.len()];
    let mut set = |s: Signal| types[s.at as usize] = scalar(s.ty);
    flat.tables.sensors.iter().for_each(|(s, _)| set(s.value));
    flat.tables.flows.iter().for_each(|f| set(f.value));
    flat.tables.inputs.iter().for_each(|i| {
        set(i.value);
        i.updated.into_iter().for_each(&mut set);
    });
    flat.tables.probes.iter().for_each(|p| set(p.2));
    let order = ops(flat);
    // The type of a delay's state follows from its output or its input, so two passes suffice.
    for _ in 0..2 {
        for (number, _) in &order {
            operation(flat, *number, &mut types);
        }
        for (from, to) in flat.scopes.iter().flat_map(|s| &s.latches) {
            if flat.slots.region(*from) != crate::slots::Region::Constant {
                types[to.index()] = types[from.index()];
            }
        }
    }
    types
}

fn operation(flat: &Flat, number: u32, types: &mut [Scalar]) {
    let op = flat.ops[number as usize];
    let words = flat.words(op);
    match op.work {
        Work::Run(prim, form) => {
            let mut at = 0;
            for field in fields(prim.desc(), form) {
                if let Part::Output(k) = field.part {
                    types[words[at] as usize] = port(prim.desc().outputs[k].ty);
                }
                at += field.words();
            }
        }
        Work::Copy => {
            let (from, to) = (words[0] as usize, words[1] as usize);
            match flat.slots.region(Slot(words[0])) {
                crate::slots::Region::State(_) if types[to] != Scalar::Bool => {
                    types[from] = types[to]
                }
                _ => types[to] = types[from],
            }
        }
        Work::Actuate(..) | Work::Call(..) => {}
    }
}

const fn port(ty: PortType) -> Scalar {
    match ty {
        PortType::One(s) | PortType::Array(s) => s,
        PortType::Matrix => Scalar::Real,
    }
}

/// Type that an operand must have, for writing constants.
pub(super) const fn expected(desc: &PrimDesc, part: Part) -> Scalar {
    match part {
        Part::Input(k) => port(desc.inputs[k].ty),
        Part::Output(k) => port(desc.outputs[k].ty),
        Part::Param(k) => match desc.params[k].ty {
            ParamType::One(s) | ParamType::Array(s) => s,
            ParamType::Str => Scalar::Bool,
        },
        Part::State => Scalar::Real,
    }
}
