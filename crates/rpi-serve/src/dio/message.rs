//! Messages of the DirectIO protocol 2.0 and their text form.
//!
//! ```text
//! message = tag "=" name "(" [ arg { "," arg } ] ")"
//! arg     = string | number | "[" [ arg { "," arg } ] "]" | "{" [ key ":" arg { "," key ":" arg } ] "}"
//! key     = identifier | string
//! ```

use std::fmt::{self, Write};

/// Message of the DirectIO protocol: a request, an answer, or an update of a subscription.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Message {
    /// Tag chosen by the client; answers and updates carry the tag of their request.
    pub(crate) tag: String,
    /// Name of the request, answer or update, such as `nest` (start a net) or `ok`.
    pub(crate) name: String,
    /// Arguments in the order in which the message lists them.
    pub(crate) args: Vec<Arg>,
}

/// Argument in a message of the DirectIO protocol.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Arg {
    /// Text; in a message it is written in quotation marks.
    Text(String),
    /// Number; integers are read as reals, too.
    Number(f64),
    /// List of arguments, in square brackets.
    List(Vec<Arg>),
    /// Map from keys to arguments. Entries keep the order of the text.
    Map(Vec<(String, Arg)>),
}

impl Message {
    /// Creates a message of the DirectIO protocol: tag of the request, name of the message, arguments.
    pub(crate) fn new(tag: &str, name: &str, args: Vec<Arg>) -> Message {
        Message {
            tag: tag.to_owned(),
            name: name.to_owned(),
            args,
        }
    }
}

impl Arg {
    /// Creates an argument of the kind [`Arg::Text`].
    pub(crate) fn text(text: impl Into<String>) -> Arg {
        Arg::Text(text.into())
    }

    /// Returns the text if the argument is a text, else `None`.
    pub(crate) fn as_text(&self) -> Option<&str> {
        match self {
            Arg::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Returns the number if the argument is a number, else `None`.
    pub(crate) fn as_number(&self) -> Option<f64> {
        match self {
            Arg::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// Returns the texts if the argument is a list of texts, else `None`.
    pub(crate) fn as_texts(&self) -> Option<Vec<&str>> {
        match self {
            Arg::List(list) => list.iter().map(Arg::as_text).collect(),
            _ => None,
        }
    }

    /// Returns the entries if the argument is a map, else `None`.
    pub(crate) fn as_map(&self) -> Option<&[(String, Arg)]> {
        match self {
            Arg::Map(entries) => Some(entries),
            _ => None,
        }
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}(", self.tag, self.name)?;
        write_separated(f, &self.args, |f, arg| arg.fmt(f))?;
        f.write_char(')')
    }
}

impl fmt::Display for Arg {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Arg::Text(text) => write_quoted(f, text),
            Arg::Number(number) => write!(f, "{number:?}"),
            Arg::List(list) => {
                f.write_char('[')?;
                write_separated(f, list, |f, arg| arg.fmt(f))?;
                f.write_char(']')
            }
            Arg::Map(entries) => {
                f.write_char('{')?;
                write_separated(f, entries, |f, (key, arg)| {
                    write_quoted(f, key)?;
                    write!(f, ":{arg}")
                })?;
                f.write_char('}')
            }
        }
    }
}

fn write_separated<T>(
    f: &mut fmt::Formatter<'_>,
    items: &[T],
    mut each: impl FnMut(&mut fmt::Formatter<'_>, &T) -> fmt::Result,
) -> fmt::Result {
    for (number, item) in items.iter().enumerate() {
        if number > 0 {
            f.write_char(',')?;
        }
        each(f, item)?;
    }
    Ok(())
}

/// Writes a text in quotes. Quotes and backslashes are escaped; a line break becomes a space, as the protocol has no
/// escape for it.
fn write_quoted(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    f.write_char('"')?;
    for sign in text.chars() {
        match sign {
            '"' | '\\' => write!(f, "\\{sign}")?,
            '\n' | '\r' => f.write_char(' ')?,
            _ => f.write_char(sign)?,
        }
    }
    f.write_char('"')
}
