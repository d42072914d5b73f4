//! Arrays at the ports of primitives: leaves put together, elements taken out, and neither where an array only passes.

use super::families::{Family, member};
use super::signal::{Signal, Wire};
use super::{At, Elab};
use rpi_diag::Span;
use rpi_image::{PortType, Scalar, Type, Value};
use rpi_net::{Input, PortRef};
use rpi_prims::PrimId;

impl Elab<'_> {
    /// What an in-port reads to get a value.
    pub(super) fn input(&mut self, wire: &Wire, port: PortType, at: At, span: Span) -> Input {
        match port {
            PortType::One(scalar) => match wire.first() {
                Some(signal) => self.one_input(signal, scalar, at, span),
                None => Input::Open,
            },
            PortType::Array(scalar) => self.array_input(wire, scalar, at, span),
            PortType::Matrix => self.array_input(wire, Scalar::Real, at, span),
        }
    }

    fn one_input(&mut self, signal: &Signal, scalar: Scalar, at: At, span: Span) -> Input {
        match signal {
            Signal::Const(value) => Input::Const(value.clone()),
            Signal::Port(port) => Input::Port(*port),
            Signal::Element(port, k) => Input::Port(self.element(*port, *k, span)),
            Signal::Absent => match self.absent(scalar, at, span) {
                Some(port) => Input::Port(port),
                None => Input::Open,
            },
        }
    }

    /// A flow that is never present.
    pub(super) fn absent(&mut self, scalar: Scalar, at: At, span: Span) -> Option<PortRef> {
        let prim = member(Family::SetNull, scalar)?;
        let value = Input::Const(Value::neutral(Type::One(scalar)));
        let inputs = vec![value, Input::Const(Value::bool(true))];
        let params = super::nodes::default_params(prim);
        let node = self.node(
            prim,
            inputs,
            params,
            vec![Type::One(scalar)],
            at.fragment,
            span,
        );
        Some(PortRef { node, port: 0 })
    }

    /// The port of one element of an array port; taken out once, beside the array.
    pub(super) fn element(&mut self, array: PortRef, k: u32, span: Span) -> PortRef {
        if let Some(port) = self.elements.get(&(array, k)) {
            return *port;
        }
        let source = self.net.node(array.node);
        let (fragment, ty) = (
            source.fragment,
            source.outputs.get(usize::from(array.port)).copied(),
        );
        let port = match ty {
            Some(Type::Array(scalar, n)) => {
                self.array_get(array, scalar, n, k, At::fragment(fragment), span)
            }
            Some(Type::Matrix(_, cols)) => {
                self.matrix_get(array, cols, k, At::fragment(fragment), span)
            }
            _ => None,
        };
        let port = port.unwrap_or(array);
        self.elements.insert((array, k), port);
        port
    }

    fn array_get(
        &mut self,
        array: PortRef,
        scalar: Scalar,
        n: u32,
        k: u32,
        at: At,
        span: Span,
    ) -> Option<PortRef> {
        let prim = member(Family::ArrayGet, scalar)?;
        let params = sized_params(prim, &[("Size", n), ("Index", k)]);
        let node = self.node(
            prim,
            vec![Input::Port(array)],
            params,
            vec![Type::One(scalar)],
            at.fragment,
            span,
        );
        Some(PortRef { node, port: 0 })
    }

    fn matrix_get(
        &mut self,
        array: PortRef,
        cols: u32,
        k: u32,
        at: At,
        span: Span,
    ) -> Option<PortRef> {
        let prim = PrimId::of("Core::MatrixGet")?;
        let params = sized_params(prim, &[("Row", k / cols.max(1)), ("Col", k % cols.max(1))]);
        let node = self.node(
            prim,
            vec![Input::Port(array)],
            params,
            vec![Type::One(Scalar::Real)],
            at.fragment,
            span,
        );
        Some(PortRef { node, port: 0 })
    }

    fn array_input(&mut self, wire: &Wire, scalar: Scalar, at: At, span: Span) -> Input {
        if let Some(port) = self.whole(wire) {
            return Input::Port(port);
        }
        if let Some(values) = wire.iter().map(constant).collect::<Option<Vec<Value>>>() {
            return Input::Const(crate::check::packed(scalar, &values));
        }
        match self.array_of(wire, scalar, at, span) {
            Some(port) => Input::Port(port),
            None => Input::Open,
        }
    }

    /// The array port that the leaves are all elements of, in order.
    fn whole(&self, wire: &Wire) -> Option<PortRef> {
        let Some(Signal::Element(array, 0)) = wire.first() else {
            return None;
        };
        let in_order = (0..)
            .zip(wire.iter())
            .all(|(k, s)| *s == Signal::Element(*array, k));
        let ty = self
            .net
            .node(array.node)
            .outputs
            .get(usize::from(array.port))?;
        let len = match ty {
            Type::Array(_, n) => *n,
            Type::Matrix(rows, cols) => rows * cols,
            Type::One(_) => return None,
        };
        (in_order && wire.len() == len as usize).then_some(*array)
    }

    /// A new array, filled element by element.
    fn array_of(&mut self, wire: &Wire, scalar: Scalar, at: At, span: Span) -> Option<PortRef> {
        let n = u32::try_from(wire.len()).ok()?;
        let (make, set) = (
            member(Family::Array, scalar)?,
            member(Family::ArraySet, scalar)?,
        );
        let ty = Type::Array(scalar, n);
        let node = self.node(
            make,
            Vec::new(),
            sized_params(make, &[("Size", n)]),
            vec![ty],
            at.fragment,
            span,
        );
        let mut array = PortRef { node, port: 0 };
        for (k, signal) in (0..n).zip(wire.iter()) {
            let value = self.one_input(signal, scalar, at, span);
            let params = sized_params(set, &[("Size", n), ("Index", k)]);
            let node = self.node(
                set,
                vec![Input::Port(array), value],
                params,
                vec![ty],
                at.fragment,
                span,
            );
            array = PortRef { node, port: 0 };
        }
        Some(array)
    }

    /// The port of a signal, for what takes nothing but ports.
    pub(super) fn port_of(
        &mut self,
        signal: &Signal,
        scalar: Scalar,
        at: At,
        span: Span,
    ) -> Option<PortRef> {
        match signal {
            Signal::Const(value) => {
                let prim = member(Family::Value, scalar)?;
                let node = self.node(
                    prim,
                    Vec::new(),
                    vec![value.clone()],
                    vec![Type::One(scalar)],
                    at.fragment,
                    span,
                );
                Some(PortRef { node, port: 0 })
            }
            other => match self.one_input(other, scalar, at, span) {
                Input::Port(port) => Some(port),
                _ => None,
            },
        }
    }
}

/// Parameters of a primitive, by name where given, else by default.
fn sized_params(prim: PrimId, given: &[(&str, u32)]) -> Vec<Value> {
    let value = |param: &rpi_image::Param| {
        let given = given.iter().find(|(name, _)| *name == param.name);
        given
            .map(|(_, v)| Value::int((*v).into()))
            .or_else(|| crate::check::param_default(param))
    };
    prim.desc().params.iter().filter_map(value).collect()
}

fn constant(signal: &Signal) -> Option<Value> {
    match signal {
        Signal::Const(value) => Some(value.clone()),
        _ => None,
    }
}
