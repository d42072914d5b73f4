//! Host side of a running recording.

use std::io;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use rpi_core::Continuity;
use rpi_image::hash::Fnv;
use rpi_runtime::control::{Control, Event, Executive, Journal};
use rpi_runtime::run::{Camera, Recorded, RunRecorder, StartRecording, Written};
use rpi_runtime::tape::{TapeOut, Taped};
use rpi_sim::{Cell, SimBank};

use super::file::{File, Output};
use super::names::Names;
use super::writer::{Note, Scribe, UNDER_WAY};

/// Program and cell of a run, stored in its recording.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Origin {
    /// File name of the program.
    pub program: String,
    /// Content of the program file.
    pub program_bytes: Vec<u8>,
    /// Text of the cell description.
    pub cell: String,
}

/// Options of a new recording.
pub struct Wanted {
    /// Destination of the recording.
    pub out: Box<dyn Output>,
    /// Program and cell that are stored in the recording.
    pub origin: Origin,
}

/// Capacity of the queue of notes to the writer.
const NOTES: usize = 1 << 16;

/// Host side of a recording: forwards requests and events to the writer thread and joins it at the end.
pub struct Recorder {
    notes: SyncSender<Note>,
    /// Number of notes dropped because the queue was full. A recording with dropped notes cannot be replayed.
    lost: Arc<AtomicU64>,
    /// Number of lost ticks, set when the recording ends.
    over: Arc<AtomicU64>,
    /// Error that stopped the writer, if any.
    trouble: Arc<OnceLock<String>>,
    thread: JoinHandle<io::Result<Written>>,
}

/// Starts recording a core and its devices.
///
/// Returns the recorder for the host and the camera for the cycle. `continuity` is the policy of commands that have
/// none of their own.
///
/// # Errors
/// Returns the errors of the output, and an error if no thread can be created.
pub fn record(
    wanted: Wanted,
    cell: &Cell,
    (tick_ns, continuity): (u64, Continuity),
    (control, executive): (&mut Control, &mut Executive<Taped<SimBank>>),
) -> io::Result<(Recorder, Camera)> {
    let (camera, tape, channels) = Camera::begin(cell, executive);
    let run = Recorded {
        cell,
        channels: &channels,
        tick_ns,
        continuity,
    };
    let recorder = Recorder::begin(wanted, run, tape)?;
    control.write_down(recorder.journal());
    Ok((recorder, camera))
}

/// Continuity policies and their keywords in a recording.
const CONTINUITY: [(Continuity, &str); 3] = [
    (Continuity::Refuse, "refuse"),
    (Continuity::Stop, "stop"),
    (Continuity::Allow, "allow"),
];

/// Returns the keyword of a policy.
pub(super) fn word_of_policy(continuity: Continuity) -> &'static str {
    let found = CONTINUITY.iter().find(|(c, _)| *c == continuity);
    found.map_or("", |(_, word)| word)
}

/// Returns the policy of a keyword.
pub(super) fn policy_by_word(word: &str) -> Option<Continuity> {
    CONTINUITY.iter().find(|(_, w)| *w == word).map(|p| p.0)
}

impl Recorder {
    /// Starts a recording and its writer thread.
    ///
    /// # Errors
    /// Returns the errors of the output, and an error if no thread can be created.
    fn begin(wanted: Wanted, run: Recorded<'_>, tape: TapeOut) -> io::Result<Recorder> {
        let mut file = File::create(wanted.out)?;
        describe(&mut file, &wanted.origin, run.tick_ns, run.continuity)?;
        let (notes, receiver) = sync_channel(NOTES);
        let mut scribe = Scribe {
            file,
            names: Names::new(run.cell, run.tick_ns),
            channels: run.channels.to_vec(),
            tape,
            notes: receiver,
            written: Written::default(),
            freed: Vec::new(),
            freed_before: Vec::new(),
            latest: 0,
            told: 0,
        };
        scribe.begin()?;
        let over = Arc::new(AtomicU64::new(UNDER_WAY));
        let ending = Arc::clone(&over);
        let trouble = Arc::new(OnceLock::new());
        let told = Arc::clone(&trouble);
        let write = move || {
            let written = scribe.write(&ending);
            let why = written.as_ref().err().map(ToString::to_string);
            why.map(|why| told.set(why));
            written
        };
        let thread = std::thread::Builder::new().name("rpi-record".into());
        Ok(Recorder {
            notes,
            lost: Arc::default(),
            over,
            trouble,
            thread: thread.spawn(write)?,
        })
    }

    /// Returns the callback that records each request.
    fn journal(&self) -> Journal {
        let (notes, lost) = (self.notes.clone(), Arc::clone(&self.lost));
        Box::new(move |ticket, asked| tell(&notes, &lost, Note::Asked(ticket, asked)))
    }

    /// Records an event.
    pub fn event(&self, event: &Event) {
        tell(&self.notes, &self.lost, Note::Event(*event));
    }

    /// Returns false once the writer has stopped: no more data is written to the file.
    #[must_use]
    pub fn writes(&self) -> bool {
        !self.thread.is_finished()
    }

    /// Returns the error that stopped the writer, if any.
    #[must_use]
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.get().map(String::as_str)
    }

    /// Ends the recording. `lost` is the number of ticks that did not fit on the tape.
    ///
    /// # Errors
    /// Returns the first error of the output, and an error if requests or events were dropped.
    pub fn finish(self, lost: u64) -> io::Result<Written> {
        self.over.store(lost, Ordering::Release);
        let written = self.thread.join();
        let written = written.map_err(|_| io::Error::other("the writer has failed"))??;
        match self.lost.load(Ordering::Relaxed) {
            0 => Ok(written),
            notes => Err(io::Error::other(format!(
                "the recording is incomplete: {} dropped",
                rpi_words::counted(notes, "request or event")
            ))),
        }
    }
}

impl StartRecording for Wanted {
    fn start(
        self: Box<Self>,
        run: Recorded<'_>,
        tape: TapeOut,
    ) -> io::Result<Box<dyn RunRecorder>> {
        Ok(Box::new(Recorder::begin(*self, run, tape)?))
    }
}

impl RunRecorder for Recorder {
    fn journal(&self) -> Journal {
        Recorder::journal(self)
    }

    fn event(&self, event: &Event) {
        Recorder::event(self, event);
    }

    fn writes(&self) -> bool {
        Recorder::writes(self)
    }

    fn finish(self: Box<Self>, lost: u64) -> io::Result<Written> {
        Recorder::finish(*self, lost)
    }
}

fn tell(notes: &SyncSender<Note>, lost: &AtomicU64, note: Note) {
    if notes.try_send(note).is_err() {
        lost.fetch_add(1, Ordering::Relaxed);
    }
}

fn describe(
    file: &mut File,
    origin: &Origin,
    tick_ns: u64,
    continuity: Continuity,
) -> io::Result<()> {
    let hash = Fnv::new().bytes(&origin.program_bytes).finish();
    let keys = [
        ("form", "1".to_owned()),
        ("tick_ns", tick_ns.to_string()),
        ("on_jump", word_of_policy(continuity).to_owned()),
        ("program", origin.program.clone()),
        ("program_hash", format!("{hash:016x}")),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    file.metadata("rpi", &keys)?;
    file.attach("cell.toml", "application/toml", origin.cell.as_bytes())?;
    let program = format!("program/{}", origin.program);
    file.attach(&program, "text/plain", &origin.program_bytes)
}
