//! What clients ask for by HTTP: one cycle of a net, devices, the end of a session.

use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use super::response::Response;
use super::xml::Xml;
use crate::desk::{Failure, NewDevice, Office, Reply};
use crate::peer::Peer;

type Form = BTreeMap<String, String>;

/// Runs a net for one cycle and tells what it exported.
pub(crate) fn eval(office: &Office, form: &Form, patience: Duration) -> Response {
    let Some(net) = form.get("dionet") else {
        return Response::refused(400, "a form with dionet=... is needed");
    };
    let (sender, answer) = channel();
    let failed = sender.clone();
    office.desk().eval(
        net,
        Box::new(move |values| drop(sender.send(Ok(values)))),
        Box::new(move |result| drop(result.map_err(|why| failed.send(Err(why))))),
    );
    match answer.recv_timeout(patience) {
        Ok(Ok(values)) => {
            let mut xml = Xml::new("eval");
            for (key, value) in &values {
                xml.leaf("data", &[("key", &format!("out{key}"))], value);
            }
            Response::xml(xml.finish())
        }
        Ok(Err(why)) => Response::refused(400, &why.to_string()),
        Err(_) => Response::refused(503, "it took too long"),
    }
}

/// Makes or removes a device.
pub(crate) fn device((office, peer): (&Office, Peer), form: &Form, patience: Duration) -> Response {
    let name = form.get("name").map_or("", String::as_str);
    let (reply, answer) = waiting();
    if form.get("action").is_some_and(|action| action == "remove") {
        office.desk().remove_device(name, reply);
    } else {
        let new = NewDevice {
            peer,
            name,
            kind: form.get("type").map_or("", String::as_str),
            parameters: form,
        };
        office.desk().add_device(&new, reply);
    }
    match answer.recv_timeout(patience) {
        Ok(Ok(_)) => Response::text("done\n".to_owned()),
        Ok(Err(why)) => Response::refused(400, &why.to_string()),
        Err(_) => Response::refused(503, "it took too long"),
    }
}

/// Ends a session.
pub(crate) fn session((office, peer): (&Office, Peer), name: &str, form: &Form) -> Response {
    if form
        .get("action")
        .is_none_or(|action| action != "TERMINATE")
    {
        return Response::refused(400, "a form with action=TERMINATE is needed");
    }
    let mut desk = office.desk();
    // Whoever asks by HTTP is a client who owns nothing.
    let nobody = desk.client(peer);
    let ended = desk
        .may_act(nobody, name)
        .and_then(|()| desk.abort_session(name));
    match ended {
        Ok(()) => Response::text("done\n".to_owned()),
        Err(why @ Failure::NotYours(_)) => Response::refused(403, &why.to_string()),
        Err(why) => Response::refused(404, &why.to_string()),
    }
}

/// A reply, and where it arrives.
fn waiting() -> (Reply, Receiver<Result<String, Failure>>) {
    let (sender, answer) = channel();
    (Box::new(move |result| drop(sender.send(result))), answer)
}
