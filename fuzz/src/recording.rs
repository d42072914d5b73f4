//! Entry points for files about runs: recordings, traces and cell descriptions.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

use rpi_image::Image;
use rpi_record::mcap::{
    PartLimits, Profile, Recording, RecordingOptions, RunOutputs, RunSources, TimeAxis, cut, merge,
    replay, single_part,
};
use rpi_record::trace::Trace;
use rpi_runtime::realtime::{RealTime, TimeBase};
use rpi_runtime::run::{ExecutablePlan, Limits, RunOptions, run};
use rpi_sim::Cell;

use crate::seeds::{self, Seed};

/// Number of ticks for which a run is recorded as an input of the initial corpus.
const TICKS: u64 = 20;
/// Maximum number of recordings in the initial corpus for each encoding of recordings.
const RECORDINGS: usize = 12;

/// Ticks of the part that is cut out of a recording.
const PART: std::ops::Range<u64> = 1..TICKS / 2;

/// Entry point of the fuzzer for recordings: reads a recording, replays it, cuts it and merges it with itself.
pub(crate) fn read(input: &[u8]) {
    let Ok(recording) = Recording::read(input) else {
        return;
    };
    let _ = replay(&recording).map(|report| report.to_string());
    let part = Buffer::default();
    if cut(&recording, &PART, part.clone()).is_ok() {
        let read = Recording::read(&part.lock());
        assert!(read.is_ok(), "a part is a recording: {:?}", read.err());
    }
    let both = [("one", recording.clone()), ("other", recording)];
    let both = both.map(|(name, recording)| (name.to_owned(), recording));
    let _ = merge(&both, TimeAxis::Start, Buffer::default());
}

/// Entry point of the fuzzer for traces: parses a trace.
pub(crate) fn parse_trace(input: &[u8]) {
    let _ = Trace::parse(&String::from_utf8_lossy(input));
}

/// Entry point of the fuzzer for cell descriptions: parses a description, and simulates the cell or prints the errors.
pub(crate) fn parse_cell(input: &[u8]) {
    match Cell::parse("cell.toml", &String::from_utf8_lossy(input)) {
        Ok(cell) => drop(rpi_sim::SimBank::new(&cell, 1e-3)),
        Err(errors) => assert!(!errors.to_string().is_empty()),
    }
}

/// Returns the initial corpus for recordings: runs of programs that need no device. The files have no compression and
/// no checksums, so that mutations reach the content.
pub(crate) fn seeds() -> Vec<Seed> {
    let images = seeds::images();
    let loaded = images
        .iter()
        .filter_map(|seed| Some((&seed.name, Image::from_bytes(&seed.bytes).ok()?)));
    let closed = loaded.filter(|(_, image)| image.sensors.is_empty() && image.actuators.is_empty());
    let chosen: Vec<(&String, Arc<Image>)> = closed
        .take(RECORDINGS)
        .map(|(name, image)| (name, Arc::new(image)))
        .collect();
    let recorded = Profile::ALL.into_iter().flat_map(|(kind, profile)| {
        let each = chosen.iter().filter_map(move |(name, image)| {
            Some(Seed {
                name: format!("{kind}-{name}.mcap"),
                bytes: plain(&record(image, profile)?)?,
            })
        });
        each.collect::<Vec<_>>()
    });
    recorded.collect()
}

/// Output in memory whose content can be read while it is written.
#[derive(Clone, Default)]
struct Buffer(Arc<Mutex<Vec<u8>>>);

impl Buffer {
    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Write for Buffer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.lock().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn record(image: &Arc<Image>, profile: Profile) -> Option<Vec<u8>> {
    let out = Buffer::default();
    let cell = Cell::default();
    let recording = RecordingOptions {
        parts: single_part(out.clone()),
        limits: PartLimits::default(),
        profile,
        origin: RunSources::default(),
    };
    let outcome = run(RunOptions {
        images: std::slice::from_ref(image),
        plans: &[ExecutablePlan::once(0)],
        cell: &cell,
        time_base: TimeBase::Simulated,
        real_time: RealTime::default(),
        continuity: rpi_core::Continuity::default(),
        budget: None,
        controls: rpi_core::MotionControls::default(),
        limits: Limits {
            ticks: Some(TICKS),
            planning_ns: 0,
        },
        interrupted: Arc::default(),
        emergency: Arc::default(),
        next_tick: Arc::default(),
        settings: &[],
        recording: Some(Box::new(RunOutputs::from(recording))),
        sink: &mut (),
        progress: None,
    });
    outcome.ok()?;
    let bytes = out.lock().clone();
    Some(bytes)
}

/// Returns a copy of a recording without compression and checksums; `None` if the recording is invalid.
fn plain(bytes: &[u8]) -> Option<Vec<u8>> {
    let options = mcap::WriteOptions::new()
        .compression(None)
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false)
        .calculate_summary_section_crc(false)
        .calculate_attachment_crcs(false);
    let mut writer = options.create(io::Cursor::new(Vec::new())).ok()?;
    for record in mcap::read::LinearReader::new(bytes).ok()? {
        match record.ok()? {
            mcap::records::Record::Attachment { header, data, .. } => {
                let attachment = mcap::Attachment {
                    log_time: 0,
                    create_time: 0,
                    name: header.name,
                    media_type: header.media_type,
                    data,
                };
                writer.attach(&attachment).ok()?;
            }
            // The end record is written after the messages.
            mcap::records::Record::Metadata(metadata) if metadata.name == "rpi" => {
                writer.write_metadata(&metadata).ok()?;
            }
            mcap::records::Record::Metadata(end) => {
                for message in mcap::MessageStream::new(bytes).ok()? {
                    writer.write(&message.ok()?).ok()?;
                }
                writer.write_metadata(&end).ok()?;
            }
            _ => {}
        }
    }
    writer.finish().ok()?;
    Some(writer.into_inner().into_inner())
}
