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

use super::mcap_file::{McapFile, Output};
use super::names::NameTable;
use super::writer::{RECORDING, RecorderMessage, RecordingWriter};

/// Program and cell of a run, stored in its recording.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct RunSources {
    /// File name of the program.
    pub program: String,
    /// Content of the program file.
    pub program_bytes: Vec<u8>,
    /// Text of the cell description.
    pub cell: String,
}

/// Destination and origin of a new recording.
pub struct RecordingOptions {
    /// Destination of the recording.
    pub out: Box<dyn Output>,
    /// Program and cell that are stored in the recording.
    pub origin: RunSources,
}

/// Capacity of the queue from the host to the writer thread, in messages about requests and events.
const NOTES: usize = 1 << 16;

/// Part of the recorder that the host uses: it forwards requests and events to the writer thread and joins the thread
/// at the end.
pub struct Recorder {
    notes: SyncSender<RecorderMessage>,
    /// Number of requests and events dropped because the queue to the writer thread was full. A recording with dropped
    /// ones cannot be replayed.
    lost_notes: Arc<AtomicU64>,
    /// Number of lost ticks, set when the recording ends.
    lost_ticks: Arc<AtomicU64>,
    /// Error that stopped the writer, if any.
    write_error: Arc<OnceLock<String>>,
    thread: JoinHandle<io::Result<RecordingStats>>,
}

/// Starts recording a core and its devices.
///
/// Returns the recorder for the host and the collector for the cycle. `continuity` is the policy of commands that have
/// none of their own.
///
/// # Errors
/// Returns the errors of the output, and an error if no thread can be created.
pub fn record(
    wanted: RecordingOptions,
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
    let recorder = Recorder::start(wanted, run, tick_log)?;
    control.set_request_log(recorder.request_callback());
    Ok((recorder, collector))
}

/// Continuity policies and their keywords in a recording.
const CONTINUITY_KEYWORDS: [(Continuity, &str); 3] = [
    (Continuity::Reject, "refuse"),
    (Continuity::AbortAll, "stop"),
    (Continuity::Allow, "allow"),
];

/// Returns the word that recordings use for a continuity policy.
pub(super) fn policy_keyword(continuity: Continuity) -> &'static str {
    let found = CONTINUITY_KEYWORDS.iter().find(|(c, _)| *c == continuity);
    found.map_or("", |(_, word)| word)
}

/// Returns the continuity policy for the word that recordings use; `None` for an unknown word.
pub(super) fn policy_from_keyword(word: &str) -> Option<Continuity> {
    CONTINUITY_KEYWORDS
        .iter()
        .find(|(_, w)| *w == word)
        .map(|p| p.0)
}

impl Recorder {
    /// Starts a recording and its writer thread.
    ///
    /// # Errors
    /// Returns the errors of the output, and an error if no thread can be created.
    fn start(
        wanted: RecordingOptions,
        run: Recorded<'_>,
        tick_log: TickLogReader,
    ) -> io::Result<Recorder> {
        let mut file = McapFile::create(wanted.out)?;
        write_metadata(&mut file, &wanted.origin, run.tick_ns, run.continuity)?;
        let (notes, receiver) = sync_channel(NOTES);
        let mut writer = RecordingWriter {
            file,
            names: NameTable::new(run.cell, run.tick_ns),
            channels: run.channels.to_vec(),
            tick_log,
            notes: receiver,
            written: RecordingStats::default(),
            freed: Vec::new(),
            freed_last_turn: Vec::new(),
            latest: 0,
            event_tick: 0,
        };
        writer.add_topics()?;
        let lost_ticks = Arc::new(AtomicU64::new(RECORDING));
        let ending = Arc::clone(&lost_ticks);
        let write_error = Arc::new(OnceLock::new());
        let error_slot = Arc::clone(&write_error);
        let write = move || {
            let written = writer.write(&ending);
            let error = written.as_ref().err().map(ToString::to_string);
            error.map(|error| error_slot.set(error));
            written
        };
        let thread = std::thread::Builder::new().name("rpi-record".into());
        Ok(Recorder {
            notes,
            lost_notes: Arc::default(),
            lost_ticks,
            write_error,
            thread: thread.spawn(write)?,
        })
    }

    /// Returns the callback that records each request when it is sent to the core.
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

    /// Returns false once the writer has stopped: no more data is written to the file.
    #[must_use]
    pub fn is_writing(&self) -> bool {
        !self.thread.is_finished()
    }

    /// Returns the error that stopped the writer, if any.
    #[must_use]
    pub fn write_error(&self) -> Option<&str> {
        self.write_error.get().map(String::as_str)
    }

    /// Ends the recording. `lost` is the number of ticks that did not fit on the tick log.
    ///
    /// # Errors
    /// Returns the first error of the output, and an error if requests or events were dropped.
    pub fn finish(self, lost: u64) -> io::Result<RecordingStats> {
        // Before the join: the writer puts the number into the metadata at the end of the file.
        self.lost_ticks.store(lost, Ordering::Release);
        let written = self.thread.join();
        let written = written.map_err(|_| io::Error::other("the writer has failed"))??;
        match self.lost_notes.load(Ordering::Relaxed) {
            0 => Ok(written),
            notes => Err(io::Error::other(format!(
                "the recording is incomplete: {} dropped",
                rpi_words::with_noun(notes, "request or event")
            ))),
        }
    }
}

impl StartRecording for RecordingOptions {
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

    fn finish(self: Box<Self>, lost: u64) -> io::Result<RecordingStats> {
        Recorder::finish(*self, lost)
    }
}

fn send_note(notes: &SyncSender<RecorderMessage>, lost: &AtomicU64, note: RecorderMessage) {
    if notes.try_send(note).is_err() {
        lost.fetch_add(1, Ordering::Relaxed);
    }
}

fn write_metadata(
    file: &mut McapFile,
    origin: &RunSources,
    tick_ns: u64,
    continuity: Continuity,
) -> io::Result<()> {
    let hash = Fnv1a::new().with_bytes(&origin.program_bytes).finish();
    let keys = [
        ("form", "1".to_owned()),
        ("tick_ns", tick_ns.to_string()),
        ("on_jump", policy_keyword(continuity).to_owned()),
        ("program", origin.program.clone()),
        ("program_hash", format!("{hash:016x}")),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    file.write_metadata("rpi", &keys)?;
    file.attach("cell.toml", "application/toml", origin.cell.as_bytes())?;
    let program = format!("program/{}", origin.program);
    file.attach(&program, "text/plain", &origin.program_bytes)
}
