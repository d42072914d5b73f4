//! The host's end of a recording under way.

use std::io;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use rpi_core::Continuity;
use rpi_image::hash::Fnv;
use rpi_sim::Cell;

use super::file::{File, Output};
use super::names::Names;
use super::writer::{Note, Scribe, UNDER_WAY, Written};
use crate::control::{Event, Journal};
use crate::run::Channel;
use crate::tape::TapeOut;

/// What a run was made of, to be kept with its recording.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Origin {
    /// The program's file name.
    pub program: String,
    /// Its bytes as they were read.
    pub program_bytes: Vec<u8>,
    /// The text of the cell.
    pub cell: String,
}

/// A recording that is wanted.
pub struct Wanted {
    /// Where it goes.
    pub out: Box<dyn Output>,
    /// What is recorded.
    pub origin: Origin,
}

/// Notes that wait for the writer at most.
const NOTES: usize = 1 << 16;

/// The host's end: passes on what it knows, and waits for the writer in the end.
pub struct Recorder {
    notes: SyncSender<Note>,
    /// Notes for which there was no room: such a recording cannot be run again.
    lost: Arc<AtomicU64>,
    /// Ticks that were lost, once the end is reached.
    over: Arc<AtomicU64>,
    /// Why the writer has given up, if it has.
    trouble: Arc<OnceLock<String>>,
    thread: JoinHandle<io::Result<Written>>,
}

/// Policies, and their words in a recording.
const CONTINUITY: [(Continuity, &str); 3] = [
    (Continuity::Refuse, "refuse"),
    (Continuity::Stop, "stop"),
    (Continuity::Allow, "allow"),
];

/// The word for a policy.
pub(super) fn word_of_policy(continuity: Continuity) -> &'static str {
    let found = CONTINUITY.iter().find(|(c, _)| *c == continuity);
    found.map_or("", |(_, word)| word)
}

/// The policy behind a word.
pub(super) fn policy_by_word(word: &str) -> Option<Continuity> {
    CONTINUITY.iter().find(|(_, w)| *w == word).map(|p| p.0)
}

impl Recorder {
    /// Begins a recording.
    ///
    /// # Errors
    /// Those of the file, and of the system if it gives no thread.
    pub(crate) fn begin(
        wanted: Wanted,
        (cell, channels): (&Cell, &[Channel]),
        (tick_ns, continuity): (u64, Continuity),
        tape: TapeOut,
    ) -> io::Result<Recorder> {
        let mut file = File::create(wanted.out)?;
        describe(&mut file, &wanted.origin, tick_ns, continuity)?;
        let (notes, receiver) = sync_channel(NOTES);
        let mut scribe = Scribe {
            file,
            names: Names::new(cell, tick_ns),
            channels: channels.to_vec(),
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

    /// What is to be told each request.
    pub(crate) fn journal(&self) -> Journal {
        let (notes, lost) = (self.notes.clone(), Arc::clone(&self.lost));
        Box::new(move |ticket, asked| tell(&notes, &lost, Note::Asked(ticket, asked)))
    }

    /// Something has happened.
    pub fn event(&self, event: &Event) {
        tell(&self.notes, &self.lost, Note::Event(*event));
    }

    /// False once the writer has given up: the file takes no more.
    #[must_use]
    pub fn writes(&self) -> bool {
        !self.thread.is_finished()
    }

    /// Why the writer has given up, if the file has told.
    #[must_use]
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.get().map(String::as_str)
    }

    /// Ends the recording; `lost` ticks had no room on the tape.
    ///
    /// # Errors
    /// The first one of the file.
    pub fn finish(self, lost: u64) -> io::Result<Written> {
        self.over.store(lost, Ordering::Release);
        let written = self.thread.join();
        let written = written.map_err(|_| io::Error::other("the writer has failed"))??;
        match self.lost.load(Ordering::Relaxed) {
            0 => Ok(written),
            notes => Err(io::Error::other(format!(
                "there was no room for {}: the recording is not complete",
                rpi_diag::counted(notes, "request or event")
            ))),
        }
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
