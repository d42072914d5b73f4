//! A device bank that has every device. Sensors return numbers that change from cycle to cycle, functions return a
//! value that depends on their arguments, and all set-points are combined into one hash.

use rpi_device::{DeviceBank, PortId, PortQuery, Rejection, ResolveError};
use rpi_image::hash::Fnv1a;
use rpi_image::{Scalar, Type};

/// Device port that a command uses: its name with device and index, the type of its values, and a hash of the name.
#[derive(Clone, Debug)]
struct Port {
    name: String,
    ty: Type,
    /// Hash of the name. The values of the port depend on it, so that different ports return different values.
    hash: u64,
}

/// Simulated set of devices in which every device and every port exists. It is deterministic: after the same calls, two
/// instances return the same values.
#[derive(Clone, Debug, Default)]
pub struct FakeDevices {
    ports: Vec<Port>,
    cycle: u64,
    written: Fnv1a,
    /// Number of set-points that have been written to all ports.
    pub writes: u64,
}

impl FakeDevices {
    /// Creates the devices in cycle 0.
    #[must_use]
    pub fn new() -> Self {
        FakeDevices::default()
    }

    /// Starts the next cycle, in which all sensors have other values.
    pub fn advance(&mut self) {
        self.cycle += 1;
    }

    /// Returns the hash of all set-points that have been written so far, in order.
    #[must_use]
    pub fn set_point_hash(&self) -> u64 {
        self.written.finish()
    }
}

/// Fills memory slots with a valid value of type `ty`, which depends on `seed`.
fn fill(cells: &mut [u64], ty: Type, seed: u64) {
    let scalar = match ty {
        Type::Scalar(s) | Type::Array(s, _) => s,
        Type::Matrix(..) => Scalar::Real,
    };
    let width = scalar.slots() as usize;
    for (k, cell) in cells.iter_mut().enumerate() {
        let x = (seed.wrapping_add(k as u64) % 628) as f64 / 100.0;
        *cell = match (scalar, k % width) {
            (Scalar::Bool, _) => (seed >> 3) & 1,
            (Scalar::Int, _) => 0,
            (Scalar::Time, _) => seed % 1_000_000_000,
            (Scalar::Rotation, 3) | (Scalar::Pose, 6) => 1f64.to_bits(),
            (Scalar::Rotation, _) | (Scalar::Pose, 3..6) => 0,
            _ => (0.8 * wave(x)).to_bits(),
        };
    }
}

/// Returns the value of a periodic function between -1 and 1 at `x`. The function uses only basic arithmetic, so that
/// it gives the same bits on every machine.
fn wave(x: f64) -> f64 {
    let t = (x / 3.2).fract() * 2.0 - 1.0;
    4.0 * t * (1.0 - t.abs())
}

impl DeviceBank for FakeDevices {
    fn resolve(&mut self, name: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        let text = format!(
            "{}.{}[{}]{:?}",
            name.device, name.port, name.index, name.kind
        );
        let known = self
            .ports
            .iter()
            .position(|p| p.name == text && p.ty == name.ty);
        let place = known.unwrap_or_else(|| {
            self.ports.push(Port {
                hash: Fnv1a::new().with_bytes(text.as_bytes()).finish(),
                name: text,
                ty: name.ty,
            });
            self.ports.len() - 1
        });
        Ok(PortId(u32::try_from(place).unwrap_or(u32::MAX)))
    }

    fn resource(&self, port: PortId) -> u32 {
        port.0
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        let Some(port) = self.ports.get(port.0 as usize) else {
            return false;
        };
        fill(value, port.ty, port.hash % 1000 + self.cycle);
        true
    }

    fn check_set_point(&mut self, _: PortId, value: &[u64]) -> Rejection {
        match value.iter().any(|v| f64::from_bits(*v).is_nan()) {
            true => Rejection::ILLEGAL_VALUE,
            false => Rejection::NONE,
        }
    }

    fn error_code(&self, _: PortId) -> i64 {
        0
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        self.writes += 1;
        let name = self.ports.get(port.0 as usize).map_or(0, |p| p.hash);
        let parts = std::iter::once(&name).chain(value.iter());
        self.written = parts.fold(self.written, |hash, part| {
            hash.with_bytes(&part.to_le_bytes())
        });
    }

    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool {
        let Some(port) = self.ports.get(port.0 as usize) else {
            return false;
        };
        let sum: f64 = arguments.iter().map(|a| f64::from_bits(*a)).sum();
        let seed = if sum.is_finite() {
            (sum.abs() * 100.0) as u64
        } else {
            7
        };
        fill(result, port.ty, seed);
        true
    }

    fn is_moving(&self, _: u32) -> bool {
        false
    }

    fn stop(&mut self, _: u32) {}
}
