//! Names and other short strings, shared instead of copied.

use std::borrow::Borrow;
use std::cell::RefCell;
use std::collections::HashSet;
use std::fmt;
use std::hash::{BuildHasherDefault, Hasher};
use std::ops::Deref;
use std::sync::Arc;

/// Name as written in the source: plain (`arm`) or qualified (`Core::DoubleAdd`).
///
/// Cloning is cheap (reference-counted text). Names compare, sort and hash by their text.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name(Arc<str>);

impl Name {
    /// Returns the text of the name.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Returns whether the name has several parts, joined by `::`.
    pub fn is_qualified(&self) -> bool {
        self.0.contains("::")
    }

    /// Returns the parts between the `::`; one part for a plain name.
    pub fn parts(&self) -> impl Iterator<Item = &str> {
        self.0.split("::")
    }
}

impl PartialEq<str> for Name {
    fn eq(&self, other: &str) -> bool {
        &*self.0 == other
    }
}

impl PartialEq<&str> for Name {
    fn eq(&self, other: &&str) -> bool {
        &*self.0 == *other
    }
}

impl Deref for Name {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl Borrow<str> for Name {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Name {
    fn from(text: &str) -> Name {
        Name(text.into())
    }
}

impl From<String> for Name {
    fn from(text: String) -> Name {
        Name(text.into())
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`", self.0)
    }
}

/// Constructor of [`NameHasher`] values for hash tables with short strings as keys.
pub(crate) type BuildNameHasher = BuildHasherDefault<NameHasher>;

/// String interner: equal names of one text share their memory.
#[derive(Default)]
pub(crate) struct Interner(RefCell<HashSet<Name, BuildNameHasher>>);

impl Interner {
    pub(crate) fn intern(&self, text: &str) -> Name {
        let mut names = self.0.borrow_mut();
        if let Some(name) = names.get(text) {
            return name.clone();
        }
        let name = Name::from(text);
        names.insert(name.clone());
        name
    }
}

/// State of a hash function for short strings, which multiplies and rotates eight bytes at a time. It does not resist
/// deliberate collisions.
#[derive(Default)]
pub(crate) struct NameHasher(u64);

impl NameHasher {
    fn add_word(&mut self, word: u64) {
        // 2^64 divided by the golden ratio (Fibonacci hashing, Knuth, TAOCP 3, 6.4).
        const ODD: u64 = 0x9e37_79b9_7f4a_7c15;
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(ODD);
    }
}

impl Hasher for NameHasher {
    fn write(&mut self, bytes: &[u8]) {
        let (words, rest) = bytes.as_chunks::<8>();
        for word in words {
            self.add_word(u64::from_le_bytes(*word));
        }
        let mut last = [0; 8];
        last[..rest.len()].copy_from_slice(rest);
        self.add_word(u64::from_le_bytes(last));
    }

    fn write_u8(&mut self, byte: u8) {
        self.add_word(byte.into());
    }

    fn finish(&self) -> u64 {
        // The hash table selects a bucket by the low bits, where a product is weakest.
        self.0 ^ (self.0 >> 32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_names_share_their_memory() {
        let names = Interner::default();
        let (a, b) = (names.intern("arm"), names.intern("arm"));
        assert!(Arc::ptr_eq(&a.0, &b.0));
        assert_ne!(a, names.intern("leg"));
    }

    #[test]
    fn qualified_names_have_parts() {
        let name = Name::from("Core::Clock");
        assert!(name.is_qualified());
        assert_eq!(name.parts().collect::<Vec<_>>(), ["Core", "Clock"]);
        assert_eq!(Name::from("x").parts().count(), 1);
    }
}
