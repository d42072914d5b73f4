//! Requests for safe values of outputs.

use super::control_handle::Control;
use super::event::{RequestError, Ticket};
use super::queue::Request;

impl<T> Control<T> {
    /// Sets resources (actuators) to their safe values, except those that a command holds: the program whose commands have set them
    /// will not go on.
    ///
    /// # Errors
    /// Returns an error if there are too many pending requests.
    pub fn make_safe(&mut self, resources: impl Into<Box<[u32]>>) -> Result<Ticket, RequestError> {
        self.send_request(Request::MakeSafe(resources.into()))
    }
}
