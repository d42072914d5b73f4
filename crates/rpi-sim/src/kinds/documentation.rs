//! Documentation of keys, for the manual.

use super::SmallKind;

/// Documentation of a key that a cell may give to a device, for the manual.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyInfo {
    /// Name of the key in the table of the device in a cell.
    pub name: &'static str,
    /// Meaning of the value, with its unit.
    pub description: String,
    /// Value that the key has if the cell does not give it.
    pub default: String,
}

impl SmallKind {
    /// Returns the documentation of the keys besides `kind`, in the order in which they are declared.
    #[must_use]
    pub fn key_infos(&self) -> Vec<KeyInfo> {
        let info = |key: &super::Key| KeyInfo {
            name: key.name,
            description: key.description(),
            default: key.default_text(),
        };
        self.keys().map(info).collect()
    }
}
