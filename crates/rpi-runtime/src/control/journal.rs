//! Requests in the form in which they are recorded.

use std::sync::Arc;

use rpi_core::{CommandId, Continuity, OnOverrun, Rule, RuleId, Why};
use rpi_image::Image;

use super::event::Ticket;
use super::queue::{Request, Setting};

/// A request with all data needed to repeat it.
#[derive(Clone, Debug)]
pub enum Asked {
    /// Loads a command from an image, with its policies for discontinuities and overruns.
    Load(CommandId, Arc<Image>, Continuity, OnOverrun),
    /// Starts a command.
    Start(CommandId),
    /// Takes a command off the schedule.
    Unschedule(CommandId),
    /// Requests a command to end.
    Cancel(CommandId),
    /// Ends a command immediately.
    Abort(CommandId, Why),
    /// Unloads a command.
    Unload(CommandId),
    /// Adds a rule.
    Schedule(RuleId, Rule),
    /// Removes a rule.
    Withdraw(RuleId),
    /// Sets inputs.
    Set(Vec<Setting>),
    /// Subscribes to exported flows (by index), with a period in cycles.
    Subscribe(CommandId, Vec<u32>, u64),
    /// Inserts or removes the device at this index. The device itself is not recorded.
    Device(usize),
    /// Stops all commands.
    EmergencyStop,
}

impl Asked {
    pub(super) fn of<T>(request: &Request<T>) -> Asked {
        match request {
            Request::Insert(id, command, _) => {
                let image = Arc::clone(command.machine().image());
                Asked::Load(*id, image, command.continuity(), command.on_overrun())
            }
            Request::Start(id) => Asked::Start(*id),
            Request::Unschedule(id) => Asked::Unschedule(*id),
            Request::Cancel(id) => Asked::Cancel(*id),
            Request::Abort(id, why) => Asked::Abort(*id, *why),
            Request::Unload(id) => Asked::Unload(*id),
            Request::Schedule(id, rule) => Asked::Schedule(*id, (**rule).clone()),
            Request::Withdraw(id) => Asked::Withdraw(*id),
            Request::Set(settings) => Asked::Set(settings.to_vec()),
            Request::Subscribe(s) => Asked::Subscribe(s.command, s.exports().collect(), s.every),
            Request::Device(place, _) => Asked::Device(*place),
            Request::EmergencyStop => Asked::EmergencyStop,
        }
    }
}

/// Callback for each request before it is sent. The callback therefore knows a command before any event about it
/// arrives.
pub type Journal = Box<dyn FnMut(Ticket, Asked) + Send>;
