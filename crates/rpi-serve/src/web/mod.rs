//! HTTP requests: evaluation of nets, devices, and pages about the state of the server.

mod form;
mod net_xml;
mod pages;
mod post;
mod response;
mod xml;

use crate::limits::Limits;
use crate::peer::Peer;
use crate::state::SharedState;
use crate::transport::Head;

pub(crate) use response::Response;

/// Answers an HTTP request.
pub(crate) fn respond(
    (shared, peer): (&SharedState, Peer),
    limits: &Limits,
    head: &Head,
    body: &[u8],
) -> Response {
    let body = String::from_utf8_lossy(body);
    let parts: Vec<&str> = head.path.split('/').filter(|p| !p.is_empty()).collect();
    match (head.method.as_str(), parts.as_slice()) {
        ("POST", ["eval"]) => post::eval(shared, &form::parse(&body), limits.request_timeout),
        ("POST", ["devices"]) => {
            post::device((shared, peer), &form::parse(&body), limits.request_timeout)
        }
        ("POST", ["sessions", name]) => post::session((shared, peer), name, &form::parse(&body)),
        ("GET", parts) => pages::page(shared, parts),
        _ => Response::error(405, "this method is not allowed here"),
    }
}
