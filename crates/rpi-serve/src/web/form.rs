//! Form data in the body of a request: `key=value&key=value`.

use std::collections::BTreeMap;

/// Fields of a form by name.
pub(crate) type Form = BTreeMap<String, String>;

/// Maximum number of fields of a form.
const MAX_FIELDS: usize = 64;

/// Parses form data to a map from keys to values, both percent-encoded (WHATWG URL, section 5). Clients of the
/// reference system (the control core of the Robotics API) send some forms unencoded; a body with a space is read as
/// such a form, because an encoded form has no spaces. Returns `None` for a form with too many fields.
pub(super) fn parse(body: &str) -> Option<Form> {
    if body.bytes().filter(|byte| *byte == b'&').count() >= MAX_FIELDS {
        return None;
    }
    if !body.contains(' ') {
        return Some(
            form_urlencoded::parse(body.as_bytes())
                .into_owned()
                .collect(),
        );
    }
    let pairs = body.split('&').filter_map(|pair| pair.split_once('='));
    let owned = pairs.map(|(key, value)| (key.to_owned(), value.to_owned()));
    Some(owned.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_are_decoded_unless_they_are_plain() {
        let form = parse("dionet=%7Ba%3DCancel%28%29%7D&x=a+b%2").unwrap();
        assert_eq!(form["dionet"], "{a=Cancel()}");
        assert_eq!(form["x"], "a b%2");
        let form = parse("name=arm one&max=+inf&tcp={x:1%20}").unwrap();
        assert_eq!(
            (form["name"].as_str(), form["max"].as_str()),
            ("arm one", "+inf")
        );
        assert_eq!(form["tcp"], "{x:1%20}");
        assert!(parse("").unwrap().is_empty());
    }

    #[test]
    fn a_form_has_a_maximum_number_of_fields() {
        assert_eq!(parse(&"a=b&".repeat(63)).unwrap().len(), 1);
        assert_eq!(parse(&"a=b&".repeat(64)), None);
    }
}
