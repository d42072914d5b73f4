//! Stable 64-bit hashes: result identities, signatures of primitives and the checksum of a file.

use crate::desc::PrimDesc;
use core::fmt::{self, Write};

/// State of an FNV-1a hash, 64 bit (Fowler, Noll, Vo; draft-eastlake-fnv). It detects accidental changes, not attacks.
#[derive(Clone, Copy, Debug)]
pub struct Fnv1a(u64);

impl Fnv1a {
    /// Creates the hash of the empty byte string (the offset basis).
    #[must_use]
    pub const fn new() -> Self {
        Fnv1a(0xcbf2_9ce4_8422_2325)
    }

    /// Returns the hash extended by `bytes`.
    #[must_use]
    pub const fn with_bytes(self, bytes: &[u8]) -> Self {
        let (mut hash, mut k) = (self.0, 0);
        while k < bytes.len() {
            hash = (hash ^ bytes[k] as u64).wrapping_mul(0x0000_0100_0000_01b3);
            k += 1;
        }
        Fnv1a(hash)
    }

    /// Returns the 64-bit hash of all bytes so far.
    #[must_use]
    pub const fn finish(self) -> u64 {
        self.0
    }
}

impl core::default::Default for Fnv1a {
    fn default() -> Self {
        Self::new()
    }
}

impl Write for Fnv1a {
    fn write_str(&mut self, s: &str) -> fmt::Result {
        *self = self.with_bytes(s.as_bytes());
        Ok(())
    }
}

/// Returns a number that identifies a result of a command: the FNV-1a hash of the text `command.result`, as a signed
/// integer. The flow [`CommandFlow::Predecessor`](crate::desc::CommandFlow::Predecessor) has this value in the next
/// command.
#[must_use]
pub fn result_id(command: &str, result: &str) -> i64 {
    let hash = Fnv1a::new().with_bytes(command.as_bytes()).with_bytes(b".");
    hash.with_bytes(result.as_bytes()).finish().cast_signed()
}

/// Returns the signature of a primitive: the hash of its name, ports, parameters and state size. An image with another
/// signature for the primitive was compiled for another declaration.
#[must_use]
pub fn prim_signature(desc: &PrimDesc) -> u64 {
    let mut hash = Fnv1a::new();
    // Writing to a hash cannot fail.
    let _ = write_signature(&mut hash, desc);
    hash.finish()
}

fn write_signature(out: &mut Fnv1a, desc: &PrimDesc) -> fmt::Result {
    write!(out, "{}", desc.name)?;
    for port in desc.inputs {
        write!(out, ";{}:{:?}", port.name, port.ty)?;
    }
    for port in desc.outputs {
        write!(out, ">{}:{:?}:{:?}", port.name, port.ty, port.presence)?;
    }
    for param in desc.params {
        write!(out, "<{}:{:?}", param.name, param.ty)?;
    }
    // A size function cannot be hashed. The verifier calls it and compares its result with the operand.
    match desc.state {
        crate::StateSize::None => out.write_str("-"),
        crate::StateSize::Fixed(n) => write!(out, "#{n}"),
        crate::StateSize::Computed(_) => out.write_str("#sized"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_published_one() {
        assert_eq!(Fnv1a::new().finish(), 0xcbf2_9ce4_8422_2325);
        assert_eq!(
            Fnv1a::new().with_bytes(b"a").finish(),
            0xaf63_dc4c_8601_ec8c
        );
        assert_eq!(
            Fnv1a::new().with_bytes(b"foobar").finish(),
            0x8594_4171_f739_67e8
        );
    }

    #[test]
    fn a_result_is_named_by_command_and_result() {
        assert_ne!(result_id("A", "b"), result_id("A", "c"));
        assert_eq!(
            result_id("A", "b").cast_unsigned(),
            Fnv1a::new().with_bytes(b"A.b").finish()
        );
    }
}
