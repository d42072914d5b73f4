//! Errors in a cell description, with their positions.

use core::fmt;
use core::ops::Range;

/// An error in a cell description.
#[derive(Clone, Debug, PartialEq)]
pub struct CellError {
    /// Byte range of the error in the text.
    pub span: Range<usize>,
    /// The message: lower case, no full stop.
    pub message: String,
    /// Suggested correction, if any.
    pub help: Option<String>,
}

impl fmt::Display for CellError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for CellError {}

/// Maximum number of characters shown of a line.
const MAX_LINE_WIDTH: usize = 120;

/// All errors of one description, in the order of their positions. `Display` prints each with file, line, column and
/// source line.
#[derive(Clone, Debug, PartialEq)]
pub struct CellErrors {
    /// Name of the file, as passed by the caller.
    pub file: String,
    /// Text of the description, for printing source lines.
    pub text: String,
    /// The errors; never empty.
    pub errors: Vec<CellError>,
}

impl CellErrors {
    /// Line and column of an error, both from 1; the column counts characters.
    #[must_use]
    pub fn line_column(&self, error: &CellError) -> (usize, usize) {
        let before = self.text.get(..error.span.start).unwrap_or(&self.text);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        (line, column)
    }

    fn print(&self, error: &CellError, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_column(error);
        let text = self.text.lines().nth(line - 1).unwrap_or("");
        let marked = self.text.get(error.span.clone()).unwrap_or("");
        let width = marked.lines().next().unwrap_or("").chars().count();
        let width = width.clamp(1, MAX_LINE_WIDTH / 2);
        // Shows only the part of a long line around the error.
        let left_out = (column - 1).saturating_sub(MAX_LINE_WIDTH / 2);
        let text: String = text.chars().skip(left_out).take(MAX_LINE_WIDTH).collect();
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
