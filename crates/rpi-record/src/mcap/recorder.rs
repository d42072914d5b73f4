//! Host side of a running recording.

use std::io;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use rpi_core::Continuity;
use rpi_image::hash::Fnv1a;
use rpi_runtime::control::{Control, Event, Executive, RequestLog};
use rpi_runtime::run::{Recorded, RecordingStats, RunRecorder, StartRecording, TickCollector};
use rpi_runtime::tick_log::{LoggingBank, TickLogReader};
use rpi_sim::{Cell, SimBank};

use super::live::LiveViewers;
use super::live_run::LiveRun;
use super::names::NameTable;
use super::part_writer::{PartHead, PartWriter};
use super::parts::{OpenPart, PartLimits};
use super::profile::Profile;
use super::run_output::RunOutput;
use super::writer::{RECORDING, RecorderMessage, RecordingWriter};

/// Program and cell description of a run, stored in its recording.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct RunSources {
    /// File name of the program, as it is stored in the recording.
    pub program: String,
    /// Content of the program file.
    pub program_bytes: Vec<u8>,
    /// Text of the cell description (`cell.toml`).
    pub cell: String,
}

/// Options of a new recording: its files, its encoding, and the program and cell that it stores.
pub struct RecordingOptions {
    /// Function that opens the files of the recording, one for each part.
    pub parts: OpenPart,
    /// Maximum size and duration of a part.
    pub limits: PartLimits,
    /// Encoding of the messages for viewers.
    pub profile: Profile,
    /// Program and cell description that are stored in the recording.
    pub origin: RunSources,
}

/// Where the messages and values of a run go: a recording, viewers that are connected while it goes on, and the page that shows it.
#[derive(Default)]
pub struct RunOutputs {
    /// Recording; `None` for a run that is not recorded.
    pub recording: Option<RecordingOptions>,
    /// Live viewers; `None` without them.
    pub live: Option<Box<dyn LiveViewers>>,
    /// Values for the page that shows the run; `None` without it.
    pub values: Option<LiveRun>,
}

impl RunOutputs {
    /// Returns whether there is an output.
    #[must_use]
    pub fn is_needed(&self) -> bool {
        self.recording.is_some() || self.live.is_some() || self.values.is_some()
    }
}

impl From<RecordingOptions> for RunOutputs {
    fn from(recording: RecordingOptions) -> RunOutputs {
        RunOutputs {
            recording: Some(recording),
            ..RunOutputs::default()
        }
    }
}

/// Version of the layout of a recording. Recordings of version 1, which had the images as attachments, cannot be read.
pub(super) const FORM: &str = "2";

/// Capacity of the queue from the host to the thread that writes the recording, in messages (requests and events).
const NOTES: usize = 1 << 16;

/// Recorder of a run, as used outside the cycle: it forwards requests and events to the thread that writes the
/// recording, and waits for the thread at the end.
pub struct Recorder {
    notes: SyncSender<RecorderMessage>,
    /// Number of requests and events that were dropped because the queue to the writer thread was full. A recording
    /// without them cannot be replayed.
    lost_notes: Arc<AtomicU64>,
    /// Number of ticks that are missing in the recording. Setting it at the end of the run makes the writer thread
    /// finish.
    lost_ticks: Arc<AtomicU64>,
    /// Error that stopped the writer thread; empty if there was none.
    write_error: Arc<OnceLock<String>>,
    thread: JoinHandle<io::Result<RecordingStats>>,
    /// Whether the run is recorded, beside its live viewers.
    has_file: bool,
}

/// Starts recording a core and its devices, and sending their messages to live viewers.
///
/// Returns the recorder for the host and the collector of ticks for the cycle. `tick_ns` is the tick length in
/// nanoseconds; `continuity` is the policy for discontinuities of commands that have none of their own.
///
/// # Errors
/// Returns the errors of the output, and an error if no thread can be created.
pub fn record(
    wanted: impl Into<RunOutputs>,
    cell: &Cell,
    (tick_ns, continuity): (u64, Continuity),
    (control, executive): (&mut Control, &mut Executive<LoggingBank<SimBank>>),
) -> io::Result<(Recorder, TickCollector)> {
    let (collector, tick_log, channels) = TickCollector::begin(cell, executive);
    let run = Recorded {
        cell,
        channels: &channels,
        tick_ns,
        continuity,
    };
    let recorder = Recorder::start(wanted.into(), run, tick_log)?;
    control.set_request_log(recorder.request_callback());
    Ok((recorder, collector))
}

/// Keywords by which recordings store the policies for takeovers with a discontinuity of the set-points.
const CONTINUITY_KEYWORDS: [(Continuity, &str); 3] = [
    (Continuity::Reject, "refuse"),
    (Continuity::AbortAll, "stop"),
    (Continuity::Allow, "allow"),
];

/// Returns the keyword by which recordings store a policy for takeovers with a discontinuity.
pub(super) fn policy_keyword(continuity: Continuity) -> &'static str {
    let found = CONTINUITY_KEYWORDS.iter().find(|(c, _)| *c == continuity);
    found.map_or("", |(_, word)| word)
}

/// Returns the policy for takeovers with a discontinuity that recordings store by this keyword; `None` for an unknown
/// keyword.
pub(super) fn policy_from_keyword(word: &str) -> Option<Continuity> {
    CONTINUITY_KEYWORDS
        .iter()
        .find(|(_, w)| *w == word)
        .map(|p| p.0)
}

impl Recorder {
    /// Starts a recording and the thread that writes it.
    ///
    /// # Errors
    /// Returns the errors of the output, and an error if no thread can be created.
    fn start(
        wanted: RunOutputs,
        run: Recorded<'_>,
        tick_log: TickLogReader,
    ) -> io::Result<Recorder> {
        let (notes, receiver) = sync_channel(NOTES);
        let write_error = Arc::new(OnceLock::new());
        let outputs = outputs(wanted, &run)?;
        let has_file = outputs.iter().any(RunOutput::is_file);
        let writer = RecordingWriter {
            outputs,
            names: NameTable::new(run.cell, run.tick_ns),
            error: None,
            write_error: Arc::clone(&write_error),
            tick_log,
            notes: receiver,
            written: RecordingStats::default(),
            freed: Vec::new(),
            freed_last_turn: Vec::new(),
            latest: None,
            tick_ns: run.tick_ns,
            early: Vec::new(),
            event_tick: 0,
        };
        let lost_ticks = Arc::new(AtomicU64::new(RECORDING));
        let ending = Arc::clone(&lost_ticks);
        let thread = std::thread::Builder::new().name("rpi-record".into());
        Ok(Recorder {
            notes,
            lost_notes: Arc::default(),
            lost_ticks,
            write_error,
            thread: thread.spawn(move || writer.write(&ending))?,
            has_file,
        })
    }

    /// Returns whether the run is recorded; false for a run that has live viewers only.
    #[must_use]
    pub fn has_file(&self) -> bool {
        self.has_file
    }

    /// Returns the callback that the control core calls for each request before it is sent.
    fn request_callback(&self) -> RequestLog {
        let (notes, lost) = (self.notes.clone(), Arc::clone(&self.lost_notes));
        Box::new(move |ticket, request| {
            send_note(&notes, &lost, RecorderMessage::Request(ticket, request))
        })
    }

    /// Adds an event of the core, such as the start or end of a command, to the recording.
    pub fn record_event(&self, event: &Event) {
        send_note(
            &self.notes,
            &self.lost_notes,
            RecorderMessage::Event(*event),
        );
    }

    /// Returns false once the recording has stopped, after which no more data is written to it.
    #[must_use]
    pub fn is_writing(&self) -> bool {
        !self.thread.is_finished() && self.write_error.get().is_none()
    }

    /// Returns the error that stopped the writer thread; `None` if there was none.
    #[must_use]
    pub fn write_error(&self) -> Option<&str> {
        self.write_error.get().map(String::as_str)
    }

    /// Ends the recording and returns its statistics; `None` if the run was not recorded. `lost` is the number of ticks that did not
    /// fit into the tick log.
    ///
    /// # Errors
    /// Returns the first error of the output, and an error if requests or events were dropped.
    pub fn finish(self, lost: u64) -> io::Result<Option<RecordingStats>> {
        // Before the join: the writer puts the number into the metadata at the end of the file.
        self.lost_ticks.store(lost, Ordering::Release);
        let written = self.thread.join();
        let written = written.map_err(|_| io::Error::other("the writer has failed"))??;
        match self.lost_notes.load(Ordering::Relaxed) {
            _ if !self.has_file => Ok(None),
            0 => Ok(Some(written)),
            notes => Err(io::Error::other(format!(
                "the recording is incomplete: {} dropped",
                rpi_words::with_noun(notes, "request or event")
            ))),
        }
    }
}

/// Opens the outputs of a run.
fn outputs(wanted: RunOutputs, run: &Recorded<'_>) -> io::Result<Vec<RunOutput>> {
    let mut outputs = Vec::new();
    if let Some(wanted) = wanted.recording {
        let head = PartHead {
            keys: metadata(&wanted.origin, run.tick_ns, run.continuity),
            origin: wanted.origin,
            profile: wanted.profile.mcap_name(),
        };
        let parts = PartWriter::begin(wanted.parts, wanted.limits, head)?;
        outputs.push(RunOutput::files(wanted.profile, run, parts));
    }
    let live = wanted.live.into_iter();
    outputs.extend(live.map(|viewers| RunOutput::live(run, viewers)));
    let values = wanted.values.into_iter();
    outputs.extend(values.map(|values| RunOutput::values(run, values)));
    Ok(outputs)
}

impl StartRecording for RunOutputs {
    fn start(
        self: Box<Self>,
        run: Recorded<'_>,
        tick_log: TickLogReader,
    ) -> io::Result<Box<dyn RunRecorder>> {
        Ok(Box::new(Recorder::start(*self, run, tick_log)?))
    }
}

impl RunRecorder for Recorder {
    fn request_log(&self) -> RequestLog {
        Recorder::request_callback(self)
    }

    fn event(&self, event: &Event) {
        Recorder::record_event(self, event);
    }

    fn writes(&self) -> bool {
        Recorder::is_writing(self)
    }

    fn finish(self: Box<Self>, lost: u64) -> io::Result<Option<RecordingStats>> {
        Recorder::finish(*self, lost)
    }
}

fn send_note(notes: &SyncSender<RecorderMessage>, lost: &AtomicU64, note: RecorderMessage) {
    if notes.try_send(note).is_err() {
        lost.fetch_add(1, Ordering::Relaxed);
    }
}

/// Returns keys and values of the metadata of a recording: versions of the program and of its elementary functions, tick length, policy, and name and hash of the
/// program.
fn metadata(
    origin: &RunSources,
    tick_ns: u64,
    continuity: Continuity,
) -> Vec<(&'static str, String)> {
    let hash = Fnv1a::new().with_bytes(&origin.program_bytes).finish();
    vec![
        ("form", FORM.to_owned()),
        ("tick_ns", tick_ns.to_string()),
        ("on_jump", policy_keyword(continuity).to_owned()),
        ("program", origin.program.clone()),
        ("program_hash", format!("{hash:016x}")),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("functions", rpi_math::REVISION.to_string()),
    ]
}
