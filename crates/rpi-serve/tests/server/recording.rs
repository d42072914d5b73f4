//! A server is recorded, and a replay of the recording gives the same bits.

use std::fs::File;
use std::io::{self, BufWriter, Cursor, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use rpi_record::mcap::{
    Output, PartLimits, Profile, Recording, RecordingOptions, ReplayReport, RunSources, replay,
    single_part,
};
use rpi_serve::Server;
use rpi_sim::Cell;

use crate::client::{CELL, Client, PATIENCE, get, settings};
use crate::nets::{ECHO, hold, swing};

/// Opens a server with the arm of the other tests that records into a file.
pub(crate) fn recorded(path: &Path) -> Server {
    recorded_cell(path, CELL)
}

/// Opens a server with this cell that records into a file.
pub(crate) fn recorded_cell(path: &Path, cell: &str) -> Server {
    recording_to(BufWriter::new(File::create(path).unwrap()), cell)
}

fn recording_to(out: impl Output + 'static, text: &str) -> Server {
    let cell = Cell::parse("cell.toml", text).unwrap_or_else(|errors| panic!("{errors}"));
    let wanted = RecordingOptions {
        parts: single_part(out),
        limits: PartLimits::default(),
        profile: Profile::default(),
        origin: RunSources {
            program: "server".to_owned(),
            program_bytes: Vec::new(),
            cell: text.to_owned(),
        },
    };
    Server::open_recorded(&cell, &settings(), (), Some(wanted)).unwrap()
}

/// A disk with a capacity in bytes.
struct Disk(Cursor<Vec<u8>>, u64);

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.position() + bytes.len() as u64 > self.1 {
            true => Err(io::ErrorKind::StorageFull.into()),
            false => self.0.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Disk {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

/// The error of a full disk is reported at once and not only at the end; commands keep running.
#[test]
fn a_full_disk_is_told_at_once_and_stops_nothing() {
    let server = recording_to(Disk(Cursor::default(), 64 << 10), CELL);
    let mut client = Client::dio(server.address());
    let session = client.ask("nse(\"test\")").unwrap();
    let net = client.load(&session, &swing(0, 1e9));
    client.ask(&format!("nest(\"{net}\")")).unwrap();
    let begin = Instant::now();
    let mut warnings = Vec::new();
    while warnings.is_empty() {
        assert!(begin.elapsed() < PATIENCE, "64 kB are not enough");
        std::thread::sleep(Duration::from_millis(5));
        warnings = server.warnings();
    }
    let warning = "RECORDING STOPPED: no storage space";
    assert_eq!(warnings, [warning]);
    assert!(server.warnings().is_empty(), "there is one warning");
    let log = get(server.address(), "/log");
    assert!(log.contains(warning), "{log}");
    let page = get(server.address(), "/nets");
    assert!(page.contains("Running"), "{page}");
    let why = server.close().unwrap_err();
    assert_eq!(why.kind(), io::ErrorKind::StorageFull, "{why}");
}

/// Sends loads, values, a takeover, a cancel, an abort and unloads, and closes the session.
fn traffic(client: &mut Client) {
    let session = client.ask("nse(\"test\")").unwrap();
    let texts = [swing(0, 0.05), hold(0), ECHO.to_owned()];
    let [first, second, echo] = texts.map(|text| client.load(&session, &text));
    let blend = format!("nesc(\"{first}.out_1\",[\"{first}\"],[],[\"{second}\"])");
    let rule = client.ask(&blend).unwrap();
    client.send(&format!("r=gsy(\"{rule}\")"));
    for net in [&echo, &first] {
        client.ask(&format!("nest(\"{net}\")")).unwrap();
    }
    let set = format!("snc({{\"{echo}\":{{\"ingain\":\"21.0\"}}}})");
    client.ask(&set).unwrap();
    client.wait("the takeover", |text| {
        text.contains("r=rs(\"FIRED\")").then_some(())
    });
    client.ask(&format!("neca(\"{echo}\")")).unwrap();
    client.ask(&format!("neab(\"{second}\")")).unwrap();
    client.ask(&format!("neun(\"{first}\")")).unwrap();
    client.ask(&format!("ase(\"{session}\")")).unwrap();
}

pub(crate) fn again(path: &Path) -> ReplayReport {
    let recording = Recording::read(&std::fs::read(path).unwrap()).unwrap();
    replay(&recording).unwrap()
}

#[test]
fn what_clients_asked_for_gives_the_same_bits_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.mcap");
    let server = recorded(&path);
    (0..3).for_each(|_| traffic(&mut Client::dio(server.address())));
    let written = server.close().unwrap().unwrap();
    assert_eq!(written.lost, 0);
    let report = again(&path);
    assert!(report.agrees(), "{report}");
    assert_eq!((report.ticks, report.commands), (written.ticks, 9));
    assert!(report.values > 100 && report.events > 60, "{report}");
}

#[test]
fn what_comes_after_a_change_of_devices_is_not_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.mcap");
    let server = recorded(&path);
    let mut client = Client::dio(server.address());
    traffic(&mut client);
    let made = crate::client::post(server.address(), "/devices/", "name=two&type=kuka_lwr_sim");
    assert!(made.contains("200"), "{made}");
    traffic(&mut client);
    server.close().unwrap().unwrap();
    let report = again(&path);
    assert_eq!(report.difference, None);
    assert_eq!(report.commands, 3);
    assert!(report.devices.is_some_and(|tick| tick == report.ticks));
    assert!(!report.agrees());
}
