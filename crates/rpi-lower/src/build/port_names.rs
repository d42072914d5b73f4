//! Names by which nodes refer to ports outside of the net: devices, inputs and exports.

use rpi_image::image::DevicePort;
use rpi_image::{DevicePortNames, DeviceUse, Type, Value};
use rpi_net::Node;

/// Returns the key of an input or export node: the values of its text parameters, joined by `/`.
pub(super) fn key(node: &Node) -> String {
    let texts = node.params.iter().filter_map(Value::as_str);
    texts.collect::<Vec<_>>().join("/")
}

/// Returns the device port of type `ty` that a node uses. The parameters of the node name the device and the index; `k`
/// selects one of the port names if the primitive prescribes several.
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

/// Returns the value of the parameter of a node with this name; `None` if it has none.
pub(super) fn param<'n>(node: &'n Node, name: &str) -> Option<&'n Value> {
    node.params.get(node.desc().param(name)?)
}

/// Returns the slots of the value that an input node has before the host of the command sets it; `None` if all are zero
/// or the type does not fit.
pub(super) fn start_value(node: &Node) -> Option<Vec<u64>> {
    let value = param(node, "Value")?;
    let has_type = value.ty() == node.outputs.first().copied();
    (has_type && value.slots().iter().any(|c| *c != 0)).then(|| value.slots().to_vec())
}
