//! Form data in the body of a request: `key=value&key=value`.

use std::collections::BTreeMap;

/// Parses form data to a map from keys to values, both percent-encoded (WHATWG URL, section 5). Clients of the
/// reference system (the control core of the Robotics API) send some forms unencoded; a body with a space is read as
/// such a form, because an encoded form has no spaces.
pub(crate) fn parse(body: &str) -> BTreeMap<String, String> {
    let plain = body.contains(' ');
    let pairs = body.split('&').filter_map(|pair| pair.split_once('='));
    let decoded = |text: &str| match plain {
        true => text.to_owned(),
        false => decode(text),
    };
    pairs
        .map(|(key, value)| (decoded(key), decoded(value)))
        .collect()
}

fn decode(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let coded = tail.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        let coded = coded.and_then(|two| u8::from_str_radix(two, 16).ok());
        match (first, coded) {
            (b'%', Some(byte)) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            (b'+', _) => {
                bytes.push(b' ');
                rest = tail;
            }
            _ => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_are_decoded_unless_they_are_plain() {
        let form = parse("dionet=%7Ba%3DCancel%28%29%7D&x=a+b%2");
        assert_eq!(form["dionet"], "{a=Cancel()}");
        assert_eq!(form["x"], "a b%2");
        let form = parse("name=arm one&max=+inf&tcp={x:1%20}");
        assert_eq!(
            (form["name"].as_str(), form["max"].as_str()),
            ("arm one", "+inf")
        );
        assert_eq!(form["tcp"], "{x:1%20}");
        assert!(parse("nothing").is_empty());
    }
}
