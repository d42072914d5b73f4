//! Requests in the form in which they are recorded.

use std::sync::Arc;

use rpi_core::{
    AbortReason, CommandId, CommandOverrunPolicy, Continuity, MotionControls, Rule, RuleId,
};
use rpi_image::Image;

use super::event::Ticket;
use super::queue::{InputValue, Request};

/// Request to the core with all data needed to repeat it, except devices, as recordings store it.
#[derive(Clone, Debug)]
pub enum RequestRecord {
    /// Loads a command from an image, with its policies for discontinuities and overruns.
    Load(CommandId, Arc<Image>, Continuity, CommandOverrunPolicy),
    /// Starts a loaded command.
    Start(CommandId),
    /// Removes a command from all rules that would start it.
    Unschedule(CommandId),
    /// Cancels a command: its input `cancel` becomes true.
    Cancel(CommandId),
    /// Aborts a command for this reason.
    Abort(CommandId, AbortReason),
    /// Removes a command that does not run and frees its memory.
    Unload(CommandId),
    /// Adds a rule under this id.
    Schedule(RuleId, Rule),
    /// Removes the rule with this id.
    Withdraw(RuleId),
    /// Sets inputs of commands, all of them between the same two cycles.
    Set(Vec<InputValue>),
    /// Subscribes to exported flows of a command, given by their indices in the image, with a sampling period in
    /// cycles.
    Subscribe(CommandId, Vec<u32>, u64),
    /// Inserts or removes the device at this index of the device bank. The device itself is not recorded.
    Device(usize),
    /// Sets the speed override (a factor from 0 to 1) and the pause of all motions.
    SetControls(MotionControls),
    /// Sets these resources (actuators) to their safe values, except those that a command holds.
    MakeSafe(Vec<u32>),
    /// Aborts all commands, drops all rules and stops all devices.
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
            Request::MakeSafe(resources) => RequestRecord::MakeSafe(resources.to_vec()),
            Request::EmergencyStop => RequestRecord::EmergencyStop,
        }
    }
}

/// Callback that receives each request before it is sent to the core, and therefore before any event that the request
/// causes.
pub type RequestLog = Box<dyn FnMut(Ticket, RequestRecord) + Send>;
