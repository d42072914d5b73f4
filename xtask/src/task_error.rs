//! Error of a maintenance task.

use std::fmt;

/// Error that ends a maintenance task, as a text for the developer who started the task. The text is empty if the task
/// has already printed the error.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct TaskError(String);

impl fmt::Display for TaskError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for TaskError {}

impl From<std::io::Error> for TaskError {
    fn from(error: std::io::Error) -> TaskError {
        TaskError(error.to_string())
    }
}

impl From<String> for TaskError {
    fn from(text: String) -> TaskError {
        TaskError(text)
    }
}

impl From<&str> for TaskError {
    fn from(text: &str) -> TaskError {
        TaskError(text.to_owned())
    }
}
