//! The arms of a cell as viewers of robots show them: joint states, transforms of the links, and a robot description.

mod arm_view;
mod foxglove;
mod geometry;
mod ros2;
mod urdf;

use std::sync::Arc;

use rpi_runtime::run::{Channel, Source};
use rpi_runtime::tick_log::{EntryKind, LoggedTick, decode_entries};
use rpi_sim::Cell;
use rpi_sim::cell::DeviceKind;

use super::part_writer::EncodedTopic;
use super::profile::Profile;
use arm_view::ArmView;
pub(super) use geometry::arm_geometry;
pub use geometry::{ArmGeometry, JointGeometry, PoseNumbers};

/// Port of an arm whose samples are the positions of the joints.
const JOINT_PORT: &str = "joint.commanded_position";
/// Minimum time between two messages with link transforms, in nanoseconds. Joint states are in every tick; a viewer
/// interpolates transforms.
const TRANSFORM_INTERVAL: u64 = 10_000_000;

/// Message for viewers of robots: its topic and its encoded data.
pub(super) type SceneMessage = (Arc<EncodedTopic>, Vec<u8>);

/// State of a joint in a tick, for viewers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct JointValue {
    /// Name of the joint in the robot description.
    pub(super) name: String,
    /// Commanded position in rad or m.
    pub(super) position: f64,
    /// Commanded velocity in rad/s or m/s: the difference to the position in the previous tick, divided by the tick
    /// length.
    pub(super) velocity: f64,
}

/// Pose of a frame in its parent frame, for viewers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FramePose {
    pub(super) parent: String,
    pub(super) child: String,
    pub(super) pose: rpi_kin::Pose,
}

/// Severity of an entry in the log that viewers show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LogLevel {
    Info,
    Warning,
    Error,
}

/// Encoder of the messages about arms and of the log, in the profile of the recording.
enum Encoder {
    Ros2(ros2::Ros2Scene),
    Foxglove(foxglove::FoxgloveScene),
}

impl Encoder {
    /// Returns the topics of joint states, transforms and robot description, and the one of the log.
    fn topics(&self) -> ([&Arc<EncodedTopic>; 3], &Arc<EncodedTopic>) {
        match self {
            Encoder::Ros2(scene) => scene.topics(),
            Encoder::Foxglove(scene) => scene.topics(),
        }
    }
}

/// The arms of a recorded cell, with the encoder of messages about them for viewers.
pub(super) struct Scene {
    encoder: Encoder,
    arms: Vec<ArmView>,
    /// Length of a tick in seconds.
    tick: f64,
    /// Time of the last message with link transforms, in nanoseconds since the Unix epoch; `None` before the first one.
    placed: Option<u64>,
}

impl Scene {
    /// Creates the scene with the arms of a cell. `channels` are the sampled device ports. Returns `None` for a profile
    /// without messages about robots.
    pub(super) fn new(
        profile: Profile,
        cell: &Cell,
        channels: &[Channel],
        tick_ns: u64,
    ) -> Option<Scene> {
        let encoder = match profile {
            Profile::Json => return None,
            Profile::Ros2 => Encoder::Ros2(ros2::Ros2Scene::new()),
            Profile::Foxglove => Encoder::Foxglove(foxglove::FoxgloveScene::new()),
        };
        let arms = cell.devices.iter().filter_map(|device| match &device.kind {
            DeviceKind::Arm(arm) => Some(ArmView::new(
                &device.name,
                arm,
                joint_channels(&device.name, channels),
            )),
            _ => None,
        });
        Some(Scene {
            encoder,
            arms: arms.collect(),
            tick: tick_ns as f64 * 1e-9,
            placed: None,
        })
    }

    /// Returns the topics of the messages. Without arms, there is only the log.
    pub(super) fn topics(&self) -> Vec<&Arc<EncodedTopic>> {
        let (all, log) = self.encoder.topics();
        match self.arms.is_empty() {
            true => vec![log],
            false => all.into_iter().chain([log]).collect(),
        }
    }

    /// Returns the messages at the beginning of each part of a recording: the robot description with all arms.
    pub(super) fn descriptions(&self) -> Vec<SceneMessage> {
        if self.arms.is_empty() {
            return Vec::new();
        }
        let text = urdf::describe(&self.arms);
        vec![match &self.encoder {
            Encoder::Ros2(scene) => scene.description(&text),
            Encoder::Foxglove(scene) => scene.description(&text),
        }]
    }

    /// Returns the messages about a tick: the states of all joints, and, at intervals, the poses of all links. `time`
    /// is in nanoseconds since the Unix epoch. Topics that are not in `needs` are left out.
    pub(super) fn messages(
        &mut self,
        tick: &LoggedTick<'_>,
        time: u64,
        needs: impl Fn(&Arc<EncodedTopic>) -> bool,
    ) -> Vec<SceneMessage> {
        let samples = decode_entries(tick.observations).filter(|e| e.kind == EntryKind::Sample);
        for entry in samples {
            let value = entry.words.first().copied().filter(|_| entry.flag);
            let value = value.map(f64::from_bits);
            self.arms
                .iter_mut()
                .for_each(|arm| arm.take_sample(entry.key as usize, value));
        }
        let mut messages = Vec::new();
        let joints: Vec<JointValue> = self
            .arms
            .iter_mut()
            .flat_map(|a| a.joints(self.tick))
            .collect();
        let ([joint_states, transforms, _], _) = self.encoder.topics();
        if !joints.is_empty() && needs(joint_states) {
            messages.push(match &self.encoder {
                Encoder::Ros2(scene) => scene.joints(time, &joints),
                Encoder::Foxglove(scene) => scene.joints(time, &joints),
            });
        }
        let due = self
            .placed
            .is_none_or(|last| time.saturating_sub(last) >= TRANSFORM_INTERVAL);
        if due && !self.arms.is_empty() && needs(transforms) {
            self.placed = Some(time);
            let frames: Vec<FramePose> = self.arms.iter().flat_map(ArmView::frames).collect();
            messages.push(match &self.encoder {
                Encoder::Ros2(scene) => scene.transforms(time, &frames),
                Encoder::Foxglove(scene) => scene.transforms(time, &frames),
            });
        }
        messages
    }

    /// Returns a message for the log that viewers show. `of` is the command or device that the text is about; `time` is
    /// in nanoseconds since the Unix epoch.
    pub(super) fn log(&self, time: u64, level: LogLevel, (of, text): (&str, &str)) -> SceneMessage {
        match &self.encoder {
            Encoder::Ros2(scene) => scene.log(time, level, (of, text)),
            Encoder::Foxglove(scene) => scene.log(time, level, (of, text)),
        }
    }

    /// Returns the message about the state of a device; `None` in a profile without such messages. `code` is the error
    /// code of the device, 0 for none; `time` is in nanoseconds since the Unix epoch.
    pub(super) fn device(
        &self,
        time: u64,
        device: &str,
        code: i64,
        moving: bool,
    ) -> Option<SceneMessage> {
        match &self.encoder {
            Encoder::Ros2(scene) => Some(scene.device(time, device, code, moving)),
            Encoder::Foxglove(_) => None,
        }
    }
}

/// Returns the indices of the channels with the joint positions of the arm named `device`, in the order of the joints.
fn joint_channels(device: &str, channels: &[Channel]) -> Vec<usize> {
    let joint = |channel: &Channel| match &channel.source {
        Source::Device {
            device: of,
            port,
            index,
        } if of == device && *port == JOINT_PORT => Some(*index),
        _ => None,
    };
    let mut found: Vec<(usize, usize)> = channels
        .iter()
        .enumerate()
        .filter_map(|(at, channel)| Some((joint(channel)?, at)))
        .collect();
    found.sort_unstable();
    found.into_iter().map(|(_, at)| at).collect()
}
