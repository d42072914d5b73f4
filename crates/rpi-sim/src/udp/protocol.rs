//! Datagrams between the driver and the controller of a `udp-arm`.
//!
//! All numbers are little-endian. Both kinds begin with the four bytes `RPI1`, a byte for the kind, and a byte for the
//! number of axes. Positions are rad or m. `docs/src/drivers.md` has the table of the fields.

use crate::driver_io::Fields;
use rpi_kin::MAX_AXES;

/// Maximum size of a datagram, in bytes.
pub const MAX_BYTES: usize = 1200;

/// Maximum number of set-points in a datagram: the newest one and those before it, so that the loss of single datagrams
/// does no harm.
pub const MAX_SET_POINTS: usize = 16;

const MAGIC: &[u8; 4] = b"RPI1";
const STATE: u8 = 1;
const SET_POINTS: u8 = 2;

/// Positions of all axes, in rad or m; 0 beyond the number of axes.
pub type Positions = [f64; MAX_AXES];

/// Mode of a controller: whether it follows set-points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControllerMode {
    /// The controller follows set-points, or waits for the first one.
    Ready,
    /// The controller brakes, because set-points are missing.
    Braking,
    /// The controller rests and waits for set-points of a new epoch (sequence of set-points).
    Stopped,
}

/// State of the controller, as a datagram that it sends in every cycle of its clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatePacket {
    /// Number of axes of the controller.
    pub axes: u8,
    /// Mode of the controller: whether it follows set-points.
    pub mode: ControllerMode,
    /// Epoch (sequence of set-points) that the controller follows.
    pub epoch: u32,
    /// Time of the controller's clock, in s.
    pub clock: f64,
    /// Measured positions of the axes, in rad or m.
    pub positions: Positions,
}

/// Set-points, as a datagram that the driver sends to the controller.
#[derive(Clone, Debug, PartialEq)]
pub struct SetPointPacket {
    /// Number of axes of the arm.
    pub axes: u8,
    /// Epoch (sequence) of the set-points. A new epoch begins at the position that the controller has reported.
    pub epoch: u32,
    /// Number of the newest set-point within its epoch, from 1; 0 without set-points.
    pub newest: u64,
    /// Joint positions of the set-points from the newest one backwards, in rad or m, at most [`MAX_SET_POINTS`].
    pub set_points: Vec<Positions>,
}

impl ControllerMode {
    fn from_byte(byte: u8) -> Option<Self> {
        [Self::Ready, Self::Braking, Self::Stopped]
            .into_iter()
            .find(|mode| *mode as u8 == byte)
    }
}

impl Fields<'_> {
    fn byte(&mut self) -> Option<u8> {
        self.take().map(|[byte]| byte)
    }

    /// Reads the magic number and the kind of the datagram, and returns the number of axes; `None` if the datagram is
    /// of another kind.
    fn head(&mut self, kind: u8) -> Option<u8> {
        let is_known = self.take()? == *MAGIC && self.byte()? == kind;
        let axes = self.byte()?;
        (is_known && usize::from(axes) <= MAX_AXES).then_some(axes)
    }

    fn positions(&mut self, axes: u8) -> Option<Positions> {
        let mut positions = [0.0; MAX_AXES];
        for position in positions.iter_mut().take(usize::from(axes)) {
            *position = f64::from_le_bytes(self.take()?);
        }
        let is_finite = positions.iter().all(|position| position.is_finite());
        is_finite.then_some(positions)
    }
}

fn begin(kind: u8, axes: u8) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(MAX_BYTES);
    bytes.extend(MAGIC);
    bytes.extend([kind, axes]);
    bytes
}

fn put_positions(bytes: &mut Vec<u8>, axes: u8, positions: &Positions) {
    for position in positions.iter().take(usize::from(axes)) {
        bytes.extend(position.to_le_bytes());
    }
}

impl StatePacket {
    /// Returns the bytes of the datagram.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = begin(STATE, self.axes);
        bytes.push(self.mode as u8);
        bytes.extend(self.epoch.to_le_bytes());
        bytes.extend(self.clock.to_le_bytes());
        put_positions(&mut bytes, self.axes, &self.positions);
        bytes
    }

    /// Decodes a datagram; `None` if it is not a state of a controller, too short, or has a position that is not
    /// finite.
    #[must_use]
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let mut fields = Fields(bytes);
        let axes = fields.head(STATE)?;
        Some(Self {
            axes,
            mode: ControllerMode::from_byte(fields.byte()?)?,
            epoch: u32::from_le_bytes(fields.take()?),
            clock: f64::from_le_bytes(fields.take()?),
            positions: fields.positions(axes)?,
        })
    }
}

impl SetPointPacket {
    /// Returns the bytes of the datagram.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = begin(SET_POINTS, self.axes);
        let count = self.set_points.len().min(MAX_SET_POINTS);
        bytes.push(count as u8);
        bytes.extend(self.epoch.to_le_bytes());
        bytes.extend(self.newest.to_le_bytes());
        let newest = self.set_points.iter().take(count);
        newest.for_each(|positions| put_positions(&mut bytes, self.axes, positions));
        bytes
    }

    /// Decodes a datagram; `None` if it does not contain set-points, is too short, or has a position that is not
    /// finite.
    #[must_use]
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let mut fields = Fields(bytes);
        let axes = fields.head(SET_POINTS)?;
        let count = usize::from(fields.byte()?);
        let epoch = u32::from_le_bytes(fields.take()?);
        let newest = u64::from_le_bytes(fields.take()?);
        let set_points: Option<Vec<Positions>> =
            (0..count).map(|_| fields.positions(axes)).collect();
        let is_valid = count <= MAX_SET_POINTS && count as u64 <= newest;
        Some(Self {
            axes,
            epoch,
            newest,
            set_points: set_points.filter(|_| is_valid)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> StatePacket {
        StatePacket {
            axes: 6,
            mode: ControllerMode::Stopped,
            epoch: 3,
            clock: 1.25,
            positions: [0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.0],
        }
    }

    #[test]
    fn datagrams_are_read_as_they_were_written() {
        let state = state();
        assert_eq!(StatePacket::decode(&state.encode()), Some(state));
        let set_points = SetPointPacket {
            axes: 6,
            epoch: 3,
            newest: 40,
            set_points: vec![state.positions; MAX_SET_POINTS],
        };
        let bytes = set_points.encode();
        assert!(bytes.len() <= MAX_BYTES);
        assert_eq!(SetPointPacket::decode(&bytes), Some(set_points));
        assert_eq!(StatePacket::decode(&bytes), None);
    }

    #[test]
    fn damaged_datagrams_are_rejected() {
        let bytes = state().encode();
        assert!((0..bytes.len()).all(|end| StatePacket::decode(&bytes[..end]).is_none()));
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] = 0xff;
            // Any byte may change; nothing panics, and no position is infinite.
            let read = StatePacket::decode(&damaged);
            assert!(read.is_none_or(|state| state.positions.iter().all(|p| p.is_finite())));
        }
        let none = SetPointPacket {
            axes: 1,
            epoch: 0,
            newest: 0,
            set_points: vec![[0.0; MAX_AXES]],
        };
        assert_eq!(SetPointPacket::decode(&none.encode()), None);
    }
}
