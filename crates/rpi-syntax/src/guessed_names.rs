//! Heuristic set of the names that a text declares or defines, for text with syntax errors.

use std::cell::OnceCell;
use std::collections::HashSet;

/// Set of the names that a source text seems to declare. It is computed on first use, and only once, as a text may have
/// many errors.
pub(crate) struct GuessedNames<'t> {
    text: &'t str,
    names: OnceCell<HashSet<Box<str>>>,
}

impl<'t> GuessedNames<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        GuessedNames {
            text,
            names: OnceCell::new(),
        }
    }

    /// Returns whether the text seems to declare the name, as `x: real`, `x, y: real` and `x = ...` do.
    pub(crate) fn declares(&self, name: &str) -> bool {
        let names = self.names.get_or_init(|| declared_names(self.text));
        names.contains(name)
    }
}

/// Returns the words in the text that are followed by `:`, `,` or `=`.
fn declared_names(text: &str) -> HashSet<Box<str>> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '\'';
    let words = text.split(|c| !is_part(c)).filter(|word| !word.is_empty());
    let is_declared = |word: &&str| {
        let end = word.as_ptr() as usize - text.as_ptr() as usize + word.len();
        text[end..].trim_start().starts_with([':', ',', '='])
    };
    words.filter(is_declared).map(Box::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_sign_follows_is_declared() {
        let guessed = GuessedNames::new("node f(x , y' : real) returns (z) let w\n  = 3v + u; tel");
        let names = ["f", "x", "y'", "z", "w", "v", "3v", "u", "="];
        let declared = names.map(|name| guessed.declares(name));
        let wanted = [false, true, true, false, true, false, false, false, false];
        assert_eq!(declared, wanted);
    }
}
