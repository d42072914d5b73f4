//! Resource limits per server and the policy for commands of a disconnected client.

use std::time::Duration;

/// Resource limits. A request beyond a limit is rejected or its connection is closed; the control cycle is never slowed
/// down.
///
/// For connections, sessions, commands, memory and rules, a client may hold at most as much as it leaves free for
/// others. All clients of one peer (an address, an IPv6 network, or this machine) together may hold at most three times
/// that.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Limits {
    /// Maximum number of connections that may be open at the same time.
    pub connections: usize,
    /// Number of open sessions.
    pub sessions: usize,
    /// Number of commands in the table plus tasks, over all sessions.
    pub commands: usize,
    /// Number of active rules, over all sessions.
    pub rules: usize,
    /// Total size of all active rules: facts in their conditions plus commands that they stop, cancel and start. The
    /// cycle evaluates all of them in each tick.
    pub rule_size: usize,
    /// Memory slots (8 bytes each) that one request may set: numbers or array elements.
    pub values_per_request: usize,
    /// Number of devices, including those of the cell.
    pub devices: usize,
    /// Size of one message in bytes.
    pub message_bytes: usize,
    /// Memory of commands and tasks in bytes, over all sessions.
    pub memory_bytes: usize,
    /// Number of values in one JSON message, those inside of others included. A value takes more memory than its text.
    pub json_values: usize,
    /// Number of requests in one batch.
    pub batch_requests: usize,
    /// Number of messages that may be queued for a client that does not read them.
    pub queued_messages: usize,
    /// Total size in bytes of the messages that may be queued for a client, and of the answers to one batch.
    pub queued_bytes: usize,
    /// Number of subscriptions of one client.
    pub subscriptions: usize,
    /// Length of a session, command or device name in bytes. A longer device name is rejected, any other one is
    /// truncated.
    pub name_bytes: usize,
    /// Number of loads of one client that may be queued. Clients take turns.
    pub queued_loads: usize,
    /// Timeout from the first to the last byte of a request head.
    pub request_timeout: Duration,
    /// Delay before a request with a wrong token is answered.
    pub wrong_token_delay: Duration,
    /// Timeout without any message, answers to pings included, from a client of the native interface over a websocket.
    pub idle_timeout: Duration,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            connections: 64,
            sessions: 32,
            commands: 256,
            rules: 1024,
            rule_size: 4096,
            values_per_request: 4096,
            devices: 64,
            message_bytes: 16 << 20,
            memory_bytes: 512 << 20,
            json_values: 1 << 17,
            batch_requests: 1024,
            queued_messages: 4096,
            queued_bytes: 16 << 20,
            subscriptions: 1024,
            name_bytes: 256,
            queued_loads: 32,
            request_timeout: Duration::from_secs(5),
            wrong_token_delay: Duration::from_secs(1),
            idle_timeout: Duration::from_secs(30),
        }
    }
}

/// Policy for the commands of a session whose client has disconnected.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum OnLoss {
    /// Commands keep running; another client may take the session over.
    RunOn,
    /// Running commands are cancelled and end on their path; waiting ones are unloaded.
    #[default]
    Cancel,
    /// Commands end at once, and their devices stop within their own limits.
    Abort,
}

impl OnLoss {
    /// All policies with their names.
    pub const ALL: [(&'static str, OnLoss); 3] = [
        ("run-on", OnLoss::RunOn),
        ("cancel", OnLoss::Cancel),
        ("abort", OnLoss::Abort),
    ];

    /// Returns the policy with this name.
    pub fn from_name(name: &str) -> Option<OnLoss> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, policy)| *policy)
    }
}
