//! Meaning of the keys of `rpi teach`.

use super::arm_jog::Motion;

/// Keys and their meanings, as text for the user.
pub(super) const HELP: &str = "\
w s  tool along x      u o  turn about x     1-7  choose an axis    t  take a point
a d  tool along y      i k  turn about y     + -  turn the axis     n  take a point with a name
r f  tool along z      j l  turn about z     < >  slower, faster    z  remove the last point
?    these keys        q    end
";

/// Key that has a meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Key {
    /// Moves the arm, or changes how it moves.
    Move(Motion),
    /// Takes a point with a new name.
    Take,
    /// Takes a point whose name is typed.
    TakeNamed,
    /// Removes the point that was taken last.
    Remove,
    /// Prints the keys.
    Help,
    /// Ends the program.
    Quit,
}

/// Keys that move the tool: the key, the component of its velocity (x, y, z, and the rotations about them), and the sign.
const TOOL_KEYS: [(u8, usize, f64); 12] = [
    (b'w', 0, 1.0),
    (b's', 0, -1.0),
    (b'a', 1, 1.0),
    (b'd', 1, -1.0),
    (b'r', 2, 1.0),
    (b'f', 2, -1.0),
    (b'u', 3, 1.0),
    (b'o', 3, -1.0),
    (b'i', 4, 1.0),
    (b'k', 4, -1.0),
    (b'j', 5, 1.0),
    (b'l', 5, -1.0),
];

impl Key {
    /// Returns the meaning of a key; `None` if it has none. Upper case is the same as lower case.
    pub(super) fn from_byte(byte: u8) -> Option<Key> {
        let byte = byte.to_ascii_lowercase();
        let tool = TOOL_KEYS.iter().find(|(key, ..)| *key == byte);
        if let Some((_, component, sign)) = tool {
            return Some(Key::Move(Motion::Tool {
                component: *component,
                sign: *sign,
            }));
        }
        Some(match byte {
            b'1'..=b'7' => Key::Move(Motion::ChooseAxis(usize::from(byte - b'1'))),
            b'+' | b'=' => Key::Move(Motion::Axis { sign: 1.0 }),
            b'-' => Key::Move(Motion::Axis { sign: -1.0 }),
            b'>' | b'.' => Key::Move(Motion::Faster),
            b'<' | b',' => Key::Move(Motion::Slower),
            b't' => Key::Take,
            b'n' => Key::TakeNamed,
            b'z' => Key::Remove,
            b'?' | b'h' => Key::Help,
            b'q' | 4 => Key::Quit,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_have_one_meaning_each_and_the_help_names_them() {
        for (key, component, _) in TOOL_KEYS {
            let found = Key::from_byte(key);
            assert!(
                matches!(found, Some(Key::Move(Motion::Tool { component: c, .. })) if c == component)
            );
            assert!(
                HELP.contains(&format!("{} ", char::from(key))),
                "{}",
                char::from(key)
            );
        }
        assert_eq!(Key::from_byte(b'7'), Some(Key::Move(Motion::ChooseAxis(6))));
        assert_eq!(Key::from_byte(b'8'), None);
        assert_eq!(Key::from_byte(b'T'), Some(Key::Take));
    }
}
