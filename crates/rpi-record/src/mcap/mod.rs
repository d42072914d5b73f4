//! Recordings of everything a control core did: MCAP files that viewers can open and that can be replayed.
//!
//! ```text
//! cycle thread: LoggingBank, FlowProbe -> tick log (bounded ring, losses are counted) -> RecordingWriter (a thread) -> MCAP
//! host:         requests before they are sent, events as they arrive --------^                      +-> live viewers
//! ```
//! | in the file | content |
//! |---|---|
//! | `/command/NAME` | exported flows of a command in each cycle, JSON |
//! | `/sensors/DEVICE`, `/set_points/DEVICE` | values that commands read from a device and set-points that they wrote to it, JSON |
//! | `/device/DEVICE` | state of a device after each tick, JSON |
//! | `/events` | starts, ends, takeovers, faults, answers to requests, lost ticks, JSON |
//! | `/rpi/requests` | requests to the core, JSON |
//! | `/rpi/images` | images of the commands |
//! | `/rpi/tape` | the [tick log](rpi_runtime::tick_log): bit-exact log of each tick |
//! | attachments | cell description, source of the program |
//! | metadata `rpi`, `rpi-end` | tick length, policy, program, number of the part; number of ticks written and lost, or of the next part, or the reason of a cut |
//!
//! Recordings that are made from others (`derived`) have further keys in the metadata `rpi`.
//!
//! A [`Profile`] selects the encoding of the messages. A recording may have several parts (`parts`), each a complete file.
//!
//! [`replay()`] replays a recording: it makes the same requests in the same ticks on a core whose devices are the
//! tick log,
//! and compares every flow, set-point and event. This module must not depend on the compiler.

mod bytes_encoding;
mod chunk;
mod completion;
mod derived;
mod error;
mod event_json;
mod field_tree;
mod live;
mod live_run;
mod mcap_bytes;
mod mcap_file;
mod names;
mod own_topics;
mod part_index;
mod part_source;
mod part_writer;
mod parts;
mod profile;
mod reader;
mod record_parser;
mod record_reader;
mod recorder;
mod replay;
mod replay_report;
mod replay_requests;
mod replay_run;
mod replay_timeline;
mod request_json;
mod ros2;
mod run_data;
mod run_output;
mod scene;
mod summary;
mod text_encoding;
mod tick_reader;
mod topic;
mod topic_table;
mod value_json;
mod writer;

pub use completion::{CompletedRecording, complete, recording_files};
pub use derived::{CutRecording, MergedRecording, TimeAxis, cut, merge};
pub use error::RecordingError;
pub use live::{LiveTopic, LiveViewers};
pub use live_run::LiveRun;
pub use mcap_file::Output;
pub use parts::{OpenPart, PartLimits, part_files, part_path, single_part};
pub use profile::Profile;
pub use reader::Recording;
pub use recorder::{Recorder, RecordingOptions, RunOutputs, RunSources, record};
pub use replay::{CycleCallback, replay, replay_observed};
pub use replay_report::{Difference, ReplayReport};
pub use replay_timeline::ReplayTimeline;
pub use run_data::{Column, ColumnKind, FragmentActivity, RunData, TopicColumns};
pub use scene::{ArmGeometry, JointGeometry, PoseNumbers};
pub use summary::{RecordedCommand, RecordingSummary};
