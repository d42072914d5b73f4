//! Requests as they leave for the cycle, for whoever writes them down.

use std::sync::Arc;

use rpi_core::{CommandId, Continuity, OnOverrun, Rule, RuleId, Why};
use rpi_image::Image;

use super::event::Ticket;
use super::queue::{Request, Setting};

/// A request, with all that is needed to make it again.
#[derive(Clone, Debug)]
pub enum Asked {
    /// A command was loaded from this image, with these policies for jumps and for cycles that take too long.
    Load(CommandId, Arc<Image>, Continuity, OnOverrun),
    /// To start.
    Start(CommandId),
    /// To take off the schedule.
    Unschedule(CommandId),
    /// To ask to end.
    Cancel(CommandId),
    /// To end by force.
    Abort(CommandId, Why),
    /// To give back.
    Unload(CommandId),
    /// To make a rule.
    Schedule(RuleId, Rule),
    /// To drop a rule.
    Withdraw(RuleId),
    /// To set inputs.
    Set(Vec<Setting>),
    /// To see exported flows (by index) in every so many cycles.
    Subscribe(CommandId, Vec<u32>, u64),
    /// To put a device into a place; which one is not kept.
    Device(usize),
    /// To stop everything.
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

/// Is told each request before it leaves: so it knows of a command before anything of it can come back.
pub type Journal = Box<dyn FnMut(Ticket, Asked) + Send>;
