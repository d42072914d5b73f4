//! Binary layout of plain data in a file or message: little endian, lengths before contents. The reader checks all input.
//!
//! Images use it, and messages that contain images. [`encode_struct!`](crate::encode_struct) and
//! [`encode_enum!`](crate::encode_enum) implement it for the types of other crates.

use alloc::string::String;
use alloc::vec::Vec;

/// Error when reading an image file (`.rpib`). Positions are offsets in bytes from the start of the content after the
/// header.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ReadError {
    /// The file does not start with the magic number of an image.
    NotAnImage,
    /// The file has this version of the format, which differs from the version of this build.
    UnsupportedVersion(u16),
    /// The checksum in the header does not match the content of the file.
    ChecksumMismatch,
    /// The file ends too early, or a length exceeds the remaining bytes. The field is the position of the missing data
    /// or of the length, in bytes.
    Truncated(usize),
    /// The value at this position (in bytes) is not one that its field can have, such as 2 for a Boolean.
    InvalidValue(usize),
    /// There are unexpected bytes after the end of the image. The field is the position of the first one.
    TrailingBytes(usize),
}

impl core::fmt::Display for ReadError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            ReadError::NotAnImage => f.write_str("this is not a compiled image (.rpib)"),
            ReadError::UnsupportedVersion(v) => write!(f, "unsupported format version {v}"),
            ReadError::ChecksumMismatch => f.write_str("the content is damaged: checksum mismatch"),
            ReadError::Truncated(at) => write!(f, "unexpected end of the file at byte {at}"),
            ReadError::InvalidValue(at) => write!(f, "invalid content at byte {at}"),
            ReadError::TrailingBytes(at) => write!(
                f,
                "unexpected content after the end of the image, at byte {at}"
            ),
        }
    }
}

impl core::error::Error for ReadError {}

/// Cursor over the bytes of a file or message, from which values are read in order.
#[derive(Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    /// Creates a cursor at the first of these bytes.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Reader { bytes, at: 0 }
    }

    fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn take(&mut self, n: usize) -> Result<&'a [u8], ReadError> {
        let end = self
            .at
            .checked_add(n)
            .ok_or(ReadError::Truncated(self.at))?;
        let bytes = self.bytes.get(self.at..end);
        let bytes = bytes.ok_or(ReadError::Truncated(self.at))?;
        self.at = end;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let at = self.at;
        self.take(N)?
            .try_into()
            .map_err(|_| ReadError::Truncated(at))
    }

    /// Reads the length of a list whose items need at least `least` bytes each. Returns [`ReadError::Truncated`] if the
    /// remaining bytes cannot hold that many items.
    fn count(&mut self, least: usize) -> Result<usize, ReadError> {
        let at = self.at;
        let count = u32::decode(self)? as usize;
        let is_possible = count <= self.remaining() / least.max(1);
        is_possible.then_some(count).ok_or(ReadError::Truncated(at))
    }

    /// Returns an error: the byte that was read last is not a value of its type.
    ///
    /// # Errors
    /// Always, with the position of the byte.
    pub const fn invalid_value<T>(&self) -> Result<T, ReadError> {
        Err(ReadError::InvalidValue(self.at.saturating_sub(1)))
    }

    /// Ensures that all bytes were read.
    ///
    /// # Errors
    /// If bytes are left.
    pub fn expect_end(&self) -> Result<(), ReadError> {
        match self.remaining() {
            0 => Ok(()),
            _ => Err(ReadError::TrailingBytes(self.at)),
        }
    }
}

/// Type that has a binary form: how its values are written and read.
pub trait Encoding: Sized {
    /// Minimum number of bytes of an encoded value. The reader rejects a list whose length exceeds the remaining bytes
    /// divided by this minimum, so that a wrong length cannot cause a huge allocation.
    const MIN_BYTES: usize;
    /// Appends the binary form of the value.
    fn encode(&self, out: &mut Vec<u8>);
    /// Reads a value.
    ///
    /// # Errors
    /// If the bytes end too early or are not a value of this type.
    fn decode(from: &mut Reader<'_>) -> Result<Self, ReadError>;
}

macro_rules! numbers {
    ($($t:ty),*) => { $(
        impl Encoding for $t {
            const MIN_BYTES: usize = size_of::<$t>();
            fn encode(&self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }
            fn decode(from: &mut Reader<'_>) -> Result<Self, ReadError> {
                from.array().map(Self::from_le_bytes)
            }
        }
    )* };
}

numbers!(u8, u16, u32, u64);

impl Encoding for usize {
    const MIN_BYTES: usize = u64::MIN_BYTES;
    fn encode(&self, out: &mut Vec<u8>) {
        (*self as u64).encode(out);
    }
    fn decode(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        let number = usize::try_from(u64::decode(from)?);
        number.or_else(|_| from.invalid_value())
    }
}

impl Encoding for bool {
    const MIN_BYTES: usize = 1;
    fn encode(&self, out: &mut Vec<u8>) {
        out.push(u8::from(*self));
    }
    fn decode(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        match u8::decode(from)? {
            0 => Ok(false),
            1 => Ok(true),
            _ => from.invalid_value(),
        }
    }
}

impl Encoding for String {
    const MIN_BYTES: usize = u32::MIN_BYTES;
    fn encode(&self, out: &mut Vec<u8>) {
        put_len(self.len(), out);
        out.extend_from_slice(self.as_bytes());
    }
    fn decode(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        let len = from.count(1)?;
        let at = from.at;
        let text = core::str::from_utf8(from.take(len)?);
        text.map(String::from)
            .map_err(|_| ReadError::InvalidValue(at))
    }
}

impl<T: Encoding> Encoding for Vec<T> {
    const MIN_BYTES: usize = u32::MIN_BYTES;
    fn encode(&self, out: &mut Vec<u8>) {
        put_len(self.len(), out);
        for item in self {
            item.encode(out);
        }
    }
    fn decode(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        let count = from.count(T::MIN_BYTES)?;
        let mut items = Vec::with_capacity(count);
        for _ in 0..count {
            items.push(T::decode(from)?);
        }
        Ok(items)
    }
}

impl<T: Encoding> Encoding for Option<T> {
    const MIN_BYTES: usize = 1;
    fn encode(&self, out: &mut Vec<u8>) {
        out.push(u8::from(self.is_some()));
        if let Some(item) = self {
            item.encode(out);
        }
    }
    fn decode(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        match u8::decode(from)? {
            0 => Ok(None),
            1 => T::decode(from).map(Some),
            _ => from.invalid_value(),
        }
    }
}

impl<A: Encoding, B: Encoding> Encoding for (A, B) {
    const MIN_BYTES: usize = A::MIN_BYTES + B::MIN_BYTES;
    fn encode(&self, out: &mut Vec<u8>) {
        self.0.encode(out);
        self.1.encode(out);
    }
    fn decode(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        Ok((A::decode(from)?, B::decode(from)?))
    }
}

/// Writes a length as `u32`. A length above `u32::MAX` does not occur: the number of slots is bounded, and names come
/// from a compiler.
fn put_len(len: usize, out: &mut Vec<u8>) {
    u32::try_from(len).unwrap_or(u32::MAX).encode(out);
}

/// Bytes of an encoded value.
pub type Bytes = Vec<u8>;

/// Implements [`Encoding`](crate::encoding::Encoding) for a struct: its fields in the given order.
#[macro_export]
macro_rules! encode_struct {
    ($t:ident { $($field:ident : $ty:ty),* $(,)? }) => {
        impl $crate::encoding::Encoding for $t {
            const MIN_BYTES: usize = 0 $( + <$ty as $crate::encoding::Encoding>::MIN_BYTES )*;
            fn encode(&self, out: &mut $crate::encoding::Bytes) {
                $( $crate::encoding::Encoding::encode(&self.$field, out); )*
            }
            fn decode(from: &mut $crate::encoding::Reader<'_>) -> Result<Self, $crate::encoding::ReadError> {
                Ok($t { $( $field: $crate::encoding::Encoding::decode(from)? ),* })
            }
        }
    };
}

/// Implements [`Encoding`](crate::encoding::Encoding) for an enum: the number of the variant (one byte), then its fields in the given order.
#[macro_export]
macro_rules! encode_enum {
    ($t:ident { $($tag:literal = $variant:ident $( { $($field:ident),* } )? $( ( $($item:ident),* ) )? ),* $(,)? }) => {
        impl $crate::encoding::Encoding for $t {
            const MIN_BYTES: usize = 1;
            fn encode(&self, out: &mut $crate::encoding::Bytes) {
                match self {
                    $( $t::$variant $( { $($field),* } )? $( ( $($item),* ) )? => {
                        out.push($tag);
                        $( $( $crate::encoding::Encoding::encode($field, out); )* )?
                        $( $( $crate::encoding::Encoding::encode($item, out); )* )?
                    } )*
                }
            }
            fn decode(from: &mut $crate::encoding::Reader<'_>) -> Result<Self, $crate::encoding::ReadError> {
                let tag: u8 = $crate::encoding::Encoding::decode(from)?;
                Ok(match tag {
                    $( $tag => $t::$variant
                        $( { $($field: $crate::encoding::Encoding::decode(from)?),* } )?
                        $( ( $({ let $item = $crate::encoding::Encoding::decode(from)?; $item }),* ) )?, )*
                    _ => return from.invalid_value(),
                })
            }
        }
    };
}
