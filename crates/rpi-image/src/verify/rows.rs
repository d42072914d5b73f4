//! Checks of [`Step::Run`](crate::Step::Run): operand words against the declaration of the primitive.

use super::Check;
use super::steps::Known;
use crate::desc::{ParamType, PortType, PrimDesc, Shape, ShapeArgs, SizeArgs, State};
use crate::image::{Cells, Form};
use crate::operands::{Field, Part};
use crate::ty::{Scalar, Type};
use crate::value::Value;
use crate::{Presence, Role};
use alloc::string::String;
use alloc::vec::Vec;
use alloc::{format, vec};

/// Input types and parameters of one group of words. Both are empty if no size depends on them.
struct Group {
    inputs: Vec<Option<Type>>,
    params: Vec<Value>,
}

impl Group {
    fn new(desc: &PrimDesc) -> Self {
        // Fixed sizes need neither types nor parameters; empty lists avoid an allocation per group.
        let (inputs, params) = match sized(desc) {
            true => (desc.inputs.len(), desc.params.len()),
            false => (0, 0),
        };
        Group {
            inputs: vec![None; inputs],
            params: vec![Value::Str(String::new()); params],
        }
    }
}

impl Check<'_> {
    pub(super) fn run(&mut self, known: &[Option<Known>], prim: u16, form: Form, words: Cells) {
        let Some(Some(known)) = known.get(usize::from(prim)) else {
            return self.demand(known.len() > usize::from(prim), || {
                format!("there is no primitive {prim}")
            });
        };
        self.demand(runs(known.desc, form), || {
            format!("{} has no {form:?} form", known.desc.name)
        });
        let (fields, group) = &known.forms[form as usize];
        let Some(words) = self.words(words, *group) else {
            return;
        };
        for group in words.chunks_exact(*group) {
            self.group(known.desc, fields, group);
        }
    }

    fn group(&mut self, desc: &PrimDesc, fields: &[Field], words: &[u32]) {
        let mut group = Group::new(desc);
        let mut words = words;
        for field in fields {
            let (mine, rest) = words.split_at(field.words());
            words = rest;
            self.field(desc, *field, mine, &mut group);
        }
    }

    fn field(&mut self, desc: &PrimDesc, field: Field, words: &[u32], group: &mut Group) {
        let presence = field.presence.then(|| words[field.words() - 1]);
        match field.part {
            Part::Input(k) => {
                let ty = port_type(desc.inputs[k].ty, words);
                if let Some(input) = group.inputs.get_mut(k) {
                    *input = Some(ty);
                }
                self.reads(cells(words[0], ty));
                presence.into_iter().for_each(|cell| self.decides(cell));
            }
            Part::Param(k) => {
                let ty = param_type(desc.params[k].ty, words);
                self.constant(cells(words[0], ty));
                if let Some(param) = group.params.get_mut(k) {
                    *param = self.value(words[0], ty);
                }
            }
            Part::Output(k) => {
                let ty = port_type(desc.outputs[k].ty, words);
                self.fits(desc, k, ty, group);
                self.writes(cells(words[0], ty));
                presence
                    .into_iter()
                    .for_each(|at| self.writes(Cells { at, len: 1 }));
            }
            Part::State => self.state(desc, words, group),
        }
    }

    /// Checks the length or shape of an output against the rule of the declaration.
    fn fits(&mut self, desc: &PrimDesc, port: usize, ty: Type, group: &Group) {
        if matches!(desc.shape, Shape::Fixed) {
            return;
        }
        let args = ShapeArgs {
            inputs: &group.inputs,
            params: &group.params,
        };
        let right = desc.out_type(port, &args) == Some(ty);
        self.demand(right, || {
            format!(
                "{}: type {ty} does not match its inputs",
                desc.outputs[port].name
            )
        });
    }

    fn state(&mut self, desc: &PrimDesc, words: &[u32], group: &Group) {
        let dt = self.image.period_ns as f64 / 1e9;
        let len = match desc.state {
            State::None => 0,
            State::Cells(n) => n,
            State::Sized(size) => {
                let right = size(&SizeArgs {
                    params: &group.params,
                    dt,
                });
                self.demand(words[1] == right, || {
                    format!("expected a state of {right} slots, found {}", words[1])
                });
                words[1]
            }
        };
        self.owns(Cells { at: words[0], len });
    }

    /// Returns the value of a constant; zero if it is out of range, which is already reported.
    fn value(&self, at: u32, ty: Type) -> Value {
        let bits = |cell: u32| {
            let found = self.image.init.binary_search_by_key(&cell, |c| c.0);
            found.map_or(0, |k| self.image.init[k].1)
        };
        let range = cells(at, ty);
        let len = range.len.min(self.image.layout.constants);
        Value::Cells {
            ty,
            cells: (0..len).map(|k| bits(at.saturating_add(k))).collect(),
        }
    }
}

fn cells(at: u32, ty: Type) -> Cells {
    Cells {
        at,
        len: ty.cells(),
    }
}

/// Returns whether a primitive may run in this form: it has code, and the form matches the presence of its outputs.
fn runs(desc: &PrimDesc, form: Form) -> bool {
    let presence = desc.outputs.iter().map(|o| o.presence);
    let strict = presence.clone().all(|p| p == Presence::Strict);
    let maybe = presence.clone().any(|p| p == Presence::Maybe);
    desc.role == Role::Compute
        && match form {
            Form::Total => !maybe,
            Form::Optional => !strict,
        }
}

fn sized(desc: &PrimDesc) -> bool {
    !matches!(desc.shape, Shape::Fixed) || matches!(desc.state, State::Sized(_))
}

fn port_type(ty: PortType, words: &[u32]) -> Type {
    match ty {
        PortType::One(s) => Type::One(s),
        PortType::Array(s) => Type::Array(s, words[1]),
        PortType::Matrix => Type::Matrix(words[1], words[2]),
    }
}

/// Returns the type of a parameter. Texts have no operand, so the last case does not occur.
fn param_type(ty: ParamType, words: &[u32]) -> Type {
    match ty {
        ParamType::One(s) => Type::One(s),
        ParamType::Array(s) => Type::Array(s, words[1]),
        ParamType::Str => Type::One(Scalar::Bool),
    }
}
