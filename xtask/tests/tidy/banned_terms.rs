//! Terms of `banned_terms.txt`: identifiers and words for which the field has a standard term.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use rpi_testkit::workspace_root;
use xtask::{Part, PartKind, is_word, parts, tracked_files};

/// Path of the list.
const LIST: &str = "xtask/tests/tidy/banned_terms.txt";
/// Maximum number of entries: a newcomer can read the list.
const MAX_ENTRIES: usize = 120;
/// Files in which words do not count: the list and its test, and the history of what users noticed.
const EXEMPT: &[&str] = &[LIST, "CHANGELOG.md", "xtask/tests/tidy/banned_terms.rs"];
/// Types of files with words: documents, messages and programs.
const TEXTS: &[&str] = &["md", "stderr", "rpi", "lus", "toml"];

/// Kind of an entry.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum TermKind {
    Type,
    Identifier,
    Word,
}

/// Entry of the list.
struct Term {
    kind: TermKind,
    /// Name, or words in lower case.
    words: Vec<String>,
    standard: String,
}

/// Word of a text with its place.
struct Token<'a> {
    kind: TermKind,
    line: usize,
    text: &'a str,
}

#[test]
fn no_file_uses_a_banned_term() {
    let terms = terms();
    let mut found: BTreeMap<(TermKind, String), Vec<String>> = BTreeMap::new();
    for path in tracked_files() {
        let name = path.to_string_lossy().into_owned();
        let Ok(text) = std::fs::read_to_string(workspace_root().join(&path)) else {
            continue;
        };
        if EXEMPT.contains(&name.as_str()) {
            continue;
        }
        let tokens = tokens(&path, &text);
        for (at, term) in matches(&tokens, &terms) {
            let places = found.entry((term.kind, term.words.join(" "))).or_default();
            places.push(format!("{name}:{}", tokens[at].line));
        }
    }
    let lines = found.iter().map(|((kind, words), places)| {
        let standard = terms
            .iter()
            .find(|term| term.kind == *kind && term.words.join(" ") == *words);
        let standard = standard.map_or("", |term| &term.standard);
        format!(
            "{kind:?} `{words}` ({} times; use: {standard})\n  {}",
            places.len(),
            places.join("\n  ")
        )
    });
    let lines: Vec<String> = lines.collect();
    assert!(lines.is_empty(), "{}", lines.join("\n"));
}

#[test]
fn the_list_is_short_and_names_standard_terms() {
    let terms = terms();
    assert!(terms.len() <= MAX_ENTRIES, "{} entries", terms.len());
    let mut seen = BTreeSet::new();
    for term in &terms {
        let words = term.words.join(" ");
        assert!(!term.standard.is_empty(), "{words}: no standard term");
        assert!(
            seen.insert((term.kind, words.clone())),
            "{words} is listed twice"
        );
    }
}

/// Reads the list.
fn terms() -> Vec<Term> {
    let text = std::fs::read_to_string(workspace_root().join(LIST)).unwrap_or_default();
    let lines = text
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines
        .map(|line| term(line).unwrap_or_else(|| panic!("{LIST}: {line}")))
        .collect()
}

fn term(line: &str) -> Option<Term> {
    let (entry, standard) = line.split_once('#')?;
    let (kind, words) = entry.trim().split_once(' ')?;
    let kind = match kind {
        "type" => TermKind::Type,
        "identifier" => TermKind::Identifier,
        "word" => TermKind::Word,
        _ => return None,
    };
    let words = words.split(' ').map(str::to_owned).collect();
    Some(Term {
        kind,
        words,
        standard: standard.trim().to_owned(),
    })
}

/// Returns the terms that occur, each with the index of its first token.
fn matches<'a>(tokens: &[Token<'_>], terms: &'a [Term]) -> Vec<(usize, &'a Term)> {
    let mut by_word: BTreeMap<(TermKind, &str), Vec<&Term>> = BTreeMap::new();
    for term in terms {
        by_word
            .entry((term.kind, &term.words[0]))
            .or_default()
            .push(term);
    }
    let mut found = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        let lower = token.text.to_lowercase();
        let text = match token.kind {
            TermKind::Word => lower.as_str(),
            _ => token.text,
        };
        let candidates = by_word.get(&(token.kind, text)).into_iter().flatten();
        let occurs = |term: &&&Term| {
            let next = tokens[at..].iter().map(|token| token.text.to_lowercase());
            term.words.len() == 1 || next.take(term.words.len()).eq(term.words.iter().cloned())
        };
        found.extend(candidates.filter(occurs).map(|term| (at, *term)));
    }
    found
}

/// Returns the tokens of a file, by its type.
fn tokens<'a>(path: &Path, text: &'a str) -> Vec<Token<'a>> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    match extension {
        Some("rs") => parts(text).iter().flat_map(rust_tokens).collect(),
        Some("py") => words(TermKind::Identifier, 1, text)
            .filter(|token| !text.contains(&format!("\"{}\"", token.text)))
            .collect(),
        Some("md") => prose(text, 1),
        Some(other) if TEXTS.contains(&other) => words(TermKind::Word, 1, text).collect(),
        _ => Vec::new(),
    }
}

fn rust_tokens<'a>(part: &Part<'a>) -> Vec<Token<'a>> {
    match part.kind {
        PartKind::Comment => prose(part.text, part.line),
        PartKind::Literal if !part.text.contains(' ') => Vec::new(),
        PartKind::Literal => words(TermKind::Word, part.line, part.text).collect(),
        PartKind::Code => {
            let mut tokens: Vec<Token<'a>> =
                words(TermKind::Identifier, part.line, part.text).collect();
            let declares = ["struct", "enum", "trait", "type"];
            let types: Vec<Token<'a>> = tokens
                .windows(2)
                .filter(|pair| declares.contains(&pair[0].text))
                .map(|pair| Token {
                    kind: TermKind::Type,
                    ..pair[1]
                })
                .collect();
            tokens.extend(types);
            tokens
        }
    }
}

/// Returns the words of Markdown outside of code and link targets.
fn prose(text: &str, first: usize) -> Vec<Token<'_>> {
    let (mut tokens, mut in_code) = (Vec::new(), false);
    for (number, line) in text.lines().enumerate() {
        in_code ^= line.trim_start().starts_with("```");
        if in_code {
            continue;
        }
        for outside in line.split('`').step_by(2) {
            for (at, piece) in outside.split("](").enumerate() {
                let text = match at {
                    0 => piece,
                    _ => piece.split_once(')').map_or("", |(_, after)| after),
                };
                tokens.extend(words(TermKind::Word, first + number, text));
            }
        }
    }
    tokens
}

fn words(kind: TermKind, first: usize, text: &str) -> impl Iterator<Item = Token<'_>> {
    let lines = text.lines().enumerate();
    lines.flat_map(move |(number, line)| {
        let words = line
            .split(|c: char| !is_word(c))
            .filter(|word| !word.is_empty());
        words.map(move |text| Token {
            kind,
            line: first + number,
            text,
        })
    })
}

#[test]
fn words_and_identifiers_are_found_where_they_count() {
    let terms = [
        ("identifier told", "a"),
        ("type Found", "b"),
        ("word give up", "c"),
    ];
    let terms = terms.map(|(entry, standard)| term(&format!("{entry} # {standard}")).unwrap());
    let text =
        "enum Found {}\nlet told = \"told\"; // told, `told`: Give up.\nf(Found, told_by);\n";
    let tokens = tokens(Path::new("a.rs"), text);
    let found = matches(&tokens, &terms);
    let mut found: Vec<(usize, &str)> = found
        .iter()
        .map(|(at, term)| (tokens[*at].line, term.standard.as_str()))
        .collect();
    found.sort_unstable();
    assert_eq!(found, [(1, "b"), (2, "a"), (2, "c")]);
}
