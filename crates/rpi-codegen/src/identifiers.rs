//! C identifiers.

use std::collections::BTreeSet;

/// Words that a generated name must not be: keywords of C and C++, macros of the standard headers, and names that the
/// generated functions use themselves.
const RESERVED: &[&str] = &[
    "alignas",
    "alignof",
    "and",
    "and_eq",
    "asm",
    "at",
    "atomic",
    "auto",
    "bitand",
    "bitor",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "class",
    "compl",
    "concept",
    "const",
    "constexpr",
    "continue",
    "cx",
    "decltype",
    "default",
    "delete",
    "do",
    "double",
    "else",
    "enum",
    "explicit",
    "export",
    "extern",
    "false",
    "float",
    "for",
    "friend",
    "goto",
    "if",
    "in",
    "inline",
    "int",
    "linux",
    "long",
    "mutable",
    "namespace",
    "new",
    "noexcept",
    "not",
    "not_eq",
    "nullptr",
    "operator",
    "or",
    "or_eq",
    "out",
    "private",
    "protected",
    "public",
    "register",
    "requires",
    "restrict",
    "return",
    "s",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "switch",
    "template",
    "this",
    "throw",
    "true",
    "try",
    "typedef",
    "typeid",
    "typename",
    "typeof",
    "union",
    "unix",
    "unsigned",
    "using",
    "v",
    "virtual",
    "void",
    "volatile",
    "while",
    "xor",
    "xor_eq",
];

/// Set of names that are in use in one C scope.
#[derive(Default)]
pub(crate) struct Names {
    taken: BTreeSet<String>,
}

impl Names {
    /// Returns an unused identifier derived from `text`, and reserves it.
    pub(crate) fn unique(&mut self, text: &str) -> String {
        let base = identifier(text);
        let mut candidate = base.clone();
        let mut number = 2;
        while !self.taken.insert(candidate.clone()) {
            candidate = format!("{base}_{number}");
            number += 1;
        }
        candidate
    }
}

/// Converts a text to a C identifier: letters and digits, with `_` for everything else.
pub(crate) fn identifier(text: &str) -> String {
    let mut name = String::new();
    for c in text.chars() {
        match c {
            c if c.is_ascii_alphanumeric() => name.push(c),
            _ if name.ends_with('_') || name.is_empty() => {}
            _ => name.push('_'),
        }
    }
    let name = name.trim_end_matches('_');
    // Names that start with `rpi_` are those of the common functions.
    let prefix = match name.chars().next() {
        Some(c) if c.is_ascii_alphabetic() && !name.starts_with("rpi_") => "",
        _ => "x_",
    };
    let suffix = if RESERVED.contains(&name) || name == "main" {
        "_"
    } else {
        ""
    };
    format!("{prefix}{name}{suffix}")
}

/// Returns the parts of a C text: identifiers and numbers as they are, and the characters between them. A part is an
/// identifier if it starts with a letter or `_`.
pub(crate) fn tokens(text: &str) -> Vec<&str> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut parts = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| is_word(c) != is_word(first));
        let (part, others) = rest.split_at(end.unwrap_or(rest.len()));
        parts.push(part);
        rest = others;
    }
    parts
}

/// Returns whether an identifier occurs in a C text.
pub(crate) fn mentions(text: &str, name: &str) -> bool {
    tokens(text).contains(&name)
}

/// Returns all identifiers of a C text, except names of fields.
pub(crate) fn variables_in(text: &str) -> BTreeSet<&str> {
    let parts = tokens(text);
    let is_field =
        |k: usize| k > 0 && (parts[k - 1].ends_with("->") || parts[k - 1].ends_with('.'));
    let named = parts.iter().enumerate().filter(|(k, _)| !is_field(*k));
    named.map(|(_, part)| *part).collect()
}
