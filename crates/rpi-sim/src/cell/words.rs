//! The methods of a reader for words of a list.

use super::reader::TableReader;
use super::shape::{ListLength, ValueShape};
use super::suggestion::nearest;

/// Value of a key that names one of several known words, or a file.
pub(super) enum WordOrFile<'a> {
    /// One of the known words.
    Word(&'static str),
    /// Path of a file.
    File(&'a str),
}

impl<'a> TableReader<'a> {
    /// Reads a string that must be one of `known`; `None` if the key is missing or invalid.
    pub(super) fn keyword(
        &mut self,
        key: &'static str,
        known: &[&'static str],
    ) -> Option<&'static str> {
        self.get(key, || ValueShape::Word(known.to_vec()))?
            .word(known)
    }

    /// Reads a list of strings, each of which must be one of `known`; `None` if the key is missing or not a list.
    pub(super) fn keywords(
        &mut self,
        key: &'static str,
        known: &[&'static str],
    ) -> Option<Vec<&'static str>> {
        let words = || ValueShape::Word(known.to_vec());
        let given = self.get(key, || ValueShape::list(words(), ListLength::ANY))?;
        let list = given.list("a list of strings")?;
        Some(list.iter().filter_map(|entry| entry.word(known)).collect())
    }

    /// Reads a string that must be one of `known`, or the path of a file with one of `extensions`; `None` if the key is
    /// missing or invalid.
    pub(super) fn keyword_or_file(
        &mut self,
        key: &'static str,
        known: &[&'static str],
        extensions: &'static [&'static str],
    ) -> Option<WordOrFile<'a>> {
        // A recording reader records both.
        let _ = self.get(key, || ValueShape::Word(known.to_vec()));
        let given = self.get(key, || ValueShape::File(extensions))?;
        let path = given.node.get_ref().as_str();
        let path = path.filter(|path| extensions.iter().any(|end| path.ends_with(end)));
        match path {
            Some(path) => Some(WordOrFile::File(path)),
            None => given.word(known).map(WordOrFile::Word),
        }
    }

    /// Reads the word at `key`, one of `known`, and then by `read` the keys that depend on the word; `None` if the key is
    /// missing or invalid. A recording reader walks `read` for every word.
    pub(super) fn variant<T>(
        &mut self,
        key: &'static str,
        known: &[&'static str],
        read: impl Fn(&mut TableReader<'a>, &'static str) -> Option<T>,
    ) -> Option<T> {
        if let Some(shape) = &self.recorder {
            for word in known {
                let mut variant = Self::recording(shape.variant(key, word), self.errors);
                read(&mut variant, word);
            }
            return None;
        }
        let word = self.keyword(key, known)?;
        read(self, word)
    }
}

/// Returns a suggestion for a misspelt word: the nearest of the known words, or all of them.
pub(super) fn did_you_mean(word: &str, known: &[&str]) -> String {
    match nearest(word, known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("expected one of {}", known.join(", ")),
    }
}
