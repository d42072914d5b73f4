//! JSON for schemas. The keys of an object keep their order, which editors show.

use core::fmt::Write;

/// JSON value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Json {
    Bool(bool),
    Integer(u64),
    Number(f64),
    Text(String),
    List(Vec<Json>),
    /// Keys with their values, in the order of the text.
    Object(Vec<(String, Json)>),
}

/// Maximum width of a line that contains a whole list or object.
const LINE_WIDTH: usize = 120;

impl Json {
    pub(super) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    pub(super) fn texts<'a>(texts: impl IntoIterator<Item = &'a str>) -> Self {
        Self::List(texts.into_iter().map(Self::text).collect())
    }

    pub(super) fn object(entries: impl IntoIterator<Item = (&'static str, Json)>) -> Self {
        let entries = entries.into_iter();
        Self::Object(
            entries
                .map(|(key, value)| (key.to_owned(), value))
                .collect(),
        )
    }

    /// Adds a key to an object; has no effect on other values.
    pub(super) fn add(&mut self, key: &str, value: Json) {
        if let Self::Object(entries) = self {
            entries.push((key.to_owned(), value));
        }
    }

    /// Adds the entries of another object to an object; has no effect on other values.
    pub(super) fn extend(&mut self, other: Json) {
        if let (Self::Object(entries), Self::Object(others)) = (self, other) {
            entries.extend(others);
        }
    }

    /// Returns the text of the value with a line break at its end. Lists and objects that fit are on one line.
    pub(super) fn document(&self) -> String {
        let mut out = String::new();
        self.write(0, 0, &mut out);
        out.push('\n');
        out
    }

    /// Writes the value at the indentation `indent`, after `before` characters on the line.
    fn write(&self, indent: usize, before: usize, out: &mut String) {
        let mut line = String::new();
        self.write_line(&mut line);
        if indent + before + line.chars().count() <= LINE_WIDTH {
            out.push_str(&line);
            return;
        }
        let (entries, brackets): (Vec<(String, &Json)>, _) = match self {
            Self::List(list) => {
                let values = list.iter().map(|value| (String::new(), value));
                (values.collect(), ['[', ']'])
            }
            Self::Object(entries) => {
                let named = entries.iter();
                let named = named.map(|(key, value)| (format!("{}: ", quoted(key)), value));
                (named.collect(), ['{', '}'])
            }
            _ => {
                out.push_str(&line);
                return;
            }
        };
        let inner = indent + 2;
        out.push(brackets[0]);
        for (place, (key, value)) in entries.iter().enumerate() {
            let comma = if place == 0 { "" } else { "," };
            let _ = write!(out, "{comma}\n{:inner$}{key}", "");
            value.write(inner, key.chars().count(), out);
        }
        let _ = write!(out, "\n{:indent$}{}", "", brackets[1]);
    }

    fn write_line(&self, out: &mut String) {
        match self {
            Self::Bool(value) => out.push_str(if *value { "true" } else { "false" }),
            Self::Integer(value) => out.push_str(&value.to_string()),
            Self::Number(value) => out.push_str(&value.to_string()),
            Self::Text(text) => out.push_str(&quoted(text)),
            Self::List(list) => {
                out.push('[');
                for (place, value) in list.iter().enumerate() {
                    out.push_str(if place == 0 { "" } else { ", " });
                    value.write_line(out);
                }
                out.push(']');
            }
            Self::Object(entries) => {
                out.push('{');
                for (place, (key, value)) in entries.iter().enumerate() {
                    let comma = if place == 0 { " " } else { ", " };
                    let _ = write!(out, "{comma}{}: ", quoted(key));
                    value.write_line(out);
                }
                out.push_str(if entries.is_empty() { "}" } else { " }" });
            }
        }
    }
}

/// Returns a text as a string of JSON, in quotes.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '\n' => out.push_str("\\n"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_values_take_several_lines_and_texts_are_escaped() {
        let long = "x".repeat(LINE_WIDTH);
        let short = Json::object([("a", Json::Integer(1)), ("b", Json::List(Vec::new()))]);
        let all = Json::List(vec![
            short,
            Json::text(long.clone()),
            Json::text("\"\\\n\u{1}"),
        ]);
        let expected = format!(
            "[\n  {{ \"a\": 1, \"b\": [] }},\n  \"{long}\",\n  \"\\\"\\\\\\n\\u0001\"\n]\n"
        );
        assert_eq!(all.document(), expected);
    }
}
