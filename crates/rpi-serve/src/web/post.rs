//! HTTP POST requests: evaluate a net for one cycle, add and remove devices, end a session.

use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use http::StatusCode;

use super::form::Form;
use super::response::Response;
use super::xml::XmlWriter;
use crate::peer::Peer;
use crate::role::Identity;
use crate::state::{ApiError, NewDevice, Reply, SharedState};

/// Runs the net in the form field `dionet` for a single cycle and returns its exports as an XML response. Waits at most
/// `timeout` for the cycle.
pub(crate) fn eval(shared: &SharedState, form: &Form, timeout: Duration) -> Response {
    let Some(net) = form.get("dionet") else {
        return Response::error(StatusCode::BAD_REQUEST, "expected a form with dionet=...");
    };
    let (sender, answer) = channel();
    let failed = sender.clone();
    shared.lock().eval(
        net,
        Box::new(move |values| drop(sender.send(Ok(values)))),
        Box::new(move |result| drop(result.map_err(|why| failed.send(Err(why))))),
    );
    match answer.recv_timeout(timeout) {
        Ok(Ok(values)) => {
            let mut xml = XmlWriter::new("eval");
            for (key, value) in &values {
                xml.leaf("data", &[("key", &format!("out{key}"))], value);
            }
            Response::xml(xml.finish())
        }
        Ok(Err(why)) => Response::error(StatusCode::BAD_REQUEST, &why.to_string()),
        Err(_) => Response::error(
            StatusCode::SERVICE_UNAVAILABLE,
            "timeout: no answer from the cycle",
        ),
    }
}

/// Adds a device, or removes one if the form field `action` is `remove`. Waits at most `timeout` for the cycle.
pub(crate) fn device(
    (shared, peer): (&SharedState, Peer),
    form: &Form,
    timeout: Duration,
) -> Response {
    let name = form.get("name").map_or("", String::as_str);
    let (reply, answer) = reply_channel();
    if form.get("action").is_some_and(|action| action == "remove") {
        shared.lock().remove_device(name, reply);
    } else {
        let new = NewDevice {
            peer,
            name,
            kind: form.get("type").map_or("", String::as_str),
            parameters: form,
        };
        shared.lock().add_device(&new, reply);
    }
    match answer.recv_timeout(timeout) {
        Ok(Ok(_)) => Response::text("done\n".to_owned()),
        Ok(Err(why)) => Response::error(StatusCode::BAD_REQUEST, &why.to_string()),
        Err(_) => Response::error(
            StatusCode::SERVICE_UNAVAILABLE,
            "timeout: no answer from the cycle",
        ),
    }
}

/// Closes the session with this name and aborts its commands, if the form field `action` is `TERMINATE`.
pub(crate) fn session(
    (shared, who): (&SharedState, &Identity),
    name: &str,
    form: &Form,
) -> Response {
    if form
        .get("action")
        .is_none_or(|action| action != "TERMINATE")
    {
        return Response::error(
            StatusCode::BAD_REQUEST,
            "expected a form with action=TERMINATE",
        );
    }
    let mut state = shared.lock();
    // An HTTP request counts as a client without sessions.
    let nobody = state.objects.client(who);
    let ended = state
        .objects
        .may_act(nobody, name)
        .and_then(|()| state.abort_session(name));
    match ended {
        Ok(()) => Response::text("done\n".to_owned()),
        Err(why @ ApiError::NotOwner(_)) => {
            Response::error(StatusCode::FORBIDDEN, &why.to_string())
        }
        Err(why) => Response::error(StatusCode::NOT_FOUND, &why.to_string()),
    }
}

/// Creates a reply callback and the channel that receives its result.
fn reply_channel() -> (Reply, Receiver<Result<String, ApiError>>) {
    let (sender, answer) = channel();
    (Box::new(move |result| drop(sender.send(result))), answer)
}
