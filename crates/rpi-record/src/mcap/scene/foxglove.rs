//! Messages about arms in the schemas of Foxglove, as JSON (<https://docs.foxglove.dev/docs/sdk/schemas>).

use std::collections::BTreeMap;
use std::sync::Arc;

use serde_json::{Value, json};

use super::{FramePose, JointValue, LogLevel, SceneMessage};
use crate::mcap::mcap_file::Encoding;
use crate::mcap::part_writer::EncodedTopic;

/// Severity number of each log level in the Foxglove schema `foxglove.Log`.
const LOG_LEVELS: [(LogLevel, u8); 3] = [
    (LogLevel::Info, 2),
    (LogLevel::Warning, 3),
    (LogLevel::Error, 4),
];

/// Topics of the messages for the viewer Foxglove: joint states, transforms, robot description and log.
pub(super) struct FoxgloveScene {
    joint_states: Arc<EncodedTopic>,
    tf: Arc<EncodedTopic>,
    robot_description: Arc<EncodedTopic>,
    log: Arc<EncodedTopic>,
}

fn topic(name: &str, schema_name: &str, properties: &Value) -> Arc<EncodedTopic> {
    let schema = json!({ "title": schema_name, "type": "object", "properties": properties });
    Arc::new(EncodedTopic {
        name: name.to_owned(),
        encoding: Encoding {
            message: "json",
            schema_name: schema_name.to_owned(),
            schema_encoding: "jsonschema",
            schema: schema.to_string().into_bytes(),
        },
        metadata: BTreeMap::new(),
    })
}

fn object(names: &[(&str, &str)]) -> Value {
    let properties = names
        .iter()
        .map(|(name, ty)| ((*name).to_owned(), json!({ "type": ty })));
    json!({ "type": "object", "properties": properties.collect::<serde_json::Map<_, _>>() })
}

fn array(items: &Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn time_schema() -> Value {
    object(&[("sec", "integer"), ("nsec", "integer")])
}

fn transform_schema() -> Value {
    let mut schema = object(&[("parent_frame_id", "string"), ("child_frame_id", "string")]);
    let number = "number";
    schema["properties"]["timestamp"] = time_schema();
    schema["properties"]["translation"] = object(&[("x", number), ("y", number), ("z", number)]);
    schema["properties"]["rotation"] =
        object(&[("x", number), ("y", number), ("z", number), ("w", number)]);
    schema
}

/// Converts a time in nanoseconds since the Unix epoch to a JSON object of seconds and nanoseconds.
fn stamp(time: u64) -> Value {
    const SECOND: u64 = 1_000_000_000;
    json!({ "sec": time / SECOND, "nsec": time % SECOND })
}

impl FoxgloveScene {
    pub(super) fn new() -> FoxgloveScene {
        let joint = object(&[
            ("name", "string"),
            ("position", "number"),
            ("velocity", "number"),
        ]);
        let joints = json!({ "timestamp": time_schema(), "joints": array(&joint) });
        let transforms = json!({ "transforms": array(&transform_schema()) });
        let text = json!({ "type": "string" });
        let log = json!({
            "timestamp": time_schema(), "level": { "type": "integer" },
            "message": text, "name": text, "file": text, "line": { "type": "integer" },
        });
        FoxgloveScene {
            joint_states: topic("/joint_states", "foxglove.JointStates", &joints),
            tf: topic("/tf", "foxglove.FrameTransforms", &transforms),
            robot_description: topic(
                "/robot_description",
                "std_msgs/String",
                &json!({ "data": text }),
            ),
            log: topic("/log", "foxglove.Log", &log),
        }
    }

    /// Returns the topics of messages about arms, and the one of the log.
    pub(super) fn topics(&self) -> ([&Arc<EncodedTopic>; 3], &Arc<EncodedTopic>) {
        let arms = [&self.joint_states, &self.tf, &self.robot_description];
        (arms, &self.log)
    }

    pub(super) fn description(&self, urdf: &str) -> SceneMessage {
        message(&self.robot_description, &json!({ "data": urdf }))
    }

    pub(super) fn joints(&self, time: u64, joints: &[JointValue]) -> SceneMessage {
        let joints = joints.iter().map(|joint| {
            json!({ "name": joint.name, "position": joint.position, "velocity": joint.velocity })
        });
        let joints: Vec<Value> = joints.collect();
        message(
            &self.joint_states,
            &json!({ "timestamp": stamp(time), "joints": joints }),
        )
    }

    pub(super) fn transforms(&self, time: u64, frames: &[FramePose]) -> SceneMessage {
        let frames = frames.iter().map(|frame| {
            let (at, turn) = (frame.pose.translation, frame.pose.rotation);
            json!({
                "timestamp": stamp(time),
                "parent_frame_id": frame.parent,
                "child_frame_id": frame.child,
                "translation": { "x": at.x, "y": at.y, "z": at.z },
                "rotation": { "x": turn.i, "y": turn.j, "z": turn.k, "w": turn.w },
            })
        });
        message(
            &self.tf,
            &json!({ "transforms": frames.collect::<Vec<_>>() }),
        )
    }

    pub(super) fn log(&self, time: u64, level: LogLevel, (of, text): (&str, &str)) -> SceneMessage {
        let found = LOG_LEVELS.iter().find(|(own, _)| *own == level);
        let level = found.map_or(0, |(_, level)| *level);
        let entry = json!({
            "timestamp": stamp(time), "level": level, "message": text, "name": of, "file": "", "line": 0,
        });
        message(&self.log, &entry)
    }
}

fn message(topic: &Arc<EncodedTopic>, content: &Value) -> SceneMessage {
    (Arc::clone(topic), content.to_string().into_bytes())
}
