//! Requests in the form in which they are recorded.

use std::sync::Arc;

use rpi_core::{
    AbortReason, CommandId, CommandOverrunPolicy, Continuity, MotionControls, Rule, RuleId,
};
use rpi_image::Image;

use super::event::Ticket;
use super::queue::{InputValue, Request};

/// A request to the core with all data needed to repeat it, as recordings store it.
#[derive(Clone, Debug)]
pub enum RequestRecord {
    /// Loads a command from an image, with its policies for discontinuities and overruns.
    Load(CommandId, Arc<Image>, Continuity, CommandOverrunPolicy),
    /// Starts a loaded command.
    Start(CommandId),
    /// Takes a command off the schedule.
    Unschedule(CommandId),
    /// Cancels a command: its input `cancel` becomes true.
    Cancel(CommandId),
    /// Ends a command immediately.
    Abort(CommandId, AbortReason),
    /// Removes a command that does not run and frees its memory.
    Unload(CommandId),
    /// Adds a rule.
    Schedule(RuleId, Rule),
    /// Removes a rule.
    Withdraw(RuleId),
    /// Sets parameters and values of commands before they start.
    Set(Vec<InputValue>),
    /// Subscribes to exported flows (by index), with a period in cycles.
    Subscribe(CommandId, Vec<u32>, u64),
    /// Inserts or removes the device at this index. The device itself is not recorded.
    Device(usize),
    /// Sets the override and the pause of all motions.
    SetControls(MotionControls),
    /// Stops all commands.
    EmergencyStop,
}

impl RequestRecord {
    pub(super) fn from_request<T>(request: &Request<T>) -> RequestRecord {
        match request {
            Request::Insert(id, command, _) => {
                let image = Arc::clone(command.instance().image());
                RequestRecord::Load(*id, image, command.continuity(), command.overrun_policy())
            }
            Request::Start(id) => RequestRecord::Start(*id),
            Request::Unschedule(id) => RequestRecord::Unschedule(*id),
            Request::Cancel(id) => RequestRecord::Cancel(*id),
            Request::Abort(id, why) => RequestRecord::Abort(*id, *why),
            Request::Unload(id) => RequestRecord::Unload(*id),
            Request::Schedule(id, rule) => RequestRecord::Schedule(*id, (**rule).clone()),
            Request::Withdraw(id) => RequestRecord::Withdraw(*id),
            Request::Set(settings) => RequestRecord::Set(settings.to_vec()),
            Request::Subscribe(s) => {
                RequestRecord::Subscribe(s.command, s.exports().collect(), s.every)
            }
            Request::Device(place, _) => RequestRecord::Device(*place),
            Request::SetControls(controls) => RequestRecord::SetControls(*controls),
            Request::EmergencyStop => RequestRecord::EmergencyStop,
        }
    }
}

/// Callback for each request before it is sent. The callback therefore knows a command before any event about it
/// arrives.
pub type RequestLog = Box<dyn FnMut(Ticket, RequestRecord) + Send>;
