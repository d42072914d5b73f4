//! Notifications to the service manager, with and without a guard.

use std::os::unix::net::UnixDatagram;
use std::time::Duration;

use crate::process::{Process, signal, wait_until};

/// Socket of a service manager, with everything that it has received.
struct Manager {
    socket: UnixDatagram,
    path: String,
    received: String,
}

impl Manager {
    fn new(folder: &tempfile::TempDir) -> Manager {
        let path = folder.path().join("notify.sock");
        let socket = UnixDatagram::bind(&path).unwrap();
        socket
            .set_read_timeout(Some(Duration::from_millis(10)))
            .unwrap();
        Manager {
            socket,
            path: path.to_str().unwrap().to_owned(),
            received: String::new(),
        }
    }

    /// Starts a server whose service manager this is, with a watchdog of 300 ms.
    fn start(&self, options: &[&str]) -> Process {
        let mut arguments = vec!["serve", "--listen", "127.0.0.1:0"];
        arguments.extend(options);
        let variables = [("NOTIFY_SOCKET", &*self.path), ("WATCHDOG_USEC", "300000")];
        Process::start(&arguments, &variables)
    }

    fn receive(&mut self) {
        let mut bytes = [0; 1024];
        while let Ok(count) = self.socket.recv(&mut bytes) {
            self.received += &format!("{}\n", String::from_utf8_lossy(&bytes[..count]));
        }
    }

    /// Waits until a line was received this many times.
    fn wait_for(&mut self, line: &str, times: usize) {
        let mut received = String::new();
        wait_until(
            || {
                self.receive();
                received.clone_from(&self.received);
                self.received.lines().filter(|l| *l == line).count() >= times
            },
            || format!("{line} is missing"),
        );
    }
}

#[test]
fn the_service_manager_is_notified_of_start_cycles_and_end() {
    for options in [&[] as &[&str], &["--guard"]] {
        let folder = tempfile::tempdir().unwrap();
        let mut manager = Manager::new(&folder);
        let server = manager.start(options);
        manager.wait_for("READY=1", 1);
        manager.wait_for("WATCHDOG=1", 3);
        assert!(
            manager.received.starts_with("READY=1"),
            "{}",
            manager.received
        );
        signal(server.id(), "-TERM");
        manager.wait_for("STOPPING=1", 1);
        let (status, text) = server.end();
        assert_eq!(status, Some(0), "{text}");
    }
}

/// Without cycles, the watchdog of the service manager gets no notification and expires.
#[test]
fn a_stalled_core_does_not_notify_the_watchdog() {
    let folder = tempfile::tempdir().unwrap();
    let mut manager = Manager::new(&folder);
    let server = manager.start(&["--restart", "--stall-timeout", "3s"]);
    manager.wait_for("WATCHDOG=1", 1);
    let core = server.core(None);
    signal(core, "-STOP");
    std::thread::sleep(Duration::from_millis(500));
    manager.receive();
    manager.received.clear();
    std::thread::sleep(Duration::from_secs(1));
    manager.receive();
    assert_eq!(manager.received, "");
    // After the restart, the watchdog is notified again.
    manager.wait_for("WATCHDOG=1", 2);
    assert!(
        manager
            .received
            .contains("STATUS=restarted, because the core stalled")
    );
    signal(server.id(), "-TERM");
    assert_eq!(server.end().0, Some(0));
}
