//! Access to ports through operand words.
//!
//! The operands of a step are slot numbers. A port that is always present has one word: its first slot. An array has a
//! second word with its length; a matrix has two more words with its rows and columns. A port that may be absent has
//! one more word at the end: its presence slot.

use crate::aggregates::{Array, Matrix};
pub use crate::value_types::{FlowType, Pose, Rotation, Time, Twist, Vector, Wrench};
use rpi_image::{ParamType, PortType};

/// Type of an operand of a primitive, which is read and written through operand words: a port, or a tuple of ports.
pub trait Operand: Sized {
    /// Number of 32-bit words that encode an operand of this type in an image.
    const WORDS: usize;
    /// Reads the value from the memory `cells`; `words` starts at the first operand word of the value.
    fn read(cells: &[u64], words: &[u32]) -> Self;
    /// Writes the value to the memory `cells`; `words` starts at the first operand word of the value.
    fn write(self, cells: &mut [u64], words: &[u32]);
}

/// Type of a single port that is always present.
pub trait Port: Operand + Copy {
    /// Type of the port in the declaration of a primitive.
    const TYPE: PortType;
    /// Returns the value used if the code of a primitive outputs no value although its output must be present.
    fn neutral() -> Self;
}

/// Type of a parameter of a primitive.
pub trait Parameter: Operand {
    /// Type of the parameter in the declaration of a primitive.
    const TYPE: ParamType;
}

/// Text parameter. Only the loader uses its value, so it has no operand words.
#[derive(Clone, Copy, Debug)]
pub struct Text;

impl Operand for Text {
    const WORDS: usize = 0;
    fn read(_: &[u64], _: &[u32]) -> Self {
        Text
    }
    fn write(self, _: &mut [u64], _: &[u32]) {}
}

impl Parameter for Text {
    const TYPE: ParamType = ParamType::Str;
}

macro_rules! single_values {
    ($($t:ty),*) => { $(
        impl Operand for $t {
            const WORDS: usize = 1;
            #[inline(always)]
            fn read(cells: &[u64], words: &[u32]) -> Self {
                Self::load(cells, words[0] as usize)
            }
            #[inline(always)]
            fn write(self, cells: &mut [u64], words: &[u32]) {
                self.store(cells, words[0] as usize);
            }
        }
        impl Port for $t {
            const TYPE: PortType = PortType::Scalar(<$t as FlowType>::SCALAR);
            #[inline(always)]
            fn neutral() -> Self {
                <$t as FlowType>::neutral()
            }
        }
        impl Parameter for $t {
            const TYPE: ParamType = ParamType::Scalar(<$t as FlowType>::SCALAR);
        }
    )* };
}

single_values!(bool, i64, f64, Time, Vector, Rotation, Pose, Twist, Wrench);

/// Array as an operand: the code gets a handle to its slots and writes array outputs itself.
impl<T: FlowType> Operand for Array<T> {
    const WORDS: usize = 2;
    #[inline(always)]
    fn read(_: &[u64], words: &[u32]) -> Self {
        Array::new(words[0] as usize, words[1] as usize)
    }
    #[inline(always)]
    fn write(self, _: &mut [u64], _: &[u32]) {}
}

impl<T: FlowType> Port for Array<T> {
    const TYPE: PortType = PortType::Array(T::SCALAR);
    fn neutral() -> Self {
        Array::new(0, 0)
    }
}

impl<T: FlowType> Parameter for Array<T> {
    const TYPE: ParamType = ParamType::Array(T::SCALAR);
}

impl Operand for Matrix {
    const WORDS: usize = 3;
    #[inline(always)]
    fn read(_: &[u64], words: &[u32]) -> Self {
        Matrix::new(words[0] as usize, words[1] as usize, words[2] as usize)
    }
    #[inline(always)]
    fn write(self, _: &mut [u64], _: &[u32]) {}
}

impl Port for Matrix {
    const TYPE: PortType = PortType::Matrix;
    fn neutral() -> Self {
        Matrix::new(0, 0, 0)
    }
}

/// Port that may be absent, as an operand. Writing an absent output leaves its value slots unchanged.
impl<T: Port> Operand for Option<T> {
    const WORDS: usize = T::WORDS + 1;
    #[inline(always)]
    fn read(cells: &[u64], words: &[u32]) -> Self {
        (cells[words[T::WORDS] as usize] != 0).then(|| T::read(cells, words))
    }
    #[inline(always)]
    fn write(self, cells: &mut [u64], words: &[u32]) {
        cells[words[T::WORDS] as usize] = u64::from(self.is_some());
        if let Some(value) = self {
            value.write(cells, words);
        }
    }
}

/// Tuple of ports that are always present, with the corresponding tuple of ports that may be absent.
pub trait PortTuple: Operand {
    /// Ports of the same types whose values may be absent.
    type Options: Operand;
    /// Converts values that are all present to options.
    fn into_options(self) -> Self::Options;
    /// Returns the values of the options. A missing value, which violates the presence rule of the primitive, becomes
    /// the neutral value of its type.
    fn unwrap_or_neutral(maybe: Self::Options) -> Self;
}

/// State that a primitive stores from cycle to cycle.
pub trait PrimState: Sized {
    /// Number of 32-bit operand words in an image that locate the state.
    const WORDS: usize;
    /// Number of 64-bit slots of the state in memory; 0 if the number depends on parameters.
    const SLOTS: u32;
    /// Reads the state from the memory `cells`; `words` starts at its first operand word.
    fn load(cells: &[u64], words: &[u32]) -> Self;
    /// Writes the state to the memory `cells`; `words` starts at its first operand word.
    fn store(self, cells: &mut [u64], words: &[u32]);
}

/// Component of a state of fixed size, such as a real or a pose.
pub trait StateField: Sized {
    /// Number of 64-bit slots that the component takes in memory.
    const SLOTS: usize;
    /// Reads the component from the slots `cells[at..]`.
    fn load_state(cells: &[u64], at: usize) -> Self;
    /// Writes the component to the slots `cells[at..]`.
    fn store_state(self, cells: &mut [u64], at: usize);
}

impl<T: FlowType> StateField for T {
    const SLOTS: usize = <T as FlowType>::SLOTS;
    #[inline(always)]
    fn load_state(cells: &[u64], at: usize) -> Self {
        <T as FlowType>::load(cells, at)
    }
    #[inline(always)]
    fn store_state(self, cells: &mut [u64], at: usize) {
        FlowType::store(self, cells, at);
    }
}

/// Array of reals as a component of a state, one slot per element.
impl<const N: usize> StateField for [f64; N] {
    const SLOTS: usize = N;
    #[inline(always)]
    fn load_state(cells: &[u64], at: usize) -> Self {
        core::array::from_fn(|k| f64::from_bits(cells[at + k]))
    }
    #[inline(always)]
    fn store_state(self, cells: &mut [u64], at: usize) {
        let slots = &mut cells[at..at + N];
        slots
            .iter_mut()
            .zip(self)
            .for_each(|(slot, value)| *slot = value.to_bits());
    }
}

macro_rules! tuples {
    ($(($($t:ident . $i:tt),*))*) => { $(
        impl<$($t: Operand),*> Operand for ($($t,)*) {
            const WORDS: usize = 0 $(+ $t::WORDS)*;
            #[inline(always)]
            #[allow(unused_variables, unused_mut, unused_assignments, clippy::unused_unit)]
            fn read(cells: &[u64], words: &[u32]) -> Self {
                let mut at = 0;
                ($({ let v = $t::read(cells, &words[at..]); at += $t::WORDS; v },)*)
            }
            #[inline(always)]
            #[allow(unused_variables, unused_mut, unused_assignments)]
            fn write(self, cells: &mut [u64], words: &[u32]) {
                let mut at = 0;
                $( self.$i.write(cells, &words[at..]); at += $t::WORDS; )*
            }
        }
        impl<$($t: Port),*> PortTuple for ($($t,)*) {
            type Options = ($(Option<$t>,)*);
            #[inline(always)]
            #[allow(clippy::unused_unit)]
            fn into_options(self) -> Self::Options {
                ($(Some(self.$i),)*)
            }
            #[inline(always)]
            #[allow(unused_variables, clippy::unused_unit)]
            fn unwrap_or_neutral(maybe: Self::Options) -> Self {
                ($(maybe.$i.unwrap_or_else(<$t as Port>::neutral),)*)
            }
        }
        /// State of fixed size: a tuple of components, stored contiguously.
        impl<$($t: StateField),*> PrimState for ($($t,)*) {
            const WORDS: usize = (Self::SLOTS > 0) as usize;
            const SLOTS: u32 = 0 $(+ <$t as StateField>::SLOTS as u32)*;
            #[inline(always)]
            #[allow(unused_variables, unused_mut, unused_assignments, clippy::unused_unit)]
            fn load(cells: &[u64], words: &[u32]) -> Self {
                let mut at = words.first().map_or(0, |&w| w as usize);
                ($({ let v = <$t as StateField>::load_state(cells, at); at += <$t as StateField>::SLOTS; v },)*)
            }
            #[inline(always)]
            #[allow(unused_variables, unused_mut, unused_assignments)]
            fn store(self, cells: &mut [u64], words: &[u32]) {
                let mut at = words.first().map_or(0, |&w| w as usize);
                $( <$t as StateField>::store_state(self.$i, cells, at); at += <$t as StateField>::SLOTS; )*
            }
        }
    )* };
}

tuples! {
    ()
    (A.0)
    (A.0, B.1)
    (A.0, B.1, C.2)
    (A.0, B.1, C.2, D.3)
    (A.0, B.1, C.2, D.3, E.4)
    (A.0, B.1, C.2, D.3, E.4, F.5)
    (A.0, B.1, C.2, D.3, E.4, F.5, G.6)
    (A.0, B.1, C.2, D.3, E.4, F.5, G.6, H.7)
    (A.0, B.1, C.2, D.3, E.4, F.5, G.6, H.7, I.8)
    (A.0, B.1, C.2, D.3, E.4, F.5, G.6, H.7, I.8, J.9)
}
