//! Progress of a request that looks through all programs of the project, for clients that ask for it.

use std::cell::Cell;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use lsp_server::Notification;
use lsp_types::notification::{Notification as _, Progress as ProgressNotification};
use lsp_types::{
    ProgressParams, ProgressParamsValue, ProgressToken, WorkDoneProgress, WorkDoneProgressBegin,
    WorkDoneProgressEnd, WorkDoneProgressReport,
};
use serde_json::Value;

use crate::framing::to_json;

/// Time after which a request shows its progress, and time between two reports. Most requests are over sooner.
const INTERVAL: Duration = Duration::from_millis(100);

/// Progress of the request that is being handled.
pub(crate) struct Progress {
    outbox: Sender<Value>,
    /// Token by which the client knows the progress, and the title; `None` if the client does not ask for it.
    shown_as: Option<(ProgressToken, &'static str)>,
    /// Time of the last report, or of the start of the request.
    last: Cell<Instant>,
    has_begun: Cell<bool>,
}

impl Progress {
    pub(crate) fn new(outbox: Sender<Value>) -> Progress {
        Progress {
            outbox,
            shown_as: None,
            last: Cell::new(Instant::now()),
            has_begun: Cell::new(false),
        }
    }

    /// Begins the progress of a request, from its method and parameters. Nothing is sent yet.
    pub(crate) fn start(&mut self, method: &str, params: &Value) {
        let token = serde_json::from_value(params["workDoneToken"].clone()).ok();
        self.shown_as = token.zip(title(method));
        self.last.set(Instant::now());
        self.has_begun.set(false);
    }

    /// Reports that `done` of `all` programs have been looked through.
    pub(crate) fn report(&self, done: usize, all: usize) {
        let Some((_, title)) = self.shown_as else {
            return;
        };
        if self.last.get().elapsed() < INTERVAL {
            return;
        }
        self.last.set(Instant::now());
        let message = Some(format!("{done} of {all} programs"));
        let percentage = Some((100 * done / all.max(1)) as u32);
        self.send(match self.has_begun.replace(true) {
            false => WorkDoneProgress::Begin(WorkDoneProgressBegin {
                title: title.to_owned(),
                cancellable: Some(true),
                message,
                percentage,
            }),
            true => WorkDoneProgress::Report(WorkDoneProgressReport {
                cancellable: Some(true),
                message,
                percentage,
            }),
        });
    }

    /// Ends the progress of a request, before its response.
    pub(crate) fn end(&mut self) {
        if self.has_begun.replace(false) {
            self.send(WorkDoneProgress::End(WorkDoneProgressEnd { message: None }));
        }
        self.shown_as = None;
    }

    fn send(&self, value: WorkDoneProgress) {
        let Some((token, _)) = &self.shown_as else {
            return;
        };
        let value = ProgressParamsValue::WorkDone(value);
        let token = token.clone();
        let params = ProgressParams { token, value };
        let method = ProgressNotification::METHOD.to_owned();
        // Sending fails only if the writer has stopped; the inbox then reports the disconnected client.
        let _ = self.outbox.send(to_json(Notification::new(method, params)));
    }
}

/// Returns what a method does, if it looks through all programs.
fn title(method: &str) -> Option<&'static str> {
    match method {
        "workspace/diagnostic" => Some("Checking programs"),
        "workspace/symbol" => Some("Looking for names"),
        "textDocument/references" | "callHierarchy/incomingCalls" => Some("Looking for references"),
        "textDocument/rename" => Some("Renaming"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::sync::mpsc::{Receiver, channel};

    fn started(method: &str, params: &Value) -> (Progress, Receiver<Value>) {
        let (outbox, sent) = channel();
        let mut progress = Progress::new(outbox);
        progress.start(method, params);
        let past = Instant::now().checked_sub(2 * INTERVAL);
        progress
            .last
            .set(past.expect("the clock is not at its start"));
        (progress, sent)
    }

    #[test]
    fn a_long_request_begins_reports_and_ends() {
        let (mut progress, sent) = started("textDocument/rename", &json!({ "workDoneToken": "t" }));
        progress.report(1, 4);
        // Too soon for another report.
        progress.report(2, 4);
        progress.end();
        let sent: Vec<Value> = sent.try_iter().map(|m| m["params"].clone()).collect();
        let kinds: Vec<&Value> = sent.iter().map(|params| &params["value"]["kind"]).collect();
        assert_eq!(kinds, ["begin", "end"]);
        assert_eq!(sent[0]["token"], "t");
        assert_eq!(sent[0]["value"]["percentage"], 25);
        assert_eq!(sent[0]["value"]["title"], "Renaming");
    }

    #[test]
    fn without_a_token_or_for_short_requests_nothing_is_sent() {
        let (mut progress, sent) = started("textDocument/rename", &json!({}));
        progress.report(1, 2);
        progress.end();
        let (mut other, sent_other) = started("textDocument/hover", &json!({ "workDoneToken": 1 }));
        other.report(1, 2);
        other.end();
        assert_eq!(sent.try_iter().count() + sent_other.try_iter().count(), 0);
    }
}
