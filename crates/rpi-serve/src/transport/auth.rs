//! Authentication of requests.

use std::net::IpAddr;

use super::auth_throttle::RejectReason;
use super::http_head::Head;

/// Policy that decides from the token in a request whether the client is accepted.
#[derive(Clone, Default)]
pub(crate) struct AuthPolicy {
    /// Expected token. `None` accepts every client; allowed on loopback only.
    pub(crate) token: Option<String>,
}

impl AuthPolicy {
    /// Returns the reason for which a request is rejected; `None` if it is accepted. The token is in the header
    /// `Authorization: Bearer ...` (RFC 6750) or in the query `?token=...`.
    pub(crate) fn check_token(&self, head: &Head) -> Option<RejectReason> {
        let token = self.token.as_ref()?;
        let in_header = head.header("authorization");
        let in_header = in_header.and_then(|value| value.strip_prefix("Bearer "));
        let in_query = head
            .query
            .split('&')
            .find_map(|part| part.strip_prefix("token="));
        match in_header.or(in_query) {
            None => Some(RejectReason::NoToken),
            Some(shown) if !constant_time_eq(shown, token) => Some(RejectReason::WrongToken),
            Some(_) => None,
        }
    }

    /// Returns false for a request that a browser sends on behalf of a page from another origin: such pages must not
    /// move robots. Without a token, the own origin must be an address or `localhost`, because the owner of any other
    /// name can let it resolve to this machine (DNS rebinding).
    pub(crate) fn is_same_origin(&self, head: &Head) -> bool {
        let Some(origin) = head.header("origin") else {
            return true;
        };
        let host = origin.split_once("://").map(|(_, host)| host);
        host.is_some_and(|host| {
            let own = head.header("host") == Some(host);
            own && (self.token.is_some() || is_address_or_localhost(host))
        })
    }
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

/// Compares in a time that depends on the length of `shown` only, so that the time reveals neither the token nor its
/// length.
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

    #[test]
    fn only_the_token_opens() {
        let policy = AuthPolicy {
            token: Some("secret".into()),
        };
        let knows = |head: &Head| policy.check_token(head).is_none();
        assert!(knows(&head("/rpc", "Authorization: Bearer secret")));
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
        assert!(
            AuthPolicy::default()
                .check_token(&head("/", "X: y"))
                .is_none()
        );
    }

    #[test]
    fn pages_from_elsewhere_are_turned_away() {
        let policy = AuthPolicy {
            token: Some("secret".into()),
        };
        assert!(policy.is_same_origin(&head("/", "X: y")));
        assert!(policy.is_same_origin(&head("/", "Origin: http://cell:8080")));
        assert!(!policy.is_same_origin(&head("/", "Origin: http://evil.example")));
        assert!(!policy.is_same_origin(&head("/", "Origin: null")));
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
