//! What a cycle is computed over: literals and terms for proofs, plain values for runs. The rules of activation, presence and
//! state are written once, in [`super::cycle`] and [`super::gates`], over this.

use crate::net::{Node, PortRef};
use rpi_image::{CommandFlow, Type, Value};

/// Something that a net does not decide itself.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) enum Source {
    /// A flow of the core; all nodes that read it read the same.
    Core(CommandFlow),
    /// A port of a device.
    Sensor {
        device: String,
        port: String,
        index: i64,
    },
    /// A value that is set from outside, by key.
    Outside(String),
    /// An out-port of which nothing is known.
    Port(PortRef),
}

/// A flow in one cycle: whether it is present, and its value if so.
#[derive(Debug)]
pub(super) struct Flow<D: Domain + ?Sized> {
    pub(super) present: D::Bit,
    pub(super) value: D::Value,
}

// Derived, it would ask for a domain that can be cloned.
impl<D: Domain + ?Sized> Clone for Flow<D> {
    fn clone(&self) -> Self {
        Flow {
            present: self.present,
            value: self.value.clone(),
        }
    }
}

/// Truth values and values.
pub(super) trait Domain {
    /// A truth value.
    type Bit: Copy + std::fmt::Debug;
    /// A value of any type.
    type Value: Clone + std::fmt::Debug;

    fn bit(&self, value: bool) -> Self::Bit;
    fn not(&mut self, a: Self::Bit) -> Self::Bit;
    fn and(&mut self, a: Self::Bit, b: Self::Bit) -> Self::Bit;
    /// A constant.
    fn constant(&mut self, value: &Value) -> Self::Value;
    /// The Boolean that a truth value is.
    fn boolean(&mut self, bit: Self::Bit) -> Self::Value;
    /// The truth value of a Boolean.
    fn truth(&mut self, value: &Self::Value) -> Self::Bit;
    fn choose(&mut self, condition: Self::Bit, yes: &Self::Value, no: &Self::Value) -> Self::Value;
    /// A value from outside in this cycle; whether it may be absent.
    fn source(&mut self, source: Source, ty: Type, may_be_absent: bool) -> Flow<Self>;
    /// The out-ports of a stateless primitive with strict presence where all in-ports are present; `runs` tells whether they
    /// are and its fragment is active.
    fn apply(&mut self, node: &Node, inputs: &[Self::Value], runs: Self::Bit) -> Vec<Self::Value>;
    /// An out-port of which only its type is known, and when it is present: surely, if `surely` holds, and never unless
    /// `runs` does. `inputs` is what it depends on; nothing if it has a memory of its own.
    fn unknown(
        &mut self,
        port: (PortRef, &Node),
        inputs: Option<&[Flow<Self>]>,
        surely: Self::Bit,
        runs: Self::Bit,
    ) -> Flow<Self>;

    fn or(&mut self, a: Self::Bit, b: Self::Bit) -> Self::Bit {
        let (a, b) = (self.not(a), self.not(b));
        let neither = self.and(a, b);
        self.not(neither)
    }

    fn choose_bit(&mut self, condition: Self::Bit, yes: Self::Bit, no: Self::Bit) -> Self::Bit {
        let otherwise = self.not(condition);
        let (left, right) = (self.and(condition, yes), self.and(otherwise, no));
        self.or(left, right)
    }

    fn all(&mut self, bits: impl IntoIterator<Item = Self::Bit>) -> Self::Bit
    where
        Self: Sized,
    {
        let yes = self.bit(true);
        bits.into_iter().fold(yes, |all, bit| self.and(all, bit))
    }

    fn choose_flow(
        &mut self,
        condition: Self::Bit,
        yes: &Flow<Self>,
        no: &Flow<Self>,
    ) -> Flow<Self> {
        Flow {
            present: self.choose_bit(condition, yes.present, no.present),
            value: self.choose(condition, &yes.value, &no.value),
        }
    }

    /// Whether a flow is present and true.
    fn is_true(&mut self, flow: &Flow<Self>) -> Self::Bit {
        let value = self.truth(&flow.value);
        self.and(flow.present, value)
    }
}
