//! Checks of [`Step::Run`](crate::Step::Run): operand words against the declaration of the primitive.

use super::Verifier;
use super::steps::PrimLayout;
use crate::desc::{ParamType, PortType, PrimDesc, ShapeArgs, ShapeRule, SizeArgs, StateSize};
use crate::image::{Form, SlotRange};
use crate::operands::{Operand, OperandRole};
use crate::types::{Scalar, Type};
use crate::value::Value;
use crate::{Presence, Role};
use alloc::string::String;
use alloc::vec::Vec;
use alloc::{format, vec};

/// Types of the inputs and values of the parameters of one call of a primitive, from which the sizes of outputs and
/// state follow. Both lists are empty if all sizes of the primitive are fixed.
struct GroupTypes {
    inputs: Vec<Option<Type>>,
    params: Vec<Value>,
}

impl GroupTypes {
    fn new(desc: &PrimDesc) -> Self {
        // Fixed sizes need neither types nor parameters; empty lists avoid an allocation per group.
        let (inputs, params) = match has_derived_size(desc) {
            true => (desc.inputs.len(), desc.params.len()),
            false => (0, 0),
        };
        GroupTypes {
            inputs: vec![None; inputs],
            params: vec![Value::Str(String::new()); params],
        }
    }
}

impl Verifier<'_> {
    pub(super) fn run(
        &mut self,
        known: &[Option<PrimLayout>],
        prim: u16,
        form: Form,
        words: SlotRange,
    ) {
        let Some(Some(known)) = known.get(usize::from(prim)) else {
            return self.require(known.len() > usize::from(prim), || {
                format!("there is no primitive {prim}")
            });
        };
        self.require(has_form(known.desc, form), || {
            format!("{} has no {form:?} form", known.desc.name)
        });
        let (fields, group) = &known.forms[form as usize];
        let Some(words) = self.operand_words(words, *group) else {
            return;
        };
        for group in words.chunks_exact(*group) {
            self.group(known.desc, fields, group);
        }
    }

    fn group(&mut self, desc: &PrimDesc, fields: &[Operand], words: &[u32]) {
        let mut group = GroupTypes::new(desc);
        let mut words = words;
        for field in fields {
            let (mine, rest) = words.split_at(field.words());
            words = rest;
            self.field(desc, *field, mine, &mut group);
        }
    }

    fn field(&mut self, desc: &PrimDesc, field: Operand, words: &[u32], group: &mut GroupTypes) {
        let presence = field.has_presence.then(|| words[field.words() - 1]);
        match field.role {
            OperandRole::Input(k) => {
                let ty = port_type(desc.inputs[k].ty, words);
                if let Some(input) = group.inputs.get_mut(k) {
                    *input = Some(ty);
                }
                self.check_read(slot_range(words[0], ty));
                presence
                    .into_iter()
                    .for_each(|cell| self.check_control_read(cell));
            }
            OperandRole::Param(k) => {
                let ty = param_type(desc.params[k].ty, words);
                self.check_constant(slot_range(words[0], ty));
                if let Some(param) = group.params.get_mut(k) {
                    *param = self.value(words[0], ty);
                }
            }
            OperandRole::Output(k) => {
                let ty = port_type(desc.outputs[k].ty, words);
                self.check_shape(desc, k, ty, group);
                self.check_write(slot_range(words[0], ty));
                presence
                    .into_iter()
                    .for_each(|at| self.check_write(SlotRange { start: at, len: 1 }));
            }
            OperandRole::State => self.state(desc, words, group),
        }
    }

    /// Checks the type `ty` of the out-port with index `port` against the shape rule of the primitive. `group` holds
    /// the inputs and parameters of the call.
    fn check_shape(&mut self, desc: &PrimDesc, port: usize, ty: Type, group: &GroupTypes) {
        if matches!(desc.shape, ShapeRule::Fixed) {
            return;
        }
        let args = ShapeArgs {
            inputs: &group.inputs,
            params: &group.params,
        };
        let right = desc.out_type(port, &args) == Some(ty);
        self.require(right, || {
            format!(
                "{}: type {ty} does not match its inputs",
                desc.outputs[port].name
            )
        });
    }

    fn state(&mut self, desc: &PrimDesc, words: &[u32], group: &GroupTypes) {
        let dt = self.image.period_ns as f64 / 1e9;
        let len = match desc.state {
            StateSize::None => 0,
            StateSize::Fixed(n) => n,
            StateSize::Computed(size) => {
                let right = size(&SizeArgs {
                    params: &group.params,
                    dt,
                });
                self.require(words[1] == right, || {
                    format!("expected a state of {right} slots, found {}", words[1])
                });
                words[1]
            }
        };
        self.check_state_write(SlotRange {
            start: words[0],
            len,
        });
    }

    /// Returns the constant of type `ty` that starts at slot `at`. Slots outside of the memory count as 0; their error
    /// is already reported.
    fn value(&self, at: u32, ty: Type) -> Value {
        let bits = |cell: u32| {
            let found = self.image.init.binary_search_by_key(&cell, |c| c.0);
            found.map_or(0, |k| self.image.init[k].1)
        };
        let range = slot_range(at, ty);
        let len = range.len.min(self.image.layout.constants);
        Value::Slots {
            ty,
            cells: (0..len).map(|k| bits(at.saturating_add(k))).collect(),
        }
    }
}

fn slot_range(at: u32, ty: Type) -> SlotRange {
    SlotRange {
        start: at,
        len: ty.slots(),
    }
}

/// Returns whether a step can run a primitive in this form. Only a primitive with [`Role::Compute`] runs. The form
/// [`Form::Total`] needs outputs that cannot be absent while all inputs are present ([`Presence::Maybe`] can);
/// [`Form::Optional`] needs at least one output that is not [`Presence::Strict`].
fn has_form(desc: &PrimDesc, form: Form) -> bool {
    let presence = desc.outputs.iter().map(|o| o.presence);
    let strict = presence.clone().all(|p| p == Presence::Strict);
    let maybe = presence.clone().any(|p| p == Presence::Maybe);
    desc.role == Role::Compute
        && match form {
            Form::Total => !maybe,
            Form::Optional => !strict,
        }
}

fn has_derived_size(desc: &PrimDesc) -> bool {
    !matches!(desc.shape, ShapeRule::Fixed) || matches!(desc.state, StateSize::Computed(_))
}

fn port_type(ty: PortType, words: &[u32]) -> Type {
    match ty {
        PortType::Scalar(s) => Type::Scalar(s),
        PortType::Array(s) => Type::Array(s, words[1]),
        PortType::Matrix => Type::Matrix(words[1], words[2]),
    }
}

/// Returns the type of a parameter; `words` are the words of its operand. A text parameter has no operand, so the last
/// case does not occur.
fn param_type(ty: ParamType, words: &[u32]) -> Type {
    match ty {
        ParamType::Scalar(s) => Type::Scalar(s),
        ParamType::Array(s) => Type::Array(s, words[1]),
        ParamType::Str => Type::Scalar(Scalar::Bool),
    }
}
