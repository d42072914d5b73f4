//! Machine integers of Kind 2: a fixed number of bits, signed or unsigned, with wrap-around arithmetic.

use std::fmt;

/// Machine integer type of Kind 2: its number of bits, and whether it is signed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MachineInt {
    /// Number of bits, from 1 to 64.
    pub bits: u8,
    /// Whether the type is signed (two's complement).
    pub signed: bool,
}

impl MachineInt {
    /// Maximum number of bits that is supported.
    pub const MAX_BITS: i64 = 64;

    /// Creates the type `sint<N>` or `uint<N>` with `bits` bits; `None` if the number of bits is out of range.
    #[must_use]
    pub fn new(signed: bool, bits: i64) -> Option<MachineInt> {
        let bits = u8::try_from(bits).ok()?;
        let is_some = (1..=Self::MAX_BITS).contains(&i64::from(bits));
        is_some.then_some(MachineInt { bits, signed })
    }

    /// Returns the type with a common name such as `int8` or `uint64`; `None` for other names.
    #[must_use]
    pub fn from_name(name: &str) -> Option<MachineInt> {
        let (signed, bits) = match name.strip_prefix("uint") {
            Some(bits) => (false, bits),
            None => (true, name.strip_prefix("int")?),
        };
        let bits = bits.parse().ok().filter(|bits| is_common(*bits))?;
        Some(MachineInt { bits, signed })
    }

    /// Returns the width in the form in which primitives take it as a parameter: the number of bits, negative for a
    /// signed type.
    #[must_use]
    pub fn width_literal(self) -> i64 {
        match self.signed {
            true => -i64::from(self.bits),
            false => i64::from(self.bits),
        }
    }

    /// Returns the name of the operator that converts to this type, such as `int8` or `sint@<25>`.
    #[must_use]
    pub fn conversion_name(self) -> String {
        self.to_string().replace('<', "@<")
    }
}

fn is_common(bits: u8) -> bool {
    matches!(bits, 8 | 16 | 32 | 64)
}

impl fmt::Display for MachineInt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.signed, is_common(self.bits)) {
            (true, true) => write!(f, "int{}", self.bits),
            (false, true) => write!(f, "uint{}", self.bits),
            (true, false) => write!(f, "sint<{}>", self.bits),
            (false, false) => write!(f, "uint<{}>", self.bits),
        }
    }
}
