//! Names that Lustre can have: letters, digits and `_`, each given once.

use std::collections::BTreeSet;

/// Words of Lustre V6 and Kind 2 that no flow may be called.
const WORDS: &[&str] = &[
    "and",
    "any",
    "assert",
    "assume",
    "bool",
    "check",
    "choose",
    "const",
    "contract",
    "current",
    "div",
    "else",
    "end",
    "enum",
    "exists",
    "extern",
    "false",
    "fby",
    "fi",
    "forall",
    "frame",
    "function",
    "guarantee",
    "if",
    "import",
    "imported",
    "include",
    "int",
    "last",
    "let",
    "match",
    "merge",
    "mod",
    "mode",
    "model",
    "node",
    "nor",
    "not",
    "of",
    "operator",
    "or",
    "package",
    "pre",
    "real",
    "require",
    "restart",
    "returns",
    "step",
    "struct",
    "subrange",
    "tel",
    "then",
    "true",
    "type",
    "unsafe",
    "uses",
    "var",
    "when",
    "with",
    "xor",
];

/// The names that are taken.
#[derive(Default)]
pub(super) struct Names {
    taken: BTreeSet<String>,
}

impl Names {
    /// A name like this one: `x.f[2]` becomes `x_f_2`.
    pub(super) fn fresh(&mut self, like: &str) -> String {
        let base = plain(like);
        let mut name = base.clone();
        let mut k = 1;
        while WORDS.contains(&name.as_str()) || !self.taken.insert(name.clone()) {
            k += 1;
            name = format!("{base}_{k}");
        }
        name
    }
}

fn plain(like: &str) -> String {
    let like = like.rsplit("::").next().unwrap_or(like);
    let kept = like.chars().filter(|c| *c != ']' && *c != '\'');
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = kept.map(letter).collect();
    match name.chars().next() {
        Some(c) if c.is_ascii_alphabetic() => name,
        _ => format!("v{name}"),
    }
}
