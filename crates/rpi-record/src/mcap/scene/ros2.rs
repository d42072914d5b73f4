//! Messages about arms in the types of ROS 2.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::arm_view::WORLD;
use super::{FramePose, JointValue, LogLevel, SceneMessage};
use crate::mcap::part_writer::EncodedTopic;
use crate::mcap::profile::ros2_encoding;
use crate::mcap::ros2::cdr::CdrWriter;
use crate::mcap::ros2::definitions;

/// Severity number of each log level in the ROS 2 message `rcl_interfaces/Log`.
const LOG_LEVELS: [(LogLevel, u8); 3] = [
    (LogLevel::Info, 20),
    (LogLevel::Warning, 30),
    (LogLevel::Error, 40),
];
/// Number of the level "OK" in the ROS 2 message `diagnostic_msgs/DiagnosticStatus`.
const OK: u8 = 0;
/// Number of the level "ERROR" in the ROS 2 message `diagnostic_msgs/DiagnosticStatus`.
const ERROR: u8 = 2;

/// Topics of the ROS 2 messages about arms: joint states, transforms, robot description, log and diagnostics.
pub(super) struct Ros2Scene {
    joint_states: Arc<EncodedTopic>,
    tf: Arc<EncodedTopic>,
    robot_description: Arc<EncodedTopic>,
    rosout: Arc<EncodedTopic>,
    diagnostics: Arc<EncodedTopic>,
}

fn topic(name: &str, message: &str, latched: bool) -> Arc<EncodedTopic> {
    // Late subscribers of a played recording get the last message of a topic with this quality of service.
    let transient = "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n";
    let metadata = [("offered_qos_profiles".to_owned(), transient.to_owned())];
    let metadata = if latched {
        BTreeMap::from(metadata)
    } else {
        BTreeMap::new()
    };
    Arc::new(EncodedTopic {
        name: name.to_owned(),
        encoding: ros2_encoding(
            definitions::full_name(message),
            definitions::schema(message),
        ),
        metadata,
    })
}

impl Ros2Scene {
    pub(super) fn new() -> Ros2Scene {
        Ros2Scene {
            joint_states: topic("/joint_states", "sensor_msgs/JointState", false),
            tf: topic("/tf", "tf2_msgs/TFMessage", false),
            robot_description: topic("/robot_description", "std_msgs/String", true),
            rosout: topic("/rosout", "rcl_interfaces/Log", false),
            diagnostics: topic("/diagnostics", "diagnostic_msgs/DiagnosticArray", false),
        }
    }

    /// Returns the topics of messages about arms, and the one of the log.
    pub(super) fn topics(&self) -> ([&Arc<EncodedTopic>; 3], &Arc<EncodedTopic>) {
        let arms = [&self.joint_states, &self.tf, &self.robot_description];
        (arms, &self.rosout)
    }

    pub(super) fn description(&self, urdf: &str) -> SceneMessage {
        let mut cdr = CdrWriter::new();
        cdr.string(urdf);
        (Arc::clone(&self.robot_description), cdr.finish())
    }

    pub(super) fn joints(&self, time: u64, joints: &[JointValue]) -> SceneMessage {
        let mut cdr = CdrWriter::new();
        cdr.header(time, WORLD);
        cdr.len(joints.len());
        joints.iter().for_each(|joint| cdr.string(&joint.name));
        cdr.len(joints.len());
        joints.iter().for_each(|joint| cdr.f64(joint.position));
        cdr.len(joints.len());
        joints.iter().for_each(|joint| cdr.f64(joint.velocity));
        cdr.len(0);
        (Arc::clone(&self.joint_states), cdr.finish())
    }

    pub(super) fn transforms(&self, time: u64, frames: &[FramePose]) -> SceneMessage {
        let mut cdr = CdrWriter::new();
        cdr.len(frames.len());
        for frame in frames {
            cdr.header(time, &frame.parent);
            cdr.string(&frame.child);
            let at = frame.pose.translation.vector;
            let turn = frame.pose.rotation.coords;
            at.iter().chain(turn.iter()).for_each(|part| cdr.f64(*part));
        }
        (Arc::clone(&self.tf), cdr.finish())
    }

    pub(super) fn log(&self, time: u64, level: LogLevel, (of, text): (&str, &str)) -> SceneMessage {
        let found = LOG_LEVELS.iter().find(|(own, _)| *own == level);
        let mut cdr = CdrWriter::new();
        cdr.time(time);
        cdr.u8(found.map_or(0, |(_, level)| *level));
        cdr.string(of);
        cdr.string(text);
        cdr.string("");
        cdr.string("");
        cdr.u32(0);
        (Arc::clone(&self.rosout), cdr.finish())
    }

    pub(super) fn device(&self, time: u64, device: &str, code: i64, moving: bool) -> SceneMessage {
        let mut cdr = CdrWriter::new();
        cdr.header(time, "");
        cdr.len(1);
        cdr.u8(if code == 0 { OK } else { ERROR });
        cdr.string(device);
        cdr.string(&rpi_sim::error_code::ErrorCode(code).to_string());
        cdr.string(device);
        cdr.len(2);
        for (key, value) in [("code", code.to_string()), ("moving", moving.to_string())] {
            cdr.string(key);
            cdr.string(&value);
        }
        (Arc::clone(&self.diagnostics), cdr.finish())
    }
}
