//! How much a client may ask for, and what becomes of its commands once it is gone.

use std::time::Duration;

/// What the server grants; beyond it requests are refused and connections closed, never the cycle slowed down.
///
/// Of connections, sessions, commands, memory and rules no client has more than it leaves free for others, and all clients from one
/// place (an address, a network of IPv6, this machine) together have at most three times that.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Limits {
    /// Connections at a time.
    pub connections: usize,
    /// Sessions at a time.
    pub sessions: usize,
    /// Commands in the table, and tasks, of all sessions.
    pub commands: usize,
    /// Rules at a time, of all sessions.
    pub rules: usize,
    /// What all rules at a time may say: facts in their conditions, and commands that they stop, cancel and start. The cycle looks
    /// at all of it in each tick.
    pub facts: usize,
    /// Cells of memory (8 bytes) that one request may set: numbers, or parts of arrays.
    pub values: usize,
    /// Devices at a time, those of the cell included.
    pub devices: usize,
    /// Bytes of one message.
    pub message: usize,
    /// Bytes of memory that commands and tasks may take, of all sessions.
    pub memory: usize,
    /// Messages that may wait for a client that does not read them.
    pub outbox: usize,
    /// Things that one client may watch.
    pub watches: usize,
    /// Bytes of a name: of a session, a command, a device. Longer ones of devices are refused, others cut off.
    pub name: usize,
    /// Loads of one client that may wait; clients take turns.
    pub loads: usize,
    /// How long a client may take from the first byte of a request head to its last.
    pub patience: Duration,
    /// How long who shows a wrong token waits for the answer.
    pub penance: Duration,
    /// How long a client of the native interface may be silent over a websocket, answers to pings included.
    pub silence: Duration,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            connections: 64,
            sessions: 32,
            commands: 256,
            rules: 1024,
            facts: 4096,
            values: 4096,
            devices: 64,
            message: 16 << 20,
            memory: 512 << 20,
            outbox: 4096,
            watches: 1024,
            name: 256,
            loads: 32,
            patience: Duration::from_secs(5),
            penance: Duration::from_secs(1),
            silence: Duration::from_secs(30),
        }
    }
}

/// What becomes of the commands of a session whose client is gone.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum OnLoss {
    /// They run on; another client may look after them.
    RunOn,
    /// They are asked to end, on path; what waits is unloaded.
    #[default]
    Cancel,
    /// They end at once, and their devices stop on their own limits.
    Abort,
}

impl OnLoss {
    /// All policies by name.
    pub const ALL: [(&'static str, OnLoss); 3] = [
        ("run-on", OnLoss::RunOn),
        ("cancel", OnLoss::Cancel),
        ("abort", OnLoss::Abort),
    ];

    /// The policy of this name.
    pub fn by_name(name: &str) -> Option<OnLoss> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, policy)| *policy)
    }
}
