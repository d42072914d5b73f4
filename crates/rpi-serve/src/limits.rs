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
    /// Maximum number of clients over the network that may be connected at the same time.
    pub connections: usize,
    /// Maximum numbers of the other connections: unauthenticated ones, those at Unix sockets, and those for emergency
    /// stops.
    pub places: PlaceLimits,
    /// Maximum number of sessions that are open at the same time, over all clients.
    pub sessions: usize,
    /// Maximum number of commands in the core's table plus tasks, over all sessions.
    pub commands: usize,
    /// Maximum number of active rules, over all sessions.
    pub rules: usize,
    /// Maximum total size of all active rules. The size of a rule is the number of facts in its condition plus the
    /// number of commands that it stops, cancels and starts. The cycle evaluates all active rules in each tick.
    pub rule_size: usize,
    /// Maximum number of memory slots (8 bytes each: numbers or array elements) that one request may set.
    pub values_per_request: usize,
    /// Maximum number of devices, including those of the cell.
    pub devices: usize,
    /// Maximum size of one message of a client, in bytes.
    pub message_bytes: usize,
    /// Maximum memory that clients may use, over all clients.
    pub memory: MemoryLimits,
    /// Maximum number of values in one message, counting nested values. A value takes more memory than its text.
    pub json_values: usize,
    /// Maximum number of requests that a client may send in one JSON-RPC batch.
    pub batch_requests: usize,
    /// Maximum number of messages that may be queued for a client. A client whose queue is full is disconnected.
    pub queued_messages: usize,
    /// Maximum total size in bytes of the messages that may be queued for a client. The answers to one batch may have
    /// half of it.
    pub queued_bytes: usize,
    /// Maximum number of subscriptions of one client.
    pub subscriptions: usize,
    /// Maximum length of a session, command, task or device name in bytes. A longer device name is rejected; any other
    /// name is truncated.
    pub name_bytes: usize,
    /// Maximum number of queued load requests of one client. The clients with queued requests take turns.
    pub queued_loads: usize,
    /// Timeout from the first to the last byte of a request head.
    pub request_timeout: Duration,
    /// Delay before a request with a wrong token is answered.
    pub wrong_token_delay: Duration,
    /// Time after which a websocket client of JSON-RPC is disconnected if it sends nothing, not even an answer to a
    /// ping.
    pub idle_timeout: Duration,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            connections: 64,
            places: PlaceLimits::default(),
            sessions: 32,
            commands: 256,
            rules: 1024,
            rule_size: 4096,
            values_per_request: 4096,
            devices: 64,
            message_bytes: 16 << 20,
            memory: MemoryLimits::default(),
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

/// Maximum memory in bytes that clients may use, over all clients.
///
/// The memory of a server with these limits grows by less than 300 MB above its start, whatever clients send, if the
/// allocator returns freed memory to the system. `rpi serve` sets the allocator of glibc so.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MemoryLimits {
    /// Maximum memory of commands and tasks, over all sessions.
    pub commands: usize,
    /// Maximum memory of messages that are being received. A message takes twice its length. A connection with less than
    /// 128 KiB does not count.
    pub incoming: usize,
    /// Maximum memory of messages that are queued for clients. A connection with less than 128 KiB does not count.
    pub outgoing: usize,
}

impl Default for MemoryLimits {
    fn default() -> MemoryLimits {
        MemoryLimits {
            commands: 128 << 20,
            incoming: 80 << 20,
            outgoing: 48 << 20,
        }
    }
}

/// Maximum numbers of connections, apart from those of authenticated clients over the network.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PlaceLimits {
    /// Maximum number of network connections that are not authenticated yet. The oldest one of the peer with most of
    /// them is closed for a new one.
    pub unauthenticated: usize,
    /// Maximum number of clients at the Unix sockets.
    pub socket: usize,
    /// Maximum number of clients beyond the other limits. Such a client may only request the emergency stop. The oldest
    /// one of the peer with most of them is closed for a new one.
    pub emergency: usize,
}

impl Default for PlaceLimits {
    fn default() -> PlaceLimits {
        PlaceLimits {
            unauthenticated: 32,
            socket: 64,
            emergency: 8,
        }
    }
}

/// Policy for the commands of a session whose client has disconnected.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum OnLoss {
    /// Commands keep running. Another client may take over the session.
    RunOn,
    /// Running commands are cancelled, so that their programs bring the motion to an end. Commands that do not run are
    /// unloaded.
    #[default]
    Cancel,
    /// Commands are aborted at once, and moving devices brake within their own limits.
    Abort,
}

impl OnLoss {
    /// All policies with their names in requests and options.
    pub const ALL: [(&'static str, OnLoss); 3] = [
        ("run-on", OnLoss::RunOn),
        ("cancel", OnLoss::Cancel),
        ("abort", OnLoss::Abort),
    ];

    /// Returns the policy with this name; `None` if the name is unknown.
    pub fn from_name(name: &str) -> Option<OnLoss> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, policy)| *policy)
    }
}
