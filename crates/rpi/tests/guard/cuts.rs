//! Completion of recordings that were cut off at any byte.

use std::collections::BTreeMap;
use std::path::Path;

use mcap::Summary;
use rpi_record::mcap::{CompletedRecording, Recording, RecordingError, complete, replay};

use crate::support::recordings::record;

/// Reason of the cut in the tests.
const REASON: &str = "the control core was ended by a test";

/// Asserts that the index of a recording is that of its messages.
pub(crate) fn assert_indexed(bytes: &[u8]) {
    let summary = Summary::read(bytes).unwrap().expect("it has a summary");
    let stats = summary.stats.as_ref().unwrap();
    let mut counts: BTreeMap<u16, u64> = BTreeMap::new();
    for message in mcap::MessageStream::new(bytes).unwrap() {
        *counts.entry(message.unwrap().channel.id).or_default() += 1;
    }
    assert_eq!(stats.channel_message_counts, counts);
    assert_eq!(stats.message_count, counts.values().sum::<u64>());
    assert_eq!(stats.chunk_count as usize, summary.chunk_indexes.len());
    let mut indexed = 0;
    for chunk in &summary.chunk_indexes {
        let indexes = summary.read_message_indexes(bytes, chunk).unwrap();
        let mut indexes: Vec<_> = indexes.into_iter().collect();
        indexes.sort_by_key(|(channel, _)| channel.id);
        for (channel, entries) in indexes {
            for entry in entries.first().iter().chain(&entries.last()) {
                let message = summary.seek_message(bytes, chunk, entry).unwrap();
                assert_eq!(message.channel.id, channel.id);
                assert_eq!(message.log_time, entry.log_time);
            }
            indexed += entries.len() as u64;
        }
    }
    assert_eq!(indexed, stats.message_count);
    assert_eq!(summary.attachment_indexes.len(), 2);
    for index in &summary.attachment_indexes {
        mcap::read::attachment(bytes, index).unwrap();
    }
    assert_eq!(summary.metadata_indexes.len(), 2);
    for index in &summary.metadata_indexes {
        mcap::read::metadata(bytes, index).unwrap();
    }
}

/// Writes the first `length` bytes to a file and completes it.
fn cut(
    (file, bytes): (&Path, &[u8]),
    length: usize,
) -> Result<Option<CompletedRecording>, RecordingError> {
    std::fs::write(file, &bytes[..length]).unwrap();
    complete(file, REASON)
}

#[test]
fn a_recording_is_completed_wherever_it_was_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--time", "4s"]);
    let bytes = std::fs::read(&file).unwrap();
    assert_eq!(complete(&file, REASON), Ok(None));
    assert_eq!(std::fs::read(&file).unwrap(), bytes, "it has not changed");
    let summary = Summary::read(&bytes).unwrap().unwrap();
    let ends = summary.chunk_indexes.iter().map(|chunk| {
        let end = chunk.chunk_start_offset + chunk.chunk_length;
        usize::try_from(end).unwrap()
    });
    // After a chunk, in and after its message indexes, and at equal distances.
    let near = ends.flat_map(|end| [end, end + 5, end + 200, end + 4000]);
    let equal = (1..20).map(|part| bytes.len() * part / 20);
    let cuts = near.chain(equal).chain([bytes.len() - 1, bytes.len() - 20]);
    let mut completed = 0;
    for length in cuts.filter(|length| *length < bytes.len()) {
        match cut((&file, &bytes), length) {
            Ok(Some(done)) => {
                assert_replays(&file, &done, length);
                completed += 1;
            }
            Ok(None) => panic!("cut after {length} bytes"),
            // The first chunk is incomplete.
            Err(why) => assert!(matches!(why, RecordingError::Missing(_)), "{why}"),
        }
    }
    assert!(completed > 20, "{completed}");
}

/// Asserts that a completed recording has an index and replays to its end.
fn assert_replays(file: &Path, done: &CompletedRecording, length: usize) {
    let bytes = std::fs::read(file).unwrap();
    assert_indexed(&bytes);
    assert_eq!(complete(file, REASON), Ok(None), "cut after {length} bytes");
    let recording = Recording::open(file).unwrap();
    let report = replay(&recording).unwrap();
    assert_eq!(report.difference, None, "cut after {length} bytes");
    let cut = report.cut.as_deref();
    // Without its index only, the recording has its end.
    assert!(cut.is_none() || cut == Some(REASON), "{cut:?}");
    // The last entry of a complete recording may be that of the end of the run, without a tick.
    assert!(done.ticks.abs_diff(report.ticks) <= 1, "{done:?} {report}");
}

#[test]
fn files_that_are_no_recordings_stay_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.mcap");
    assert!(matches!(
        complete(&file, REASON),
        Err(RecordingError::Unreadable(_))
    ));
    for bytes in [&b""[..], b"short", b"a text that is not a recording"] {
        std::fs::write(&file, bytes).unwrap();
        assert!(matches!(
            complete(&file, REASON),
            Err(RecordingError::Missing(_))
        ));
        assert_eq!(std::fs::read(&file).unwrap(), bytes);
    }
}
