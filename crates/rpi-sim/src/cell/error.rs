//! Errors in a cell description, with their positions.

use core::fmt;
use core::ops::Range;

/// Error in a description of a cell or robot, with its position.
#[derive(Clone, Debug, PartialEq)]
pub struct CellError {
    /// Byte range of the error in the text of the description.
    pub span: Range<usize>,
    /// Message in lower case, without a full stop.
    pub message: String,
    /// Suggested correction; `None` without one.
    pub help: Option<String>,
}

impl fmt::Display for CellError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for CellError {}

/// Maximum number of characters of a source line that an error shows.
const MAX_LINE_WIDTH: usize = 120;

/// All errors of one description, in the order of their positions. `Display` prints each with file, line, column and
/// source line.
#[derive(Clone, Debug, PartialEq)]
pub struct CellErrors {
    /// Name of the file, as given by the caller of the parser.
    pub file: String,
    /// Text of the description, from which errors show lines.
    pub text: String,
    /// All errors of the description; never empty.
    pub errors: Vec<CellError>,
}

impl CellErrors {
    /// Creates the error of a whole file, without a position in it.
    pub(super) fn of_file(file: &str, message: String, help: Option<String>) -> Self {
        let error = CellError {
            span: 0..0,
            message,
            help,
        };
        Self {
            file: file.to_owned(),
            text: String::new(),
            errors: vec![error],
        }
    }

    /// Returns the message of an error after its place, such as `ur.toml:3:5: unknown key`.
    pub(super) fn located(&self, error: &CellError) -> String {
        if self.text.is_empty() {
            return format!("{}: {}", self.file, error.message);
        }
        let (line, column) = self.line_column(error);
        format!("{}:{line}:{column}: {}", self.file, error.message)
    }

    /// Returns line and column of an error, both counted from 1; the column counts characters.
    #[must_use]
    pub fn line_column(&self, error: &CellError) -> (usize, usize) {
        let before = self.text.get(..error.span.start).unwrap_or(&self.text);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        (line, column)
    }

    fn print(&self, error: &CellError, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.text.is_empty() {
            let help = error.help.as_deref();
            let help = help.map_or(String::new(), |help| format!("  = {help}\n"));
            return write!(f, "{}\n{help}", self.located(error));
        }
        let (line, column) = self.line_column(error);
        let text = self.text.lines().nth(line - 1).unwrap_or("");
        let marked = self.text.get(error.span.clone()).unwrap_or("");
        let width = marked.lines().next().unwrap_or("").chars().count();
        let width = width.clamp(1, MAX_LINE_WIDTH / 2);
        // Shows only the part of a long line around the error.
        let left_out = (column - 1).saturating_sub(MAX_LINE_WIDTH / 2);
        let text: String = text.chars().skip(left_out).take(MAX_LINE_WIDTH).collect();
        let gutter = line.to_string().len();
        writeln!(f, "{}", self.located(error))?;
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
