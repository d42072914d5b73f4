//! Messages that wait for a client.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::protocol::{StatusLevel, status};
use crate::transport::OutgoingMessage;

/// Maximum size in bytes of the data that waits for a client. Older data is lost first: a viewer shows the present.
const MAX_DATA: usize = 4 << 20;
/// Maximum size in bytes of the texts that wait for a client. They are never lost, so that a client which does not read them is
/// disconnected.
const MAX_TEXTS: usize = 8 << 20;
/// Minimum time between two reports to a client that it has lost data.
const REPORT_INTERVAL: Duration = Duration::from_secs(1);

/// Messages that wait for a client, and what it has lost.
#[derive(Debug, Default)]
pub(super) struct ClientQueue {
    texts: VecDeque<String>,
    texts_bytes: usize,
    data: VecDeque<Vec<u8>>,
    data_bytes: usize,
    /// Number of data messages that were lost, and how many of them the client knows of.
    lost: u64,
    reported: u64,
    reported_at: Option<Instant>,
    is_closed: bool,
}

impl ClientQueue {
    /// Adds a text, which is sent before data.
    pub(super) fn push_text(&mut self, text: String) {
        self.texts_bytes += text.len();
        self.texts.push_back(text);
        if self.texts_bytes > MAX_TEXTS {
            self.is_closed = true;
        }
    }

    /// Adds the data of a message. If there is no room, older data is lost.
    pub(super) fn push_data(&mut self, data: Vec<u8>) {
        if data.len() > MAX_DATA {
            self.lost += 1;
            return;
        }
        self.data_bytes += data.len();
        self.data.push_back(data);
        while self.data_bytes > MAX_DATA
            && let Some(old) = self.data.pop_front()
        {
            self.data_bytes -= old.len();
            self.lost += 1;
        }
    }

    /// Takes the next message.
    pub(super) fn pop(&mut self) -> Option<OutgoingMessage> {
        if let Some(text) = self.texts.pop_front() {
            self.texts_bytes -= text.len();
            return Some(OutgoingMessage::Text(text, None));
        }
        if let Some(report) = self.loss_report() {
            return Some(OutgoingMessage::Text(report, None));
        }
        let data = self.data.pop_front()?;
        self.data_bytes -= data.len();
        Some(OutgoingMessage::Binary(data))
    }

    /// Returns a report of the lost data, if there is new loss and the last report is old enough.
    fn loss_report(&mut self) -> Option<String> {
        let recent = self
            .reported_at
            .is_some_and(|at| at.elapsed() < REPORT_INTERVAL);
        if recent || self.lost == self.reported {
            return None;
        }
        let lost = rpi_diag::with_noun(self.lost - self.reported, "message");
        (self.reported, self.reported_at) = (self.lost, Some(Instant::now()));
        let text = format!("the client is too slow: {lost} lost");
        Some(status(StatusLevel::Warning, &text))
    }

    /// Returns whether the client must be disconnected.
    pub(super) fn is_closed(&self) -> bool {
        self.is_closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(message: Option<OutgoingMessage>) -> String {
        match message {
            Some(OutgoingMessage::Text(text, _)) => text,
            _ => panic!("no text"),
        }
    }

    #[test]
    fn a_slow_client_loses_the_oldest_data_and_is_told() {
        let mut queue = ClientQueue::default();
        for k in 0..6_u8 {
            queue.push_data(vec![k; 1 << 20]);
        }
        queue.push_data(vec![6; MAX_DATA + 1]);
        queue.push_text("first".to_owned());
        assert_eq!(text(queue.pop()), "first");
        let report = text(queue.pop());
        assert!(report.contains("3 messages lost"), "{report}");
        let rest: Vec<u8> = std::iter::from_fn(|| match queue.pop() {
            Some(OutgoingMessage::Binary(data)) => Some(data[0]),
            _ => None,
        })
        .collect();
        assert_eq!(rest, [2, 3, 4, 5]);
        assert_eq!((queue.data_bytes, queue.texts_bytes), (0, 0));
        assert!(!queue.is_closed());
    }

    #[test]
    fn a_client_that_reads_no_texts_is_disconnected() {
        let mut queue = ClientQueue::default();
        queue.push_text("x".repeat(MAX_TEXTS));
        assert!(!queue.is_closed());
        queue.push_text("x".to_owned());
        assert!(queue.is_closed());
    }
}
