//! Size of a message in memory, known before any of its values is made.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Number of values from which on a message is large: then its values need at most about 200 kB.
const LARGE_VALUES: usize = 1 << 10;
/// Length in bytes from which on a message is large.
const LARGE_BYTES: usize = 1 << 16;

/// Lock that a thread holds while it handles a large message.
static LARGE_MESSAGE: Mutex<()> = Mutex::new(());

/// Returns an upper bound of the number of values in a text of JSON or DirectIO, counting nested values. The function
/// reads the text once and allocates nothing; the text need not be valid.
pub(crate) fn max_values(text: &str) -> usize {
    let mut count = 1;
    let mut bytes = text.bytes();
    while let Some(byte) = bytes.next() {
        match byte {
            b',' | b':' | b'[' | b'{' | b'(' => count += 1,
            b'"' => skip_string(&mut bytes),
            _ => {}
        }
    }
    count
}

/// Waits until no other large message is being handled, if this message is large. Its values may take more than ten times
/// the memory of its text, and all clients may send large messages at the same time. Small messages, such as an emergency
/// stop, never wait.
pub(crate) fn wait_for_turn(text: &str, values: usize) -> Option<MutexGuard<'static, ()>> {
    let is_large = text.len() > LARGE_BYTES || values > LARGE_VALUES;
    is_large.then(|| {
        let turn = LARGE_MESSAGE.lock();
        turn.unwrap_or_else(PoisonError::into_inner)
    })
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
