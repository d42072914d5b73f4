//! Valid, unique Lustre names of letters, digits and `_`.

use std::collections::BTreeMap;

/// Keywords of Lustre V6 and Kind 2, which cannot be names of flows.
const KEYWORDS: &[&str] = &[
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

/// Names in use in the Lustre text. Each has the last number that was appended to it to make another name unique.
#[derive(Default)]
pub(super) struct Names {
    taken: BTreeMap<String, u32>,
}

impl Names {
    /// Returns an unused name similar to `like` that is valid in Lustre: `x.f[2]` becomes `x_f_2`.
    pub(super) fn fresh(&mut self, like: &str) -> String {
        let base = plain(like);
        let is_free = !KEYWORDS.contains(&base.as_str()) && !self.taken.contains_key(&base);
        let mut last = self.taken.get(&base).copied().unwrap_or(1);
        let mut name = base.clone();
        while !is_free && (name == base || self.taken.contains_key(&name)) {
            last += 1;
            name = format!("{base}_{last}");
        }
        self.taken.insert(base, last);
        self.taken.entry(name.clone()).or_insert(1);
        name
    }
}

fn plain(like: &str) -> String {
    let like = like.rsplit("::").next().unwrap_or(like);
    // An index `x[2]` becomes `x_2`: its closing bracket is dropped.
    let kept = like.chars().filter(|c| *c != ']' && *c != '\'');
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = kept.map(letter).collect();
    match name.chars().next() {
        Some(c) if c.is_ascii_alphabetic() => name,
        _ => format!("v{name}"),
    }
}
