//! What is wrong with a cell description, each fault with its place.

use core::fmt;
use core::ops::Range;

/// One fault in a cell description.
#[derive(Clone, Debug, PartialEq)]
pub struct CellError {
    /// Where, as a range of bytes of the text.
    pub span: Range<usize>,
    /// What is wrong: lower case, no full stop.
    pub message: String,
    /// What would be right, if that can be said.
    pub help: Option<String>,
}

/// How many characters of a line are shown at most.
const WIDEST: usize = 120;

/// All faults of one description, in the order of their places. Prints each with file, line, column and the line itself.
#[derive(Clone, Debug, PartialEq)]
pub struct CellErrors {
    /// The file's name, as given by the caller.
    pub file: String,
    /// The text, for the printing.
    pub text: String,
    /// The faults; never empty.
    pub errors: Vec<CellError>,
}

impl CellErrors {
    /// Line and column of a fault, both from 1, the column in characters.
    #[must_use]
    pub fn place(&self, error: &CellError) -> (usize, usize) {
        let before = self.text.get(..error.span.start).unwrap_or(&self.text);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        (line, column)
    }

    fn print(&self, error: &CellError, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.place(error);
        let text = self.text.lines().nth(line - 1).unwrap_or("");
        let marked = self.text.get(error.span.clone()).unwrap_or("");
        let width = marked.lines().next().unwrap_or("").chars().count();
        let width = width.clamp(1, WIDEST / 2);
        // Of a long line only what is around the fault.
        let left_out = (column - 1).saturating_sub(WIDEST / 2);
        let text: String = text.chars().skip(left_out).take(WIDEST).collect();
        let gutter = line.to_string().len();
        writeln!(f, "{}:{line}:{column}: {}", self.file, error.message)?;
        writeln!(f, " {line} | {text}")?;
        writeln!(
            f,
            " {:gutter$} | {:indent$}{}",
            "",
            "",
            "^".repeat(width),
            indent = column - 1 - left_out
        )?;
        match &error.help {
            Some(help) => writeln!(f, " {:gutter$} = {help}", ""),
            None => Ok(()),
        }
    }
}

impl fmt::Display for CellErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.errors
            .iter()
            .try_for_each(|error| self.print(error, f))
    }
}

impl std::error::Error for CellErrors {}
