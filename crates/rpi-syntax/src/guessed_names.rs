//! Heuristic set of the names that a text declares or defines, for text with syntax errors.

use std::cell::{Cell, OnceCell};
use std::collections::HashSet;

/// Number of names that are searched for in the text one by one. For more names, the set of all declared names is computed
/// once. Few names are searched for faster: most texts with an error need one or two.
const MAX_SEARCHES: u32 = 4;

/// Set of the names that a source text seems to declare. It is computed on first use, and only once, as a text may have
/// many errors.
pub(crate) struct GuessedNames<'t> {
    text: &'t str,
    names: OnceCell<HashSet<Box<str>>>,
    /// Number of questions about the text so far.
    use_count: Cell<u32>,
}

impl<'t> GuessedNames<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        GuessedNames {
            text,
            names: OnceCell::new(),
            use_count: Cell::new(0),
        }
    }

    /// Returns whether the text seems to declare the name, as `x: real`, `x, y: real` and `x = ...` do.
    pub(crate) fn declares(&self, name: &str) -> bool {
        self.use_count.set(self.use_count.get().saturating_add(1));
        if self.use_count.get() <= MAX_SEARCHES {
            return is_declared(self.text, name);
        }
        let names = self.names.get_or_init(|| declared_names(self.text));
        names.contains(name)
    }

    /// Returns whether the text contains the name anywhere, also as a part of a word.
    pub(crate) fn contains(&self, name: &str) -> bool {
        self.use_count.set(self.use_count.get().saturating_add(1));
        self.text.contains(name)
    }

    /// Returns whether a result of this set has been used, so that the parse depends on the whole text.
    pub(crate) fn is_used(&self) -> bool {
        self.use_count.get() > 0
    }
}

fn is_part_of_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_' || c == '\''
}

/// Returns whether the rest of a text after a word shows that the word is declared: `:`, `,` or `=` follows.
fn follows_declared(rest: &str) -> bool {
    rest.trim_start().starts_with([':', ',', '='])
}

/// Returns whether `name` is one of the [`declared_names`] of the text.
fn is_declared(text: &str, name: &str) -> bool {
    let is_word = !name.is_empty() && name.chars().all(is_part_of_word);
    let mut places = text.match_indices(name);
    is_word
        && places.any(|(at, _)| {
            let (before, rest) = (&text[..at], &text[at + name.len()..]);
            !before.ends_with(is_part_of_word)
                && !rest.starts_with(is_part_of_word)
                && follows_declared(rest)
        })
}

/// Returns the words in the text that are followed by `:`, `,` or `=`.
fn declared_names(text: &str) -> HashSet<Box<str>> {
    let words = text.split(|c| !is_part_of_word(c));
    let words = words.filter(|word| !word.is_empty());
    let is_declared = |word: &&str| {
        let end = word.as_ptr() as usize - text.as_ptr() as usize + word.len();
        follows_declared(&text[end..])
    };
    words.filter(is_declared).map(Box::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_sign_follows_is_declared() {
        let text = "node f(x , y' : real) returns (z) let w\n  = 3v + u; tel";
        let guessed = GuessedNames::new(text);
        let names = ["f", "x", "y'", "z", "w", "v", "3v", "u", "="];
        let wanted = [false, true, true, false, true, false, false, false, false];
        assert!(!guessed.is_used());
        assert_eq!(names.map(|name| guessed.declares(name)), wanted);
        assert_eq!(names.map(|name| is_declared(text, name)), wanted);
        assert!(guessed.is_used());
    }
}
