//! Real ports that carry angles. They are compared modulo a full turn, and with a larger tolerance near gimbal lock.

use rpi_image::PrimDesc;

/// Out-ports of primitives whose values are angles: primitive, port, and for Euler angles the port with the middle
/// angle.
const ANGLES: &[(&str, &str, Option<&str>)] = &[
    ("World::RotationToABC", "outA", Some("outB")),
    ("World::RotationToABC", "outB", Some("outB")),
    ("World::RotationToABC", "outC", Some("outB")),
    ("World::RotationToAxisAngle", "outAngle", None),
    ("Core::DoubleAtan2", "outValue", None),
];

/// Kind of values at an out-port, by which a computed value is compared with a recorded one: numbers or angles.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum AngleKind {
    /// Values are compared as numbers.
    Plain,
    /// Values are compared as angles: values that differ by whole turns are equal.
    Angle,
    /// The value is one of three Euler angles. The index is that of the primitive's out-port with the middle angle,
    /// which shows whether the angles are near gimbal lock.
    Euler(usize),
}

/// Returns the kind of values at the out-port with the index `port` of a primitive.
pub(super) fn angle_kind(desc: &PrimDesc, port: usize) -> AngleKind {
    let name = desc.outputs[port].name;
    let found = ANGLES.iter().find(|a| a.0 == desc.name && a.1 == name);
    match found {
        None => AngleKind::Plain,
        Some((.., middle)) => middle
            .and_then(|m| desc.output(m))
            .map_or(AngleKind::Angle, AngleKind::Euler),
    }
}

#[cfg(test)]
mod tests {
    use rpi_image::{PortType, Scalar};
    use rpi_prims::PrimId;

    use super::*;

    #[test]
    fn every_angle_is_a_real_out_port() {
        for (prim, port, middle) in ANGLES {
            let desc = PrimId::from_name(prim)
                .unwrap_or_else(|| panic!("{prim}"))
                .desc();
            for name in [Some(*port), *middle].into_iter().flatten() {
                let k = desc.output(name).unwrap_or_else(|| panic!("{prim}.{name}"));
                assert_eq!(desc.outputs[k].ty, PortType::Scalar(Scalar::Real));
            }
        }
    }
}
