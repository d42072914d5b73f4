//! Authentication of requests.

use std::net::IpAddr;
use std::sync::Arc;

use http::StatusCode;

use super::auth_throttle::RejectReason;
use super::http::Head;
use crate::client_token::ClientToken;
use crate::peer::Peer;
use crate::role::{Identity, Role};
use crate::web;

/// Policy that determines the identity of a client from the token in its request.
#[derive(Clone, Default)]
pub(crate) struct AuthPolicy {
    /// Accepted tokens. If the list is empty, every client is accepted, which is allowed on loopback only.
    pub(crate) tokens: Vec<ClientToken>,
    /// Origins whose pages may connect, besides that of the server itself.
    pub(crate) origins: Vec<String>,
}

/// Error answer to a request whose `Host` header names another host, at a server without tokens.
const OTHER_HOST: &str = "without a token this server answers only requests to an address or to `localhost`, not to other names (`Host`)";

/// Error answer to a request that a browser sends on behalf of a page from another origin.
const OTHER_ORIGIN: &str = "requests from pages of another origin are not allowed here";

impl AuthPolicy {
    /// Returns the identity of the client that sends a request. The token is in the header `Authorization: Bearer ...`
    /// (RFC 6750) or in the query `?token=...`.
    ///
    /// # Errors
    /// If a token is needed and the request has none or a wrong one.
    pub(crate) fn identify(&self, head: &Head, peer: Peer) -> Result<Identity, RejectReason> {
        if self.tokens.is_empty() {
            return Ok(Identity::unnamed(peer, Role::default()));
        }
        let in_header = head.header("authorization").and_then(bearer);
        let in_query = head
            .query
            .split('&')
            .find_map(|part| part.strip_prefix("token="));
        let shown = in_header.or(in_query).ok_or(RejectReason::NoToken)?;
        // All tokens are compared, so that the time does not show which one is similar.
        let matching = self.tokens.iter().fold(None, |found, token| {
            let is_equal = constant_time_eq(shown, &token.secret);
            found.or(is_equal.then_some(token))
        });
        let token = matching.ok_or(RejectReason::WrongToken)?;
        Ok(Identity {
            name: Some(Arc::clone(&token.name)),
            ..Identity::unnamed(peer, token.role)
        })
    }

    /// Returns an error response if a request is not for this server, or comes from a page of another origin.
    pub(crate) fn check_page(&self, head: &Head) -> Result<(), web::Response> {
        if !self.is_own_host(head) {
            return Err(web::Response::error(
                StatusCode::MISDIRECTED_REQUEST,
                OTHER_HOST,
            ));
        }
        match self.is_same_origin(head) {
            true => Ok(()),
            false => Err(web::Response::error(StatusCode::FORBIDDEN, OTHER_ORIGIN)),
        }
    }

    /// Returns whether the host of a request names this server. If the server has no tokens, the host must be an address
    /// or `localhost`: a page of another site whose name resolves to this machine sends no `Origin` with a simple request.
    /// A request of HTTP/1.0 without a host is accepted, as no browser sends one.
    pub(crate) fn is_own_host(&self, head: &Head) -> bool {
        let is_own = |host: &str| !self.tokens.is_empty() || is_address_or_localhost(host);
        head.host.as_deref().is_none_or(is_own)
    }

    /// Returns false for a request that a browser sends on behalf of a page from another origin: such pages must not
    /// move robots. If the server has no tokens, its own origin must be an address or `localhost`, because the owner of
    /// any other name can let it resolve to this machine (DNS rebinding).
    pub(crate) fn is_same_origin(&self, head: &Head) -> bool {
        let Some(origin) = head.header("origin") else {
            return true;
        };
        if self.origins.iter().any(|allowed| allowed == origin) {
            return true;
        }
        let host = origin.split_once("://").map(|(_, host)| host);
        host.is_some_and(|host| {
            let own = head.host.as_deref() == Some(host);
            own && (!self.tokens.is_empty() || is_address_or_localhost(host))
        })
    }
}

/// Returns the token in the value of a header `Authorization: Bearer ...`; `None` if the value has another form. The
/// name of the scheme may have any case (RFC 9110, section 11.1).
fn bearer(value: &str) -> Option<&str> {
    let (scheme, token) = value.split_once(' ')?;
    scheme
        .eq_ignore_ascii_case("bearer")
        .then(|| token.trim_start())
}

/// Returns whether a host, with or without port, is an IP address or `localhost`.
fn is_address_or_localhost(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
        _ => host,
    };
    let inner = name.strip_prefix('[').and_then(|n| n.strip_suffix(']'));
    name.eq_ignore_ascii_case("localhost") || inner.unwrap_or(name).parse::<IpAddr>().is_ok()
}

/// Returns whether two tokens are equal. The time depends on the length of `shown`, the client's token, only, so that
/// it reveals neither the server's token nor its length.
fn constant_time_eq(shown: &str, token: &str) -> bool {
    let pairs = shown.bytes().zip(token.bytes().cycle());
    // `black_box` keeps the compiler from leaving the loop at the first difference.
    let differing = pairs.fold(0, |all, (x, y)| std::hint::black_box(all | (x ^ y)));
    (shown.len() == token.len()) & (differing == 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn head(target: &str, header: &str) -> Head {
        head_at("cell:8080", target, header)
    }

    fn head_at(host: &str, target: &str, header: &str) -> Head {
        let text = format!("GET {target} HTTP/1.1\r\nHost: {host}\r\n{header}\r\n\r\n");
        Head::read(&mut text.as_bytes(), Duration::from_secs(1)).unwrap()
    }

    fn secret() -> AuthPolicy {
        AuthPolicy {
            tokens: vec![ClientToken::new("anna", Role::Operator, "secret")],
            origins: Vec::new(),
        }
    }

    #[test]
    fn a_token_tells_name_and_role() {
        let mut policy = secret();
        let panel = ClientToken::new("panel", Role::Viewer, "glass");
        policy.tokens.push(panel);
        for (token, name, role) in [
            ("secret", "anna", Role::Operator),
            ("glass", "panel", Role::Viewer),
        ] {
            let request = head("/rpc", &format!("Authorization: Bearer {token}"));
            let client = policy.identify(&request, Peer::Local).unwrap();
            assert_eq!((client.name.as_deref(), client.role), (Some(name), role));
        }
    }

    #[test]
    fn without_a_token_the_host_is_an_address_or_localhost() {
        let opens =
            |policy: &AuthPolicy, host: &str| policy.is_own_host(&head_at(host, "/", "X: y"));
        let anyone = AuthPolicy::default();
        for host in [
            "localhost:70",
            "127.0.0.1:8080",
            "[::1]:8080",
            "192.168.0.4",
        ] {
            assert!(opens(&anyone, host), "{host}");
        }
        for host in ["evil.example:8080", "cell", "", "localhost.evil.example"] {
            assert!(!opens(&anyone, host), "{host}");
            assert!(opens(&secret(), host), "{host}");
        }
    }

    #[test]
    fn only_the_token_opens() {
        let policy = secret();
        let knows = |head: &Head| policy.identify(head, Peer::Local).is_ok();
        assert!(knows(&head("/rpc", "Authorization: Bearer secret")));
        assert!(knows(&head("/rpc", "Authorization: bearer secret")));
        assert!(knows(&head("/rpc", "authorization: BEARER  secret")));
        assert!(knows(&head("/rpc?token=secret", "X: y")));
        for wrong in [
            "Bearer secrets",
            "Bearer secre",
            "Bearer Secret",
            "Basic secret",
            "Bearer ",
        ] {
            assert!(
                !knows(&head("/rpc", &format!("Authorization: {wrong}"))),
                "{wrong}"
            );
        }
        assert!(!knows(&head("/rpc", "X: y")));
        let anyone = AuthPolicy::default().identify(&head("/", "X: y"), Peer::Local);
        assert_eq!(anyone.unwrap().role, Role::Programmer);
    }

    #[test]
    fn pages_from_elsewhere_are_turned_away() {
        let policy = secret();
        assert!(policy.is_same_origin(&head("/", "X: y")));
        assert!(policy.is_same_origin(&head("/", "Origin: http://cell:8080")));
        assert!(!policy.is_same_origin(&head("/", "Origin: http://evil.example")));
        assert!(!policy.is_same_origin(&head("/", "Origin: null")));
    }

    #[test]
    fn pages_of_allowed_origins_connect() {
        let policy = AuthPolicy {
            origins: vec!["https://app.example".to_owned()],
            ..AuthPolicy::default()
        };
        let connects = |origin: &str| {
            let origin = format!("Origin: {origin}");
            policy
                .check_page(&head_at("localhost:70", "/", &origin))
                .is_ok()
        };
        assert!(connects("https://app.example") && connects("http://localhost:70"));
        for other in [
            "http://app.example",
            "https://app.example.evil.example",
            "https://evil.example",
        ] {
            assert!(!connects(other), "{other}");
        }
    }

    #[test]
    fn without_a_token_a_name_that_means_this_machine_does_not_open() {
        let own = |host: &str| {
            let origin = format!("Origin: http://{host}");
            AuthPolicy::default().is_same_origin(&head_at(host, "/", &origin))
        };
        for host in [
            "localhost",
            "127.0.0.1:8080",
            "[::1]:8080",
            "[::1]",
            "127.0.0.1",
        ] {
            assert!(own(host), "{host}");
        }
        for host in [
            "evil.example:8080",
            "evil.example",
            "localhost.evil.example:8080",
            "",
        ] {
            assert!(!own(host), "{host}");
        }
    }
}
