//! The files that are made from the project's own tables, so that nothing is written twice.
//!
//! `cargo xtask gen` writes them; a test compares what is checked in with what would be written.

mod differences;
mod findings;
mod primitives;
mod textmate;
mod vim;
mod words;

use std::io;
use std::path::PathBuf;

use rpi_syntax::Mode;
use rpi_testkit::workspace_root;

/// A file that is made from tables.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Generated {
    /// Where it lies, relative to the root of the workspace.
    pub path: &'static str,
    /// What it holds.
    pub text: String,
}

impl Generated {
    /// Where it lies on this machine.
    pub fn location(&self) -> PathBuf {
        workspace_root().join(self.path)
    }

    /// Whether the file that is checked in holds just this.
    pub fn is_current(&self) -> bool {
        std::fs::read_to_string(self.location()).is_ok_and(|text| text == self.text)
    }

    /// Writes the file.
    ///
    /// # Errors
    ///
    /// If its folder does not exist or may not be written.
    pub fn write(&self) -> io::Result<()> {
        std::fs::write(self.location(), &self.text)
    }
}

/// Every generated file.
pub fn generated() -> Vec<Generated> {
    vec![
        Generated {
            path: "docs/src/language/words.md",
            text: words::chapter(),
        },
        Generated {
            path: "docs/src/differences.md",
            text: differences::chapter(),
        },
        Generated {
            path: "docs/src/findings.md",
            text: findings::chapter(),
        },
        Generated {
            path: "docs/src/primitives.md",
            text: primitives::chapter(),
        },
        Generated {
            path: "editor-support/vscode/syntaxes/rpi.tmLanguage.json",
            text: textmate::grammar(),
        },
        Generated {
            path: "editor-support/neovim/syntax/rpi.vim",
            text: vim::syntax(Mode::Rpi),
        },
        Generated {
            path: "editor-support/neovim/syntax/lustre.vim",
            text: vim::syntax(Mode::Lustre),
        },
    ]
}

/// The first line of generated Markdown.
const MARK: &str =
    "<!-- Made by `cargo xtask gen`; changes belong into the tables it is made from. -->\n\n";
