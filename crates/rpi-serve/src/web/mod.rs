//! HTTP requests: evaluation of nets, devices, and pages about the state of the server.

mod form;
mod metrics;
mod net_xml;
mod openmetrics;
mod pages;
mod post;
mod response;
mod xml;

use crate::limits::Limits;
use crate::role::{Identity, Right};
use crate::state::SharedState;
use crate::transport::{ConnectionCounts, Head};

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
    let body = String::from_utf8_lossy(body);
    let parts: Vec<&str> = head.path.split('/').filter(|p| !p.is_empty()).collect();
    if let Err(why) = who.ensure(needed_right(&head.method, &parts), &head.path) {
        return Response::error(403, &why.to_string());
    }
    let peer = who.peer;
    match (head.method.as_str(), parts.as_slice()) {
        ("POST", ["eval"]) => post::eval(shared, &form::parse(&body), limits.request_timeout),
        ("POST", ["devices"]) => {
            post::device((shared, peer), &form::parse(&body), limits.request_timeout)
        }
        ("POST", ["sessions", name]) => post::session((shared, who), name, &form::parse(&body)),
        ("GET", ["metrics"]) => {
            Response::with_type(metrics::MEDIA_TYPE, metrics::page(shared, connections))
        }
        ("GET", parts) => pages::page(shared, parts),
        _ => Response::error(405, "this method is not allowed here"),
    }
}

/// Returns the right that an HTTP request needs. `parts` are the segments of its path.
fn needed_right(method: &str, parts: &[&str]) -> Right {
    match (method, parts) {
        ("POST", ["sessions", _]) => Right::Move,
        ("POST", _) => Right::Load,
        _ => Right::Watch,
    }
}
