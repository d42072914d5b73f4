//! Abstraction over the values of a cycle: literals and terms for proofs, plain values for runs. The rules of
//! activation, presence and state are written once over it, in [`super::cycle`] and [`super::gates`].

use crate::net::{Node, PortRef};
use rpi_image::{CommandFlow, Type, Value};

/// Source of a value that the net itself does not compute.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) enum Source {
    /// Flow that the control core provides. All nodes that read it read the same value.
    Core(CommandFlow),
    /// Port of a device.
    Sensor {
        device: String,
        port: String,
        index: i64,
    },
    /// Input of the command that is set from outside, by key.
    Outside(String),
    /// Out-port of a primitive that is not modelled, so that its value is unconstrained.
    Port(PortRef),
}

/// Flow in one cycle: its presence, and its value if it is present.
#[derive(Debug)]
pub(super) struct Flow<D: Domain + ?Sized> {
    pub(super) present: D::Bool,
    pub(super) value: D::Value,
}

// A derived `Clone` would require `D: Clone`.
impl<D: Domain + ?Sized> Clone for Flow<D> {
    fn clone(&self) -> Self {
        Flow {
            present: self.present,
            value: self.value.clone(),
        }
    }
}

/// Operations on Booleans and values for the computation of a cycle, with concrete or with symbolic values.
pub(super) trait Domain {
    /// Representation of a Boolean: `bool` for concrete values, a formula for symbolic ones.
    type Bool: Copy + std::fmt::Debug;
    /// Type of a value of any flow type in the domain.
    type Value: Clone + std::fmt::Debug;

    fn bit(&self, value: bool) -> Self::Bool;
    fn not(&mut self, a: Self::Bool) -> Self::Bool;
    fn and(&mut self, a: Self::Bool, b: Self::Bool) -> Self::Bool;
    /// Converts a constant of the net to a value.
    fn constant(&mut self, value: &Value) -> Self::Value;
    /// Converts a Boolean to a value.
    fn boolean(&mut self, bit: Self::Bool) -> Self::Value;
    /// Converts a Boolean value to a Boolean.
    fn truth(&mut self, value: &Self::Value) -> Self::Bool;
    fn choose(&mut self, condition: Self::Bool, yes: &Self::Value, no: &Self::Value)
    -> Self::Value;
    /// Returns the external value of a source in this cycle, which may be absent if `may_be_absent`.
    fn source(&mut self, source: Source, ty: Type, may_be_absent: bool) -> Flow<Self>;
    /// Applies a stateless primitive with strict presence to inputs that are all present. `runs` says whether they are
    /// and the fragment is active.
    fn apply(&mut self, node: &Node, inputs: &[Self::Value], runs: Self::Bool) -> Vec<Self::Value>;
    /// Returns an unconstrained out-port. It is present if `surely` holds, and absent unless `runs` holds. `inputs` are
    /// the flows that it depends on; `None` if it has state of its own.
    fn unknown(
        &mut self,
        port: (PortRef, &Node),
        inputs: Option<&[Flow<Self>]>,
        surely: Self::Bool,
        runs: Self::Bool,
    ) -> Flow<Self>;

    fn or(&mut self, a: Self::Bool, b: Self::Bool) -> Self::Bool {
        let (a, b) = (self.not(a), self.not(b));
        let neither = self.and(a, b);
        self.not(neither)
    }

    fn choose_bit(&mut self, condition: Self::Bool, yes: Self::Bool, no: Self::Bool) -> Self::Bool {
        let otherwise = self.not(condition);
        let (left, right) = (self.and(condition, yes), self.and(otherwise, no));
        self.or(left, right)
    }

    fn all(&mut self, bits: impl IntoIterator<Item = Self::Bool>) -> Self::Bool
    where
        Self: Sized,
    {
        let yes = self.bit(true);
        bits.into_iter().fold(yes, |all, bit| self.and(all, bit))
    }

    fn choose_flow(
        &mut self,
        condition: Self::Bool,
        yes: &Flow<Self>,
        no: &Flow<Self>,
    ) -> Flow<Self> {
        Flow {
            present: self.choose_bit(condition, yes.present, no.present),
            value: self.choose(condition, &yes.value, &no.value),
        }
    }

    /// Returns whether a Boolean flow has a value in the cycle, and the value is true.
    fn is_true(&mut self, flow: &Flow<Self>) -> Self::Bool {
        let value = self.truth(&flow.value);
        self.and(flow.present, value)
    }
}
