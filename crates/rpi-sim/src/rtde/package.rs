//! Packages of RTDE: a size of 2 bytes that counts the whole package, a kind of 1 byte, and a payload. All numbers are
//! big-endian. Source: RTDE guide, section "Protocol".

use super::error::RtdeError;

/// Number of bytes of the size and the kind of a package.
const HEADER: usize = 3;
/// Maximum size of a package that the driver accepts, in bytes. The largest packages of its recipes have under 300.
const MAX_SIZE: usize = 4096;

/// Kinds of packages, each by its ASCII code.
pub(super) mod kind {
    /// Requests a version of the protocol; the answer has 1 byte, 1 for accepted.
    pub(crate) const PROTOCOL_VERSION: u8 = b'V';
    /// Requests the version of the controller's software: four numbers of 4 bytes.
    pub(crate) const CONTROLLER_VERSION: u8 = b'v';
    /// Sets up the outputs: a frequency, and names with commas between them.
    pub(crate) const SETUP_OUTPUTS: u8 = b'O';
    /// Sets up the inputs: names with commas between them.
    pub(crate) const SETUP_INPUTS: u8 = b'I';
    /// Starts the exchange; the answer has 1 byte, 1 for accepted.
    pub(crate) const START: u8 = b'S';
    /// Values of a recipe, in either direction.
    pub(crate) const DATA: u8 = b'U';
}

/// Package that the controller has sent.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Package<'a> {
    /// Kind of the package, an ASCII code.
    pub(super) kind: u8,
    pub(super) payload: &'a [u8],
}

/// Encodes a package.
pub(super) fn encode(kind: u8, payload: &[u8]) -> Vec<u8> {
    let size = (HEADER + payload.len()) as u16;
    let mut bytes = Vec::with_capacity(usize::from(size));
    bytes.extend(size.to_be_bytes());
    bytes.push(kind);
    bytes.extend(payload);
    bytes
}

/// Bytes of a stream that are not complete packages yet, with a fixed capacity: a size in the stream never allocates.
pub(super) struct PackageBuffer {
    bytes: Box<[u8]>,
    begin: usize,
    end: usize,
}

impl PackageBuffer {
    pub(super) fn new() -> Self {
        Self {
            bytes: vec![0; 2 * MAX_SIZE].into_boxed_slice(),
            begin: 0,
            end: 0,
        }
    }

    /// Returns the place for the next bytes of the stream, which is never empty after `next` has returned `None`.
    pub(super) fn space(&mut self) -> &mut [u8] {
        self.bytes.copy_within(self.begin..self.end, 0);
        (self.begin, self.end) = (0, self.end - self.begin);
        &mut self.bytes[self.end..]
    }

    /// Adds the first `count` bytes of the space.
    pub(super) fn add(&mut self, count: usize) {
        self.end = (self.end + count).min(self.bytes.len());
    }

    /// Removes the next complete package and returns it; `None` if there is none.
    ///
    /// # Errors
    /// Returns `PackageSize` for a size below 3 bytes or above the maximum. The stream is then lost.
    pub(super) fn next(&mut self) -> Result<Option<Package<'_>>, RtdeError> {
        let bytes = &self.bytes[self.begin..self.end];
        let Some(([high, low, kind], _)) = bytes.split_first_chunk::<HEADER>() else {
            return Ok(None);
        };
        let size = usize::from(u16::from_be_bytes([*high, *low]));
        if !(HEADER..=MAX_SIZE).contains(&size) {
            return Err(RtdeError::PackageSize(size));
        }
        self.begin += if size <= bytes.len() { size } else { 0 };
        let kind = *kind;
        Ok(bytes
            .get(HEADER..size)
            .map(|payload| Package { kind, payload }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn add(buffer: &mut PackageBuffer, bytes: &[u8]) {
        buffer.space()[..bytes.len()].copy_from_slice(bytes);
        buffer.add(bytes.len());
    }

    #[test]
    fn packages_are_read_as_they_were_written_however_the_stream_is_cut() {
        let one = encode(kind::DATA, &[1, 2, 3]);
        let other = encode(kind::START, &[]);
        let stream = [one, other].concat();
        for cut in 0..=stream.len() {
            let mut buffer = PackageBuffer::new();
            let mut read = Vec::new();
            for part in [&stream[..cut], &stream[cut..]] {
                add(&mut buffer, part);
                while let Some(package) = buffer.next().unwrap() {
                    read.push((package.kind, package.payload.to_vec()));
                }
            }
            assert_eq!(read, [(kind::DATA, vec![1, 2, 3]), (kind::START, vec![])]);
        }
    }

    #[test]
    fn a_stream_of_many_packages_needs_no_more_room() {
        let mut buffer = PackageBuffer::new();
        let package = encode(kind::DATA, &[7; 1000]);
        for _ in 0..100 {
            add(&mut buffer, &package);
            assert_eq!(buffer.next().unwrap().unwrap().payload, [7; 1000]);
            assert!(buffer.next().unwrap().is_none());
            assert_eq!(buffer.space().len(), 2 * MAX_SIZE);
        }
    }

    #[test]
    fn invalid_sizes_are_rejected_without_an_allocation() {
        for size in [0_u16, 1, 2, MAX_SIZE as u16 + 1, u16::MAX] {
            let mut buffer = PackageBuffer::new();
            add(&mut buffer, &size.to_be_bytes());
            add(&mut buffer, &[kind::DATA]);
            let error = buffer.next().unwrap_err();
            assert!(matches!(error, RtdeError::PackageSize(n) if n == usize::from(size)));
        }
        let mut buffer = PackageBuffer::new();
        add(&mut buffer, &(MAX_SIZE as u16).to_be_bytes());
        add(&mut buffer, &[0; MAX_SIZE - 2]);
        assert_eq!(buffer.next().unwrap().unwrap().payload.len(), MAX_SIZE - 3);
    }
}
