//! Binary layout of plain data in a file: little endian, lengths before contents. The reader checks all input.

use alloc::string::String;
use alloc::vec::Vec;

/// Error when reading an image file. Positions are byte offsets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ReadError {
    /// The file does not start with the magic number of an image.
    NotAnImage,
    /// The file has this other format version.
    Version(u16),
    /// The checksum does not match the content.
    Checksum,
    /// The file ends too early, or a length exceeds the remaining bytes. The field is the position of the missing data
    /// or of the length.
    Truncated(usize),
    /// Invalid value at this position.
    Unknown(usize),
    /// Unexpected bytes after the end of the image, starting at this position.
    Trailing(usize),
}

impl core::fmt::Display for ReadError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            ReadError::NotAnImage => f.write_str("this is not a compiled image (.rpib)"),
            ReadError::Version(v) => write!(f, "unsupported format version {v}"),
            ReadError::Checksum => f.write_str("the content is damaged: checksum mismatch"),
            ReadError::Truncated(at) => write!(f, "unexpected end of the file at byte {at}"),
            ReadError::Unknown(at) => write!(f, "invalid content at byte {at}"),
            ReadError::Trailing(at) => write!(
                f,
                "unexpected content after the end of the image, at byte {at}"
            ),
        }
    }
}

impl core::error::Error for ReadError {}

/// Cursor over the bytes of a file.
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    pub(crate) const fn new(bytes: &'a [u8]) -> Self {
        Reader { bytes, at: 0 }
    }

    fn left(&self) -> usize {
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

    /// Reads the number of items of at least `least` bytes each. Returns an error if the remaining bytes cannot hold
    /// them.
    fn count(&mut self, least: usize) -> Result<usize, ReadError> {
        let at = self.at;
        let count = u32::get(self)? as usize;
        let fits = count <= self.left() / least.max(1);
        fits.then_some(count).ok_or(ReadError::Truncated(at))
    }

    pub(crate) const fn unknown<T>(&self) -> Result<T, ReadError> {
        Err(ReadError::Unknown(self.at - 1))
    }

    pub(crate) fn end(&self) -> Result<(), ReadError> {
        match self.left() {
            0 => Ok(()),
            _ => Err(ReadError::Trailing(self.at)),
        }
    }
}

/// Type with a binary layout.
pub(crate) trait Wire: Sized {
    /// Minimum number of bytes of a value. It bounds the allocation that a length in a file can cause.
    const LEAST: usize;
    fn put(&self, out: &mut Vec<u8>);
    fn get(from: &mut Reader<'_>) -> Result<Self, ReadError>;
}

macro_rules! numbers {
    ($($t:ty),*) => { $(
        impl Wire for $t {
            const LEAST: usize = size_of::<$t>();
            fn put(&self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }
            fn get(from: &mut Reader<'_>) -> Result<Self, ReadError> {
                from.array().map(Self::from_le_bytes)
            }
        }
    )* };
}

numbers!(u8, u16, u32, u64);

impl Wire for String {
    const LEAST: usize = u32::LEAST;
    fn put(&self, out: &mut Vec<u8>) {
        put_len(self.len(), out);
        out.extend_from_slice(self.as_bytes());
    }
    fn get(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        let len = from.count(1)?;
        let at = from.at;
        let text = core::str::from_utf8(from.take(len)?);
        text.map(String::from).map_err(|_| ReadError::Unknown(at))
    }
}

impl<T: Wire> Wire for Vec<T> {
    const LEAST: usize = u32::LEAST;
    fn put(&self, out: &mut Vec<u8>) {
        put_len(self.len(), out);
        for item in self {
            item.put(out);
        }
    }
    fn get(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        let count = from.count(T::LEAST)?;
        let mut items = Vec::with_capacity(count);
        for _ in 0..count {
            items.push(T::get(from)?);
        }
        Ok(items)
    }
}

impl<T: Wire> Wire for Option<T> {
    const LEAST: usize = 1;
    fn put(&self, out: &mut Vec<u8>) {
        out.push(u8::from(self.is_some()));
        if let Some(item) = self {
            item.put(out);
        }
    }
    fn get(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        match u8::get(from)? {
            0 => Ok(None),
            1 => T::get(from).map(Some),
            _ => from.unknown(),
        }
    }
}

impl<A: Wire, B: Wire> Wire for (A, B) {
    const LEAST: usize = A::LEAST + B::LEAST;
    fn put(&self, out: &mut Vec<u8>) {
        self.0.put(out);
        self.1.put(out);
    }
    fn get(from: &mut Reader<'_>) -> Result<Self, ReadError> {
        Ok((A::get(from)?, B::get(from)?))
    }
}

/// Writes a length as `u32`. Saturation does not occur: the number of slots is bounded, and names come from a compiler.
fn put_len(len: usize, out: &mut Vec<u8>) {
    u32::try_from(len).unwrap_or(u32::MAX).put(out);
}

/// Implements [`Wire`] for a struct: its fields in the given order.
macro_rules! wire_struct {
    ($t:ident { $($field:ident : $ty:ty),* $(,)? }) => {
        impl $crate::wire::Wire for $t {
            const LEAST: usize = 0 $( + <$ty as $crate::wire::Wire>::LEAST )*;
            fn put(&self, out: &mut ::alloc::vec::Vec<u8>) {
                $( $crate::wire::Wire::put(&self.$field, out); )*
            }
            fn get(from: &mut $crate::wire::Reader<'_>) -> Result<Self, $crate::wire::ReadError> {
                Ok($t { $( $field: $crate::wire::Wire::get(from)? ),* })
            }
        }
    };
}

/// Implements [`Wire`] for an enum: the number of the variant (one byte), then its fields in the given order.
macro_rules! wire_enum {
    ($t:ident { $($tag:literal = $variant:ident $( { $($field:ident),* } )? $( ( $($item:ident),* ) )? ),* $(,)? }) => {
        impl $crate::wire::Wire for $t {
            const LEAST: usize = 1;
            fn put(&self, out: &mut ::alloc::vec::Vec<u8>) {
                match self {
                    $( $t::$variant $( { $($field),* } )? $( ( $($item),* ) )? => {
                        out.push($tag);
                        $( $( $crate::wire::Wire::put($field, out); )* )?
                        $( $( $crate::wire::Wire::put($item, out); )* )?
                    } )*
                }
            }
            fn get(from: &mut $crate::wire::Reader<'_>) -> Result<Self, $crate::wire::ReadError> {
                let tag: u8 = $crate::wire::Wire::get(from)?;
                Ok(match tag {
                    $( $tag => $t::$variant
                        $( { $($field: $crate::wire::Wire::get(from)?),* } )?
                        $( ( $({ let $item = $crate::wire::Wire::get(from)?; $item }),* ) )?, )*
                    _ => return from.unknown(),
                })
            }
        }
    };
}

pub(crate) use {wire_enum, wire_struct};
