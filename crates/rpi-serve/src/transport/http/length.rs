//! Length of the body of a request (RFC 9112, section 6).

use http::header::{CONTENT_LENGTH, EXPECT, TRANSFER_ENCODING};
use http::{HeaderMap, HeaderValue, StatusCode, Version};

use super::request_error::RequestError;

/// Length of the body of a request.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum BodyLength {
    /// The body has this number of bytes.
    Known(u64),
    /// The body consists of chunks, each with its own length.
    Chunked,
}

impl BodyLength {
    /// Returns the length of the body of a request with these headers.
    ///
    /// # Errors
    /// If the length is ambiguous or invalid, or the body has an encoding that the server does not know.
    pub(super) fn new(headers: &HeaderMap, version: Version) -> Result<BodyLength, RequestError> {
        let has_length = headers.contains_key(CONTENT_LENGTH);
        if !headers.contains_key(TRANSFER_ENCODING) {
            return known_length(headers).map(BodyLength::Known);
        }
        // The two ways in which a message is hidden within another one ("request smuggling").
        if has_length || version < Version::HTTP_11 {
            return Err(RequestError::malformed(
                "`Transfer-Encoding` needs HTTP/1.1 and excludes `Content-Length` (RFC 9112, section 6.1)",
            ));
        }
        let values = headers.get_all(TRANSFER_ENCODING).iter();
        let codings = values.flat_map(|value| value.as_bytes().split(|byte| *byte == b','));
        let codings: Vec<&[u8]> = codings.map(<[u8]>::trim_ascii).collect();
        let is_chunked = |coding: &&[u8]| coding.eq_ignore_ascii_case(b"chunked");
        match codings.split_last() {
            Some((last, [])) if is_chunked(last) => Ok(BodyLength::Chunked),
            Some((last, others)) if is_chunked(last) && !others.iter().any(is_chunked) => {
                let reason = "the only transfer coding of this server is `chunked`";
                Err(RequestError::Rejected(StatusCode::NOT_IMPLEMENTED, reason))
            }
            _ => Err(RequestError::malformed(
                "the last transfer coding of a request must be `chunked`, which must stand once (RFC 9112, section 6.3)",
            )),
        }
    }
}

/// Returns the content length; 0 if there is none.
fn known_length(headers: &HeaderMap) -> Result<u64, RequestError> {
    let mut values = headers.get_all(CONTENT_LENGTH).iter();
    match (values.next(), values.next()) {
        (None, _) => Ok(0),
        (Some(value), None) => decimal(value).ok_or_else(|| {
            RequestError::malformed("the value of `Content-Length` must be one decimal number")
        }),
        (Some(_), Some(_)) => Err(RequestError::malformed(
            "a request has one `Content-Length` (RFC 9112, section 6.3)",
        )),
    }
}

/// Returns a number of decimal digits; `None` for any other text and for a number beyond 64 bits.
fn decimal(value: &HeaderValue) -> Option<u64> {
    let text = value.to_str().ok()?;
    // `parse` alone accepts a sign.
    let is_number = text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().ok())?
}

/// Returns whether the client waits for the status 100 before it sends the body (RFC 9110, section 10.1.1).
///
/// # Errors
/// If the client has another expectation.
pub(super) fn expects_continue(
    headers: &HeaderMap,
    version: Version,
) -> Result<bool, RequestError> {
    let Some(expected) = headers.get(EXPECT).filter(|_| version >= Version::HTTP_11) else {
        return Ok(false);
    };
    match expected.as_bytes().eq_ignore_ascii_case(b"100-continue") {
        true => Ok(true),
        false => Err(RequestError::Rejected(
            StatusCode::EXPECTATION_FAILED,
            "the only known expectation is `100-continue`",
        )),
    }
}
