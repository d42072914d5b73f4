//! Error of loading an image outside of a cell.

use std::fmt;

use rpi_core::LoadError;

/// Error: an image cannot be loaded. It has all reasons, which its text lists in one line.
#[derive(Clone, PartialEq, Debug)]
pub struct ImageLoadError(pub Vec<LoadError>);

impl fmt::Display for ImageLoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texts: Vec<String> = self.0.iter().map(ToString::to_string).collect();
        f.write_str(&texts.join("; "))
    }
}

impl std::error::Error for ImageLoadError {}
