//! Abstraction over the values of a cycle: literals and terms for proofs, plain values for runs. The rules of
//! activation, presence and state are written once over it, in [`super::cycle`] and [`super::gates`].

use crate::net::{Node, PortRef};
use rpi_image::{CommandFlow, Type, Value};

/// Source of a value that enters the net from outside, or that the model checker does not compute.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) enum Source {
    /// Flow that the control core provides, such as the time. All nodes that read it get the same value.
    Core(CommandFlow),
    /// Sensor port of a device; `index` selects one of several equal ports.
    Sensor {
        device: String,
        port: String,
        index: i64,
    },
    /// Input of the command that the host sets, by its key.
    Outside(String),
    /// Out-port of a primitive that is not modelled. Its value is unconstrained.
    Port(PortRef),
}

/// Flow in one cycle: whether it is present, and its value, which has a meaning only if it is present.
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

/// Operations on Booleans and values with which a cycle is evaluated. There are a concrete and a symbolic
/// implementation.
pub(super) trait Domain {
    /// Representation of a Boolean: a truth value for concrete execution, a literal of the solver for symbolic
    /// execution.
    type Bool: Copy + std::fmt::Debug;
    /// Representation of the value of a flow of any type.
    type Value: Clone + std::fmt::Debug;

    fn bit(&self, value: bool) -> Self::Bool;
    fn not(&mut self, a: Self::Bool) -> Self::Bool;
    fn and(&mut self, a: Self::Bool, b: Self::Bool) -> Self::Bool;
    /// Converts a constant of the net to a value of the domain.
    fn constant(&mut self, value: &Value) -> Self::Value;
    /// Converts a Boolean of the domain to the value of a Boolean flow.
    fn boolean(&mut self, bit: Self::Bool) -> Self::Value;
    /// Converts the value of a Boolean flow to a Boolean of the domain.
    fn truth(&mut self, value: &Self::Value) -> Self::Bool;
    fn choose(&mut self, condition: Self::Bool, yes: &Self::Value, no: &Self::Value)
    -> Self::Value;
    /// Returns the external value of a source in the current cycle. It may be absent if `may_be_absent` is true.
    fn source(&mut self, source: Source, ty: Type, may_be_absent: bool) -> Flow<Self>;
    /// Returns the outputs of a stateless primitive whose outputs are present exactly if all inputs are. `runs` is true
    /// if all inputs are present and the fragment is active.
    fn apply(&mut self, node: &Node, inputs: &[Self::Value], runs: Self::Bool) -> Vec<Self::Value>;
    /// Returns an unconstrained value for an out-port. The out-port is present if `surely` is true, and absent if
    /// `runs` is false. `inputs` are the flows on which it depends; `None` if the primitive has state.
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

    /// Returns whether a Boolean flow is present in the cycle and true.
    fn is_true(&mut self, flow: &Flow<Self>) -> Self::Bool {
        let value = self.truth(&flow.value);
        self.and(flow.present, value)
    }
}
