//! Devices of the server's cell.

use serde_json::Value;

/// Device of the server's cell, as `device.list` describes it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DeviceInfo {
    /// Name of the device, by which programs refer to it.
    pub name: String,
    /// Kind of the device, such as `arm`.
    pub kind: String,
    /// Number of axes of an arm; `None` for other devices.
    pub joint_count: Option<usize>,
}

impl DeviceInfo {
    pub(crate) fn from_json(device: &Value) -> DeviceInfo {
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let count = device["interfaces"]["robotarm"]["jointcount"].as_str();
        DeviceInfo {
            name: text(&device["name"]),
            kind: text(&device["type"]),
            joint_count: count.and_then(|count| count.parse().ok()),
        }
    }
}
