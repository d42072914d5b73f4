//! Devices with `kind = "udp-arm"` and `kind = "ur-arm"`: arms behind real controllers.

use super::arm::{self, ArmSpec};
use super::quantity::Dimension::{Number, Time};
use super::reader::TableReader;
use crate::rtde::{self, UrSpec};
use crate::udp::UdpSpec;
use rpi_kin::{ArmModel, models};
use std::net::SocketAddr;

/// Default of the key `timeout`, in s.
const TIMEOUT: f64 = 0.1;

/// Driver of a real arm, with the settings of its connection.
#[derive(Clone, Debug, PartialEq)]
pub enum ArmDriver {
    /// Controller with the UDP protocol of `docs/src/drivers.md`.
    Udp(UdpSpec),
    /// Controller of Universal Robots, by RTDE.
    #[cfg(feature = "rtde")]
    Ur(UrSpec),
}

/// Reads the keys of `kind = "udp-arm"`.
pub(super) fn read_udp(reader: &mut TableReader<'_>) -> Option<ArmSpec> {
    let address = read_socket_address(reader);
    let timeout = reader.positive("timeout", Time).unwrap_or(TIMEOUT);
    let spec = arm::read(reader)?;
    let udp = UdpSpec {
        address: address?,
        timeout,
    };
    Some(ArmSpec {
        driver: Some(ArmDriver::Udp(udp)),
        ..spec
    })
}

/// Reads the key `address`: an IP address with a port. Reports an error and returns `None` if it is missing or invalid.
fn read_socket_address(reader: &mut TableReader<'_>) -> Option<SocketAddr> {
    let text = reader.text("address");
    let address = text.and_then(|text| text.parse().ok());
    let help = "expected an address and a port, such as \"192.168.1.2:5005\"";
    reader.require("address", help);
    if let (Some(text), None) = (text, address) {
        let message = format!("`{text}` is not an address");
        reader.error_at("address", message, Some(help.to_owned()));
    }
    address
}

/// Reads the keys of `kind = "ur-arm"`.
pub(super) fn read_ur(reader: &mut TableReader<'_>) -> Option<ArmSpec> {
    let host = read_host(reader);
    let ur = UrSpec {
        host: host.unwrap_or_default().to_owned(),
        rtde_port: read_port(reader, "rtde_port").unwrap_or(30004),
        script_port: read_port(reader, "script_port").unwrap_or(30002),
        timeout: reader
            .real_within("timeout", Time, rtde::TIMEOUT)
            .unwrap_or(TIMEOUT),
        lookahead: reader
            .real_within("lookahead", Time, rtde::LOOKAHEAD)
            .unwrap_or(0.1),
        gain: reader
            .real_within("gain", Number, rtde::GAIN)
            .unwrap_or(300.0),
    };
    let spec = arm::read(reader)?;
    if let Some(message) = unfit_model(spec.model) {
        let help = "a `ur-arm` is an arm of Universal Robots, such as `ur5e`".to_owned();
        reader.error_at("model", message, Some(help));
        return None;
    }
    host?;
    with_ur(reader, spec, ur)
}

/// Returns the reason for which an arm with this model cannot be one of Universal Robots; `None` if it can. A description of a
/// robot in a file does not state its vendor.
fn unfit_model(model: &ArmModel) -> Option<String> {
    let (id, axes) = (model.id, model.axes());
    let is_built_in = models::by_id(id).is_some();
    if axes != rtde::AXES {
        Some(format!("model `{id}` has {axes} axes, expected 6"))
    } else if is_built_in && !model.display_name.starts_with("Universal Robots") {
        let name = model.display_name;
        Some(format!("model `{id}` is a {name}, which has no RTDE"))
    } else {
        None
    }
}

#[cfg(feature = "rtde")]
#[expect(
    clippy::unnecessary_wraps,
    reason = "the same signature without the feature"
)]
fn with_ur(_: &TableReader<'_>, spec: ArmSpec, ur: UrSpec) -> Option<ArmSpec> {
    Some(ArmSpec {
        driver: Some(ArmDriver::Ur(ur)),
        ..spec
    })
}

#[cfg(not(feature = "rtde"))]
fn with_ur(reader: &TableReader<'_>, _: ArmSpec, _: UrSpec) -> Option<ArmSpec> {
    let message = "this build has no driver for `ur-arm`".to_owned();
    let help = "build `rpi` with its default features, or with `--features rtde`".to_owned();
    reader.error_at("kind", message, Some(help));
    None
}

/// Reads the key `address`: the name or IP address of a controller. Reports an error and returns `None` if it is missing or
/// invalid.
fn read_host<'a>(reader: &mut TableReader<'a>) -> Option<&'a str> {
    let host = reader.text("address");
    let help = "expected a name or an IP address without a port, such as \"192.168.1.2\"";
    reader.require("address", help);
    let is_name = |host: &&str| {
        let mut letters = host.chars();
        !host.is_empty() && letters.all(|c| c.is_ascii_alphanumeric() || ".-_".contains(c))
    };
    let is_host = |host: &&str| is_name(host) || host.parse::<std::net::Ipv6Addr>().is_ok();
    let valid = host.filter(is_host);
    if let (Some(text), None) = (host, valid) {
        let message = format!("`{text}` is not a name or an IP address");
        let help = "write the ports as `rtde_port` and `script_port`".to_owned();
        reader.error_at("address", message, Some(help));
    }
    valid
}

/// Reads the number of a TCP port; `None` if the key is missing or invalid.
fn read_port(reader: &mut TableReader<'_>, key: &'static str) -> Option<u16> {
    let port = reader.integer(key, 1..=65535, "")?;
    u16::try_from(port).ok()
}
