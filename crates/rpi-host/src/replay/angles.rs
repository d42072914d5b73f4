//! Real ports that carry angles: compared modulo a full turn, and coarsely near gimbal lock.

use rpi_image::PrimDesc;

/// Primitive, port, and the port that carries the middle Euler angle, if it is one of three.
const ANGLES: &[(&str, &str, Option<&str>)] = &[
    ("World::RotationToABC", "outA", Some("outB")),
    ("World::RotationToABC", "outB", Some("outB")),
    ("World::RotationToABC", "outC", Some("outB")),
    ("World::RotationToAxisAngle", "outAngle", None),
    ("Core::DoubleAtan2", "outValue", None),
];

/// What is special about the comparison of a port.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Measure {
    /// Nothing.
    Plain,
    /// It is an angle.
    Angle,
    /// It is one of three Euler angles, of which the out-port of this index is the middle one.
    Euler(usize),
}

/// How an out-port is compared.
pub(super) fn measure(desc: &PrimDesc, port: usize) -> Measure {
    let name = desc.outputs[port].name;
    let found = ANGLES.iter().find(|a| a.0 == desc.name && a.1 == name);
    match found {
        None => Measure::Plain,
        Some((.., middle)) => middle
            .and_then(|m| desc.output(m))
            .map_or(Measure::Angle, Measure::Euler),
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
            let desc = PrimId::of(prim).unwrap_or_else(|| panic!("{prim}")).desc();
            for name in [Some(*port), *middle].into_iter().flatten() {
                let k = desc.output(name).unwrap_or_else(|| panic!("{prim}.{name}"));
                assert_eq!(desc.outputs[k].ty, PortType::One(Scalar::Real));
            }
        }
    }
}
