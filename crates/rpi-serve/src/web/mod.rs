//! HTTP requests: evaluation of nets, devices, and pages about the state of the server.

mod eval;
mod form;
mod net;
mod pages;
mod response;
mod xml;

use crate::limits::Limits;
use crate::peer::Peer;
use crate::state::Office;
use crate::wire::Head;

pub(crate) use response::Response;

/// Answers an HTTP request.
pub(crate) fn respond(
    (office, peer): (&Office, Peer),
    limits: &Limits,
    head: &Head,
    body: &[u8],
) -> Response {
    let body = String::from_utf8_lossy(body);
    let parts: Vec<&str> = head.path.split('/').filter(|p| !p.is_empty()).collect();
    match (head.method.as_str(), parts.as_slice()) {
        ("POST", ["eval"]) => eval::eval(office, &form::parse(&body), limits.patience),
        ("POST", ["devices"]) => eval::device((office, peer), &form::parse(&body), limits.patience),
        ("POST", ["sessions", name]) => eval::session((office, peer), name, &form::parse(&body)),
        ("GET", parts) => pages::page(office, parts),
        _ => Response::refused(405, "this method is not allowed here"),
    }
}
