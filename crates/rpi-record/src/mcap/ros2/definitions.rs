//! Definitions of the ROS 2 messages in a recording, in the language `ros2msg`.
//!
//! Source: the packages `common_interfaces`, `geometry2` and `rcl_interfaces` of ROS 2 Jazzy; comments and constants are left
//! out.

/// Definitions of ROS 2 messages in the language `ros2msg`: short name, text, and names of the messages that it uses
/// directly.
const DEFINITIONS: &[(&str, &str, &[&str])] = &[
    (
        "builtin_interfaces/Time",
        "int32 sec\nuint32 nanosec\n",
        &[],
    ),
    (
        "std_msgs/Header",
        "builtin_interfaces/Time stamp\nstring frame_id\n",
        &["builtin_interfaces/Time"],
    ),
    ("std_msgs/String", "string data\n", &[]),
    (
        "geometry_msgs/Point",
        "float64 x\nfloat64 y\nfloat64 z\n",
        &[],
    ),
    (
        "geometry_msgs/Vector3",
        "float64 x\nfloat64 y\nfloat64 z\n",
        &[],
    ),
    (
        "geometry_msgs/Quaternion",
        "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
        &[],
    ),
    (
        "geometry_msgs/Pose",
        "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
        &["geometry_msgs/Point", "geometry_msgs/Quaternion"],
    ),
    (
        "geometry_msgs/Twist",
        "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
        &["geometry_msgs/Vector3"],
    ),
    (
        "geometry_msgs/Wrench",
        "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n",
        &["geometry_msgs/Vector3"],
    ),
    (
        "geometry_msgs/Transform",
        "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
        &["geometry_msgs/Vector3", "geometry_msgs/Quaternion"],
    ),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
        &["std_msgs/Header", "geometry_msgs/Transform"],
    ),
    (
        "tf2_msgs/TFMessage",
        "geometry_msgs/TransformStamped[] transforms\n",
        &["geometry_msgs/TransformStamped"],
    ),
    (
        "sensor_msgs/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
        &["std_msgs/Header"],
    ),
    (
        "diagnostic_msgs/KeyValue",
        "string key\nstring value\n",
        &[],
    ),
    (
        "diagnostic_msgs/DiagnosticStatus",
        "byte level\nstring name\nstring message\nstring hardware_id\ndiagnostic_msgs/KeyValue[] values\n",
        &["diagnostic_msgs/KeyValue"],
    ),
    (
        "diagnostic_msgs/DiagnosticArray",
        "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n",
        &["std_msgs/Header", "diagnostic_msgs/DiagnosticStatus"],
    ),
    (
        "rcl_interfaces/Log",
        "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\nstring function\nuint32 line\n",
        &["builtin_interfaces/Time"],
    ),
];

/// Line between the definitions of two messages in a schema.
const SEPARATOR: &str =
    "================================================================================\n";

/// Returns the schema of the ROS 2 message with this short name: its definition and those of all messages that it uses;
/// empty for an unknown name.
pub(in crate::mcap) fn schema(name: &str) -> String {
    let known = DEFINITIONS.iter().find(|(own, ..)| *own == name);
    known.map_or_else(String::new, |(_, text, uses)| with_uses(text, uses))
}

/// Returns the definition `text` of a ROS 2 message, followed by those of all messages that it uses, each once. `uses`
/// are the names of those that it uses directly.
pub(in crate::mcap) fn with_uses(text: &str, uses: &[&str]) -> String {
    let mut all: Vec<&str> = uses.to_vec();
    let mut at = 0;
    while at < all.len() {
        let found = DEFINITIONS.iter().find(|(name, ..)| *name == all[at]);
        for name in found.map_or(&[][..], |(.., uses)| uses) {
            if !all.contains(name) {
                all.push(name);
            }
        }
        at += 1;
    }
    let known = DEFINITIONS.iter().filter(|(name, ..)| all.contains(name));
    let parts = known.map(|(name, text, _)| format!("{SEPARATOR}MSG: {name}\n{text}"));
    std::iter::once(text.to_owned()).chain(parts).collect()
}

/// Returns the full name of a ROS 2 message type from its short name: `std_msgs/msg/String` for `std_msgs/String`.
pub(in crate::mcap) fn full_name(name: &str) -> String {
    name.replacen('/', "/msg/", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_used_message_is_defined() {
        for (name, text, uses) in DEFINITIONS {
            for used in *uses {
                assert!(
                    DEFINITIONS.iter().any(|(own, ..)| own == used),
                    "{name}: {used}"
                );
                assert!(text.contains(used), "{name} does not use {used}");
            }
            let types = text.lines().filter_map(|line| line.split_once(' '));
            for (ty, _) in types.filter(|(ty, _)| ty.contains('/')) {
                assert!(uses.contains(&ty.trim_end_matches("[]")), "{name}: {ty}");
            }
        }
    }

    #[test]
    fn a_schema_contains_each_message_once() {
        let schema = schema("tf2_msgs/TFMessage");
        for name in [
            "std_msgs/Header",
            "geometry_msgs/Vector3",
            "builtin_interfaces/Time",
        ] {
            assert_eq!(
                schema.matches(&format!("MSG: {name}\n")).count(),
                1,
                "{schema}"
            );
        }
    }
}
