//! Number of values in a JSON text, counted before any of them is made.

/// Returns an upper bound of the number of values in a JSON text, counting nested values. The function reads the text
/// once and allocates nothing; the text need not be valid JSON.
pub(super) fn max_values(text: &str) -> usize {
    let mut count = 1;
    let mut bytes = text.bytes();
    while let Some(byte) = bytes.next() {
        match byte {
            b',' | b':' | b'[' | b'{' => count += 1,
            b'"' => skip_string(&mut bytes),
            _ => {}
        }
    }
    count
}

/// Consumes the rest of a JSON string, including its closing quotation mark.
fn skip_string(bytes: &mut impl Iterator<Item = u8>) {
    while let Some(byte) = bytes.next() {
        match byte {
            b'"' => return,
            b'\\' => {
                bytes.next();
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::max_values;

    fn values(value: &Value) -> usize {
        match value {
            Value::Array(all) => 1 + all.iter().map(values).sum::<usize>(),
            Value::Object(all) => 1 + all.values().map(values).sum::<usize>(),
            _ => 1,
        }
    }

    #[test]
    fn no_text_has_more_values_than_counted() {
        for text in [
            "1",
            "[]",
            "[[[[]]]]",
            "[1,[2,3],{}]",
            r#"{"a":[1,2,{"b":"x,y:[{","c":"\"[,\\"}],"d":null}"#,
        ] {
            let made = values(&serde_json::from_str(text).unwrap());
            let counted = max_values(text);
            assert!(
                made <= counted && counted <= 3 * made,
                "{text}: {made} {counted}"
            );
        }
    }
}
