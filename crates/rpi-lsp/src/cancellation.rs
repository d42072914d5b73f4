//! Cancellation of requests: the notification `$/cancelRequest`.
//!
//! The thread that reads messages records cancelled requests at once, whereas the worker thread handles messages in
//! order. The worker thus learns of a cancellation before and while it handles the request.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use lsp_server::{Message, RequestId};

/// Name of the notification.
const METHOD: &str = "$/cancelRequest";

/// Maximum number of cancelled requests that are recorded. The client may cancel requests that have been answered; the
/// oldest ones are then forgotten.
const MAX_RECORDED: usize = 256;

/// Identifiers of cancelled requests, shared by the thread that reads messages and the worker thread.
#[derive(Clone, Default, Debug)]
pub(crate) struct Cancellations(Arc<Mutex<VecDeque<RequestId>>>);

impl Cancellations {
    /// Records the cancelled request if the message is a cancellation.
    pub(crate) fn record(&self, message: &Message) {
        let Message::Notification(notification) = message else {
            return;
        };
        if notification.method != METHOD {
            return;
        }
        let id = notification.params.get("id").cloned().unwrap_or_default();
        if let Ok(id) = serde_json::from_value::<RequestId>(id) {
            let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            all.push_back(id);
            if all.len() > MAX_RECORDED {
                all.pop_front();
            }
        }
    }

    /// Returns whether the client has cancelled the request.
    pub(crate) fn contains(&self, id: &RequestId) -> bool {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.contains(id)
    }

    /// Removes the record of a request that has been answered.
    pub(crate) fn remove(&self, id: &RequestId) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.retain(|known| known != id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lsp_server::Notification;
    use serde_json::json;

    #[test]
    fn a_bounded_number_of_cancelled_requests_is_recorded() {
        let all = Cancellations::default();
        for id in 0..1000 {
            let message = Notification::new(METHOD.to_owned(), json!({ "id": id }));
            all.record(&message.into());
        }
        assert!(all.contains(&RequestId::from(999)) && !all.contains(&RequestId::from(0)));
        all.remove(&RequestId::from(999));
        assert!(!all.contains(&RequestId::from(999)));
        all.record(&Notification::new(METHOD.to_owned(), json!({ "id": "a" })).into());
        assert!(all.contains(&RequestId::from("a".to_owned())));
    }
}
