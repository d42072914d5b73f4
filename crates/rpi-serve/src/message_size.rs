//! Size of a message in memory, known before any of its values is made, and the turns of large messages and answers.

use std::cell::Cell;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Number of values from which on a message is large: then its values need at most about 200 kB.
const LARGE_VALUES: usize = 1 << 10;
/// Length in bytes from which on a message is large.
const LARGE_BYTES: usize = 1 << 16;

/// Lock that a thread holds while it handles a large message, or makes a large answer.
static LARGE_MESSAGE: Mutex<()> = Mutex::new(());

thread_local! {
    /// Whether this thread holds [`LARGE_MESSAGE`].
    static HAS_TURN: Cell<bool> = const { Cell::new(false) };
}

/// Turn of a thread to handle a large message or to make a large answer, until it is dropped.
pub(crate) struct Turn {
    _lock: MutexGuard<'static, ()>,
}

impl Turn {
    /// Waits until no other thread has a turn. Returns `None` if this thread has one already: the answer to a large
    /// message may be large, too.
    ///
    /// The caller must not hold the lock of the state, which a thread with a turn waits for.
    fn wait() -> Option<Turn> {
        if HAS_TURN.get() {
            return None;
        }
        let lock = LARGE_MESSAGE.lock();
        HAS_TURN.set(true);
        Some(Turn {
            _lock: lock.unwrap_or_else(PoisonError::into_inner),
        })
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        HAS_TURN.set(false);
    }
}

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
pub(crate) fn wait_for_turn(text: &str, values: usize) -> Option<Turn> {
    let is_large = text.len() > LARGE_BYTES || values > LARGE_VALUES;
    if is_large { Turn::wait() } else { None }
}

/// Waits until no other large answer is being made, if this is an answer about an object of this many bytes of memory.
/// The values of an answer take more memory than the object.
pub(crate) fn wait_for_answer_turn(bytes: usize) -> Option<Turn> {
    if bytes > LARGE_BYTES {
        Turn::wait()
    } else {
        None
    }
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

    use super::{max_values, wait_for_answer_turn, wait_for_turn};

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

    #[test]
    fn a_large_answer_to_a_large_message_has_the_same_turn() {
        let message = wait_for_turn("", usize::MAX);
        assert!(message.is_some());
        assert!(wait_for_answer_turn(usize::MAX).is_none());
        drop(message);
        assert!(wait_for_answer_turn(usize::MAX).is_some());
        assert!(wait_for_answer_turn(1).is_none());
    }
}
