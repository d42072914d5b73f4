//! String literals: conversion between source text and content.

/// Returns the content of a string literal, without quotes and with escapes resolved. A missing closing quote is
/// accepted, as the lexer has reported it.
///
/// Escapes are `\"`, `\\`, `\n`, `\t` and `\r`; any other escaped character denotes itself.
pub(crate) fn unquote(literal: &str) -> String {
    let inner = literal.strip_prefix('"').unwrap_or(literal);
    let mut content = String::with_capacity(inner.len());
    let mut chars = inner.chars();
    while let Some(c) = chars.next() {
        match c {
            '"' => break,
            '\\' => content.extend(chars.next().map(unescape)),
            c => content.push(c),
        }
    }
    content
}

fn unescape(c: char) -> char {
    match c {
        'n' => '\n',
        't' => '\t',
        'r' => '\r',
        c => c,
    }
}

/// Returns a string literal with the given content, in quotes and with escapes.
pub(crate) fn quote(content: &str) -> String {
    let mut literal = String::with_capacity(content.len() + 2);
    literal.push('"');
    for c in content.chars() {
        match c {
            '"' | '\\' => literal.extend(['\\', c]),
            '\n' => literal.push_str("\\n"),
            '\t' => literal.push_str("\\t"),
            '\r' => literal.push_str("\\r"),
            c => literal.push(c),
        }
    }
    literal.push('"');
    literal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_contents_read_back() {
        for content in ["", "arm", "a \"b\" \\ c", "line\nline\ttab\r", "grüße"] {
            assert_eq!(unquote(&quote(content)), content);
        }
        assert_eq!(unquote("\"open"), "open");
    }
}
