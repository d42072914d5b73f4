//! Separation of a Rust source text into code, comments and string literals.

/// Kind of a part of a Rust source text: code, comment or string.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PartKind {
    /// Code: text that is neither a comment nor a string literal.
    Code,
    /// Line comment or block comment, including doc comments.
    Comment,
    /// String literal or raw string literal, with its quotes.
    Literal,
}

/// Part of a Rust source text: a comment, a string literal, or the code between two of them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Part<'a> {
    /// Kind of the part: code, comment or string.
    pub kind: PartKind,
    /// Line number of the first character of the part, from 1.
    pub line: usize,
    /// Source text of the part, with its delimiters.
    pub text: &'a str,
}

/// Returns the parts of a Rust source text, in order. Concatenated, they are the whole text.
pub fn parts(text: &str) -> Vec<Part<'_>> {
    let mut parts: Vec<Part<'_>> = Vec::new();
    let (mut start, mut at, mut line) = (0, 0, 1);
    while at < text.len() {
        let Some((kind, length)) = special(&text[..at], &text[at..]) else {
            at += text[at..].chars().next().map_or(1, char::len_utf8);
            continue;
        };
        for (kind, text) in [
            (PartKind::Code, &text[start..at]),
            (kind, &text[at..at + length]),
        ] {
            if !text.is_empty() {
                parts.push(Part { kind, line, text });
                line += text.matches('\n').count();
            }
        }
        at += length;
        start = at;
    }
    if start < text.len() {
        let (kind, text) = (PartKind::Code, &text[start..]);
        parts.push(Part { kind, line, text });
    }
    parts
}

/// Returns the kind and the length in bytes of the comment or literal at the start of `rest`; `None` if code is there.
/// `before` is the text before `rest`. A character literal counts as code, but is returned as a whole, because it may
/// contain a quote.
fn special(before: &str, rest: &str) -> Option<(PartKind, usize)> {
    if rest.starts_with("//") {
        let length = rest.find('\n').unwrap_or(rest.len());
        return Some((PartKind::Comment, length));
    }
    if let Some(body) = rest.strip_prefix("/*") {
        let length = body.find("*/").map_or(rest.len(), |end| end + 4);
        return Some((PartKind::Comment, length));
    }
    if rest.starts_with("'\"'") || rest.starts_with("'\\\"'") {
        let length = rest[1..].find("'").unwrap_or(0) + 2;
        return Some((PartKind::Code, length));
    }
    if rest.starts_with('r') && !before.ends_with(is_word) || rest.starts_with("br") {
        return raw_string(rest).map(|length| (PartKind::Literal, length));
    }
    rest.starts_with('"')
        .then(|| (PartKind::Literal, string_length(rest)))
}

/// Returns true if the character can be part of an identifier of Rust.
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Returns the length in bytes of the raw string literal at the start of the text, such as `r"..."` or `r#"..."#`;
/// `None` if there is none.
fn raw_string(text: &str) -> Option<usize> {
    let start = text.find('r')? + 1;
    let hashes = text[start..].bytes().take_while(|b| *b == b'#').count();
    let body = text[start + hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let at = body.find(&end).unwrap_or(body.len());
    Some((start + hashes + 1 + at + end.len()).min(text.len()))
}

/// Returns the length in bytes of the string literal at the start of the text, including both quotes.
fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_literals_are_separated_from_code() {
        let text = "let a = \"x \\\" y\"; // c\nlet b = '\"'; let c = r#\"a \"b\" c\"#;\n";
        let found: Vec<(PartKind, usize, &str)> = parts(text)
            .iter()
            .map(|part| (part.kind, part.line, part.text))
            .collect();
        use PartKind::{Code, Comment, Literal};
        assert_eq!(
            found,
            [
                (Code, 1, "let a = "),
                (Literal, 1, "\"x \\\" y\""),
                (Code, 1, "; "),
                (Comment, 1, "// c"),
                (Code, 1, "\nlet b = "),
                (Code, 2, "'\"'"),
                (Code, 2, "; let c = "),
                (Literal, 2, "r#\"a \"b\" c\"#"),
                (Code, 2, ";\n"),
            ]
        );
    }
}
