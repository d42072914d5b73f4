//! Machine integers of Kind 2: so many bits, with or without sign, whose results wrap around.

use std::fmt;

/// Width and sign of a machine integer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MachineInt {
    /// Number of bits, from 1 to 64.
    pub bits: u8,
    /// Whether values have a sign.
    pub signed: bool,
}

impl MachineInt {
    /// The most bits that a value may have here.
    pub const MOST: i64 = 64;

    /// `sint<N>` or `uint<N>`; none for more bits than there are.
    #[must_use]
    pub fn new(signed: bool, bits: i64) -> Option<MachineInt> {
        let bits = u8::try_from(bits).ok()?;
        let is_some = (1..=Self::MOST).contains(&i64::from(bits));
        is_some.then_some(MachineInt { bits, signed })
    }

    /// `int8`, `uint64`
    #[must_use]
    pub fn named(name: &str) -> Option<MachineInt> {
        let (signed, bits) = match name.strip_prefix("uint") {
            Some(bits) => (false, bits),
            None => (true, name.strip_prefix("int")?),
        };
        let bits = bits.parse().ok().filter(|bits| is_common(*bits))?;
        Some(MachineInt { bits, signed })
    }

    /// As the primitives take it: the bits, negative for integers with a sign.
    #[must_use]
    pub fn width(self) -> i64 {
        match self.signed {
            true => -i64::from(self.bits),
            false => i64::from(self.bits),
        }
    }

    /// The operator that converts to it: `int8`, `sint@<25>`.
    #[must_use]
    pub fn conversion(self) -> String {
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
