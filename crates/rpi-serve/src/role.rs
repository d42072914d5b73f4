//! Roles of clients, and the rights that they have.

use std::fmt;
use std::sync::Arc;

use crate::peer::Peer;
use crate::state::ApiError;

/// Role of a client, which determines its rights. The role belongs to the client's token, or to the Unix socket at
/// which the client connects.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum Role {
    /// Reads states and values, and may request the emergency stop, as every role may.
    Viewer,
    /// Starts and stops loaded commands, and resets any emergency stop.
    Operator,
    /// Loads commands and moves devices in its own sessions. Resets an emergency stop of a client, but not one of the
    /// operator.
    #[default]
    Programmer,
    /// Has all rights, including the right to act on the sessions of other clients.
    Admin,
}

/// Right that a client must have to make a request.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Right {
    /// Request an emergency stop and read its state.
    Stop,
    /// Read states and values, and subscribe to them.
    Watch,
    /// Start, stop and set commands; set the speed override and the pause of all motions.
    Move,
    /// Open sessions, load commands and tasks, make rules, add and remove devices.
    Load,
    /// Reset an emergency stop that a client requested.
    Reset,
    /// Reset an emergency stop that the operator requested at the terminal or by an input of the cell.
    Release,
    /// Act on the sessions of other clients.
    Manage,
}

impl Right {
    /// Returns the name of the right in messages and answers.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Right::Stop => "stop",
            Right::Watch => "watch",
            Right::Move => "move",
            Right::Load => "load",
            Right::Reset => "reset",
            Right::Release => "release",
            Right::Manage => "manage",
        }
    }
}

impl Role {
    /// All roles with their names.
    pub const ALL: [(&'static str, Role); 4] = [
        ("viewer", Role::Viewer),
        ("operator", Role::Operator),
        ("programmer", Role::Programmer),
        ("admin", Role::Admin),
    ];

    /// Returns the role with this name; `None` if the name is unknown.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Role> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, role)| *role)
    }

    /// Returns the name of the role.
    #[must_use]
    pub fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, role)| *role == self);
        found.map_or("", |(name, _)| name)
    }

    /// Returns the rights of the role.
    pub(crate) fn rights(self) -> &'static [Right] {
        use Right::{Load, Manage, Move, Release, Reset, Stop, Watch};
        match self {
            Role::Viewer => &[Stop, Watch],
            Role::Operator => &[Stop, Watch, Move, Reset, Release],
            Role::Programmer => &[Stop, Watch, Move, Load, Reset],
            Role::Admin => &[Stop, Watch, Move, Load, Reset, Release, Manage],
        }
    }

    /// Returns the names of the roles that have a right, joined by "or", for messages.
    fn with(right: Right) -> String {
        let having = Self::ALL
            .iter()
            .filter(|(_, r)| r.rights().contains(&right));
        let names: Vec<&str> = having.map(|(name, _)| *name).collect();
        names.join(" or ")
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Identity of a client: network origin, name of its token, and role.
#[derive(Clone, Debug)]
pub(crate) struct Identity {
    pub(crate) peer: Peer,
    /// Name of the client's token; `None` if the server has no tokens, or for a client at a Unix socket.
    pub(crate) name: Option<Arc<str>>,
    pub(crate) role: Role,
    /// Whether the client may only request the emergency stop, because the maximum number of clients is connected.
    pub(crate) is_emergency_only: bool,
}

impl Identity {
    /// Creates the identity of a client without a token.
    pub(crate) fn unnamed(peer: Peer, role: Role) -> Identity {
        Identity {
            peer,
            name: None,
            role,
            is_emergency_only: false,
        }
    }

    /// Returns whether the client has a right. A client that may only request the emergency stop has no other right.
    pub(crate) fn may(&self, right: Right) -> bool {
        match self.is_emergency_only {
            true => right == Right::Stop,
            false => self.role.rights().contains(&right),
        }
    }

    /// Returns an error if the client lacks the right that a request needs. `what` is the name of the request, for the
    /// message.
    pub(crate) fn ensure(&self, right: Right, what: &str) -> Result<(), ApiError> {
        match (self.may(right), self.is_emergency_only) {
            (true, _) => Ok(()),
            (false, true) => Err(ApiError::NoPlace),
            (false, false) => Err(ApiError::Forbidden(format!(
                "{what} needs the right to {}: the role {} has it, this client is a {}",
                right.name(),
                Role::with(right),
                self.role
            ))),
        }
    }
}

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.name {
            Some(name) => write!(f, "{name} ({}, {})", self.role, self.peer),
            None => write!(f, "{} ({})", self.peer, self.role),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_role_may_watch_and_stop_and_only_some_release_the_operator() {
        for (name, role) in Role::ALL {
            assert_eq!(Role::from_name(name), Some(role));
            let client = Identity::unnamed(Peer::Local, role);
            assert!(
                client.may(Right::Stop) && client.may(Right::Watch),
                "{name}"
            );
            let releases = matches!(role, Role::Operator | Role::Admin);
            assert_eq!(client.may(Right::Release), releases, "{name}");
        }
        let viewer = Identity::unnamed(Peer::Local, Role::Viewer);
        let why = viewer.ensure(Right::Load, "command.load").unwrap_err();
        assert_eq!(
            why.to_string(),
            "command.load needs the right to load: the role programmer or admin has it, this client is a viewer"
        );
    }

    #[test]
    fn a_kept_place_is_for_the_emergency_stop_only() {
        let kept = Identity {
            is_emergency_only: true,
            ..Identity::unnamed(Peer::Local, Role::Admin)
        };
        assert!(kept.ensure(Right::Stop, "emergency.stop").is_ok());
        assert_eq!(
            kept.ensure(Right::Watch, "commands"),
            Err(ApiError::NoPlace)
        );
    }
}
