//! Common Data Representation (CDR), little-endian: the encoding of ROS 2 messages.
//!
//! Source: OMG, DDS Interoperability Wire Protocol 2.5, section 10. Every primitive is aligned to its size, counted from the
//! end of the four-byte header.

/// Bytes before every message in CDR: plain CDR, little-endian, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// Writer of one ROS 2 message in the encoding CDR.
pub(in crate::mcap) struct CdrWriter(Vec<u8>);

impl CdrWriter {
    /// Creates a writer of a new, empty message.
    pub(in crate::mcap) fn new() -> CdrWriter {
        CdrWriter(HEADER.to_vec())
    }

    fn align(&mut self, size: usize) {
        let len = self.0.len() - HEADER.len();
        let padded = len.next_multiple_of(size);
        self.0.resize(HEADER.len() + padded, 0);
    }

    fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        self.align(N);
        self.0.extend(bytes);
    }

    /// Appends a field of type `bool` to the message.
    pub(in crate::mcap) fn bool(&mut self, value: bool) {
        self.put([u8::from(value)]);
    }

    /// Appends a field of type `uint8` to the message.
    pub(in crate::mcap) fn u8(&mut self, value: u8) {
        self.put([value]);
    }

    /// Appends a field of type `int32` to the message.
    pub(in crate::mcap) fn i32(&mut self, value: i32) {
        self.put(value.to_le_bytes());
    }

    /// Appends a field of type `uint32` to the message.
    pub(in crate::mcap) fn u32(&mut self, value: u32) {
        self.put(value.to_le_bytes());
    }

    /// Appends a field of type `uint64` to the message, or an `int64` or `float64` by its bits.
    pub(in crate::mcap) fn u64(&mut self, value: u64) {
        self.put(value.to_le_bytes());
    }

    /// Appends a field of type `float64` to the message.
    pub(in crate::mcap) fn f64(&mut self, value: f64) {
        self.u64(value.to_bits());
    }

    /// Appends the number of elements of a sequence to the message. The elements must be appended next.
    pub(in crate::mcap) fn len(&mut self, count: usize) {
        self.u32(u32::try_from(count).unwrap_or(u32::MAX));
    }

    /// Appends a field of type `string` to the message.
    pub(in crate::mcap) fn string(&mut self, text: &str) {
        self.len(text.len() + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    /// Appends a field of type `std_msgs/Header` to the message. `time` is in nanoseconds since the Unix epoch, `frame`
    /// is the name of a coordinate frame.
    pub(in crate::mcap) fn header(&mut self, time: u64, frame: &str) {
        self.time(time);
        self.string(frame);
    }

    /// Appends a field of type `builtin_interfaces/Time` to the message. `time` is in nanoseconds since the Unix epoch.
    pub(in crate::mcap) fn time(&mut self, time: u64) {
        const SECOND: u64 = 1_000_000_000;
        self.i32(i32::try_from(time / SECOND).unwrap_or(i32::MAX));
        self.u32((time % SECOND) as u32);
    }

    /// Returns the bytes of the message.
    pub(in crate::mcap) fn finish(self) -> Vec<u8> {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn primitives_are_aligned_from_the_end_of_the_header() {
        let mut cdr = CdrWriter::new();
        cdr.bool(true);
        cdr.u32(7);
        cdr.string("ab");
        cdr.f64(1.0);
        let expected = [
            &[0, 1, 0, 0][..],
            &[1, 0, 0, 0, 7, 0, 0, 0, 3, 0, 0, 0, b'a', b'b', 0, 0],
            &1.0_f64.to_le_bytes(),
        ];
        assert_eq!(cdr.finish(), expected.concat());
    }

    #[test]
    fn times_are_seconds_and_nanoseconds() {
        let mut cdr = CdrWriter::new();
        cdr.time(3_000_000_005);
        assert_eq!(cdr.finish(), [0, 1, 0, 0, 3, 0, 0, 0, 5, 0, 0, 0]);
    }
}
