//! Names by which nodes refer to ports outside of the net: devices, inputs and exports.

use rpi_image::image::DevicePort;
use rpi_image::{DevicePortNames, DeviceUse, Type, Value};
use rpi_net::Node;

/// Key of an input or export: its string parameters, joined by `/`.
pub(super) fn key(node: &Node) -> String {
    let texts = node.params.iter().filter_map(Value::as_str);
    texts.collect::<Vec<_>>().join("/")
}

/// Device port number `k` of a node.
pub(super) fn device_port(node: &Node, device: DeviceUse, k: usize, ty: Type) -> DevicePort {
    let text = |name: &str| {
        param(node, name)
            .and_then(Value::as_str)
            .unwrap_or("")
            .to_owned()
    };
    let index = device.index.and_then(|name| param(node, name)?.as_int());
    DevicePort {
        device: text(device.device),
        port: match device.ports {
            DevicePortNames::Fixed(names) => names.get(k).copied().unwrap_or("").to_owned(),
            DevicePortNames::Param(name) => text(name),
        },
        // An invalid index becomes one that no device has, so that loading reports it.
        index: index.map_or(0, |i| u32::try_from(i).unwrap_or(u32::MAX)),
        ty,
    }
}

fn param<'n>(node: &'n Node, name: &str) -> Option<&'n Value> {
    node.params.get(node.desc().param(name)?)
}

/// Value that an input has before it is set; `None` if it is zero.
pub(super) fn start_value(node: &Node) -> Option<Vec<u64>> {
    let value = param(node, "Value")?;
    let has_type = value.ty() == node.outputs.first().copied();
    (has_type && value.slots().iter().any(|c| *c != 0)).then(|| value.slots().to_vec())
}
