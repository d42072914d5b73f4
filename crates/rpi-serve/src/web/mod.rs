//! HTTP requests: evaluation of nets, devices, and pages about the state of the server.

mod form;
mod metrics;
mod net_xml;
mod openmetrics;
mod pages;
mod post;
mod response;
mod xml;

use http::{Method, StatusCode};

use crate::limits::Limits;
use crate::message_size::{Turn, wait_for_answer_turn};
use crate::role::{Identity, Right};
use crate::state::SharedState;
use crate::transport::{ConnectionCounts, Head};

use form::Form;
pub(crate) use net_xml::page as structure_page;
pub(crate) use response::Response;

/// Answers an HTTP request of the client `who`: evaluates a net, adds or removes a device, ends a session, or returns a
/// page about the server.
pub(crate) fn respond(
    (shared, who): (&SharedState, &Identity),
    (limits, connections): (&Limits, &ConnectionCounts),
    head: &Head,
    body: &[u8],
) -> Response {
    let parts: Vec<&str> = head.path.split('/').filter(|p| !p.is_empty()).collect();
    if let Err(why) = who.ensure(needed_right(&head.method, &parts), &head.path) {
        return Response::error(StatusCode::FORBIDDEN, &why.to_string());
    }
    match &head.method {
        &Method::POST => {
            let Some(form) = parse_form(body) else {
                let why = "expected a form in UTF-8 with at most 64 fields";
                return Response::error(StatusCode::BAD_REQUEST, why);
            };
            change((shared, who), limits, &parts, &form)
        }
        &Method::GET | &Method::HEAD if parts == ["metrics"] => {
            Response::with_type(metrics::MEDIA_TYPE, metrics::page(shared, connections))
        }
        &Method::GET | &Method::HEAD => pages::page(shared, &parts),
        _ => not_allowed(),
    }
}

/// Waits until no other large page is made, if this path is a page with the text or the values of a large command. The
/// structure of a net has a limit of its own.
pub(crate) fn wait_for_page_turn(shared: &SharedState, path: &str) -> Option<Turn> {
    let path = path.strip_prefix("/nets/")?;
    let (name, "dio" | "debug") = path.split_once('/')? else {
        return None;
    };
    let bytes = shared.lock().objects.commands.find(name).ok()?.1.bytes();
    wait_for_answer_turn(bytes)
}

/// Parses the form in the body of a request; `None` if the body is not UTF-8 or has too many fields.
pub(crate) fn parse_form(body: &[u8]) -> Option<Form> {
    std::str::from_utf8(body).ok().and_then(form::parse)
}

/// Carries out a POST request for the page whose path has these segments.
fn change(
    (shared, who): (&SharedState, &Identity),
    limits: &Limits,
    parts: &[&str],
    form: &Form,
) -> Response {
    match parts {
        ["eval"] => post::eval(shared, form, limits.request_timeout),
        ["devices"] => post::device((shared, who.peer), form, limits.request_timeout),
        ["sessions", name] => post::session((shared, who), name, form),
        _ => not_allowed(),
    }
}

fn not_allowed() -> Response {
    let why = "this method is not allowed here";
    Response::error(StatusCode::METHOD_NOT_ALLOWED, why)
}

/// Returns the right that an HTTP request needs. `parts` are the segments of its path.
fn needed_right(method: &Method, parts: &[&str]) -> Right {
    match (method, parts) {
        (&Method::POST, ["sessions", _]) => Right::Move,
        (&Method::POST, _) => Right::Load,
        _ => Right::Watch,
    }
}
