//! Conversion between `file:` URIs (RFC 8089) and paths.

use std::path::{Path, PathBuf};

use lsp_types::Uri;

/// Returns the path of a `file:` URI. The text of any other URI, such as that of an unsaved document, is used as the
/// path.
pub(crate) fn to_path(uri: &Uri) -> PathBuf {
    let text = uri.as_str();
    match text.strip_prefix("file://").and_then(local_path) {
        Some(path) => PathBuf::from(path),
        None => PathBuf::from(text),
    }
}

/// Returns the decoded path in a URI. `rest` is the URI without `file://`; a host before the path is ignored. A Windows
/// path has no leading slash. Returns `None` if the path is not valid.
fn local_path(rest: &str) -> Option<String> {
    // A host, as in `file://localhost/a`, is ignored.
    let path = percent_decode(&rest[rest.find('/')?..])?;
    let after_slash = path.trim_start_matches('/');
    let has_drive = after_slash.as_bytes().get(1) == Some(&b':');
    Some(if has_drive {
        after_slash.to_owned()
    } else {
        path
    })
}

/// Returns a text with its percent-encoded bytes decoded; [`None`] if the result is not UTF-8.
fn percent_decode(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        let code = |hex: &[u8]| u8::from_str_radix(std::str::from_utf8(hex).ok()?, 16).ok();
        let byte = match (first, after) {
            (b'%', [a, b, ..]) => code(&[*a, *b]),
            _ => None,
        };
        bytes.push(byte.unwrap_or(*first));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    String::from_utf8(bytes).ok()
}

/// Returns the `file:` URI of an absolute path; [`None`] for a relative path or one that is not UTF-8.
pub(crate) fn from_path(path: &Path) -> Option<Uri> {
    let text = path.to_str()?.replace('\\', "/");
    let has_drive = text.as_bytes().get(1) == Some(&b':');
    let start = if has_drive { "file:///" } else { "file://" };
    let is_absolute = has_drive || text.starts_with('/');
    is_absolute.then(|| format!("{start}{}", percent_encode(&text)).parse().ok())?
}

/// Returns a path with all characters percent-encoded except `/` and the unreserved characters of RFC 3986.
fn percent_encode(path: &str) -> String {
    let mut out = String::with_capacity(path.len());
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'.' | b'_' | b'~' => {
                out.push(char::from(byte));
            }
            _ => out.push_str(&format!("%{byte:02X}")),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str) -> PathBuf {
        to_path(&text.parse().unwrap())
    }

    #[test]
    fn paths_and_addresses_lead_to_each_other() {
        for name in ["/cells/a.rpi", "/two words/\u{e4}%25.rpi", "/a+b/c#d?.rpi"] {
            let uri = from_path(Path::new(name)).unwrap();
            assert_eq!(to_path(&uri), Path::new(name), "{}", uri.as_str());
        }
        assert_eq!(from_path(Path::new("a.rpi")), None);
    }

    #[test]
    fn drives_hosts_and_texts_in_no_file_are_understood() {
        assert_eq!(
            path("file:///c%3A/cells/a.rpi"),
            Path::new("c:/cells/a.rpi")
        );
        assert_eq!(path("file://host/cells/a.rpi"), Path::new("/cells/a.rpi"));
        assert_eq!(
            path("untitled:Untitled-1"),
            Path::new("untitled:Untitled-1")
        );
        let drive = from_path(Path::new("c:/cells/a.rpi")).unwrap();
        assert_eq!(drive.as_str(), "file:///c%3A/cells/a.rpi");
    }
}
