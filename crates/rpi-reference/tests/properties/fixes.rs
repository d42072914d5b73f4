//! Sure fixes preserve the meaning: a correct program with one mistake is fixed as by `rpic check --fix`. If the result
//! has no errors, it must compute the same as the correct program, or as the mistaken one if that had no errors either.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rpi_diag::{Severity, apply, sure_edits};
use rpi_driver::{InputKind, compile};

use crate::clocked;
use crate::program::{Counts, program};
use crate::random::Random;
use crate::run::{CompiledNode, input};
use crate::{CYCLES, PROGRAMS, SEED, number};

/// Number of mistakes per program.
const MISTAKES: usize = 5;
/// Largest number of rounds of fixes, as in `rpic`.
const ROUNDS: usize = 10;

/// Equivalents of keywords and operators in other languages.
const FOREIGN: &[(&str, &[&str])] = &[
    ("and", &["&&", "&", "AND"]),
    ("or", &["||", "|", "OR"]),
    ("not", &["!", "~", "NOT"]),
    ("=", &["==", ":=", "=="]),
    ("<>", &["!=", "~=", "/="]),
    ("<=", &["=<"]),
    ("mod", &["%", "MOD", "rem"]),
    ("div", &["/", "//", "DIV"]),
    ("->", &[";", ":"]),
    ("fby", &["->", ","]),
    (";", &[",", "", ";;", ":"]),
    (",", &[";", "", ",,"]),
    (":", &["", "=", "::"]),
    ("(", &["[", "{", ""]),
    (")", &["]", "}", ""]),
    ("true", &["True", "TRUE", "1"]),
    ("false", &["False", "FALSE", "0"]),
    ("int", &["integer", "Int", "i64"]),
    ("bool", &["boolean", "BOOL"]),
    ("real", &["float", "double", "REAL"]),
    ("if", &["when", "IF", "if ("]),
    ("then", &["", "THEN", "?", ":"]),
    ("else", &["", "ELSE", ":", "elsif"]),
    ("pre", &["prev", "last", "PRE"]),
    ("let", &["", "{", "begin"]),
    ("tel", &["", "}", "end", "tel;"]),
    ("--", &["//", "#", "%", "/*"]),
    ("node", &["function", "NODE", "def", "nod"]),
    ("returns", &["return", "->", "RETURNS"]),
    ("var", &["VAR", "let", "local"]),
    ("when", &["if", "WHEN", "every"]),
    ("automaton", &["automat", "AUTOMATON"]),
    ("state", &["STATE", "case"]),
    ("until", &["UNTIL", "when"]),
];

/// Tokens that are inserted as mistakes.
const STRAY: &[&str] = &[
    ";", ",", ")", "(", "--", "//", "#", "%", "[s]", "'", "\"", "->", "=", "not", "pre", "1", "..",
    "let", "tel", "end", "else", "?",
];

fn is_word(b: u8) -> bool {
    b.is_ascii_alphanumeric() || b == b'_' || b == b'.'
}

/// Returns the ranges of the words and operators of a text.
fn words(text: &str) -> Vec<(usize, usize)> {
    let (mut found, bytes) = (Vec::new(), text.as_bytes());
    let mut at = 0;
    while at < bytes.len() {
        let same: fn(u8) -> bool = match bytes[at] {
            b if b.is_ascii_whitespace() => |b| b.is_ascii_whitespace(),
            b if is_word(b) => is_word,
            b'(' | b')' | b'[' | b']' | b';' | b',' => |_| false,
            _ => |b| b"-<>=+*/:?&|!".contains(&b),
        };
        let mut end = at + 1;
        while end < bytes.len() && same(bytes[end]) {
            end += 1;
        }
        if !bytes[at].is_ascii_whitespace() {
            found.push((at, end));
        }
        at = end;
    }
    found
}

/// Returns a text with one mistake.
fn mistaken(text: &str, random: &mut Random) -> String {
    let words = words(text);
    let k = random.below(words.len());
    let (start, end) = words[k];
    let word = &text[start..end];
    let with = |new: &str| format!("{}{new}{}", &text[..start], &text[end..]);
    match random.below(9) {
        0 => with(""),
        1 => with(&format!("{word} {word}")),
        2 => match words.get(k + 1) {
            Some((next, last)) => {
                let (between, other) = (&text[end..*next], &text[*next..*last]);
                format!("{}{other}{between}{word}{}", &text[..start], &text[*last..])
            }
            None => with(""),
        },
        3 => with(&misspelt(word, random)),
        4 => with(&format!("{word} {}", random.pick(STRAY))),
        5 if word.bytes().all(|b| b.is_ascii_digit()) => with(&literal(word, random)),
        _ => match FOREIGN.iter().find(|row| row.0 == word) {
            Some((_, others)) => with(random.pick::<&str>(others)),
            None if word.bytes().all(|b| b.is_ascii_digit()) => with(&literal(word, random)),
            None => with(&misspelt(word, random)),
        },
    }
}

/// Returns a number in the syntax of another language or of another type.
fn literal(word: &str, random: &mut Random) -> String {
    let number: u64 = word.parse().unwrap_or(0);
    match random.below(9) {
        0 => format!("16#{number:X}"),
        1 => format!("2#{number:b}"),
        2 => format!("0b{number:b}"),
        3 => format!("{number}u"),
        4 => format!("{number}L"),
        5 => format!("{number}.0"),
        6 => format!("0x{number:X}"),
        7 => format!("{number} // {number}"),
        _ => format!("T#{number}ms"),
    }
}

/// Returns a word with a character removed, doubled or swapped.
fn misspelt(word: &str, random: &mut Random) -> String {
    let mut letters: Vec<char> = word.chars().collect();
    let k = random.below(letters.len());
    match random.below(3) {
        0 => drop(letters.remove(k)),
        1 => letters.insert(k, letters[k]),
        _ if k > 0 => letters.swap(k - 1, k),
        _ => letters.rotate_left(1),
    }
    letters.into_iter().collect()
}

/// Applies all sure fixes. Returns the text if it has no errors then, and whether it had any before.
fn fixed(text: &str, kind: InputKind) -> Option<(String, bool)> {
    let (mut text, mut had_errors) = (text.to_owned(), None);
    for _ in 0..ROUNDS {
        let found = compile(&input(&text, kind)).ok()?.diagnostics;
        let is_wrong = found.iter().any(|f| f.severity() == Severity::Error);
        had_errors.get_or_insert(is_wrong);
        let edits = sure_edits(&found);
        if edits.is_empty() {
            return (!is_wrong).then(|| (text, had_errors == Some(true)));
        }
        text = apply(&text, edits.iter());
    }
    None
}

/// Returns whether a program with a mistake could be fixed and compared, or a description of the failure.
fn holds(correct: &str, kind: InputKind, random: &mut Random) -> Result<bool, String> {
    let mistaken = mistaken(correct, random);
    let Some((fixed, had_errors)) = fixed(&mistaken, kind).filter(|(text, _)| *text != mistaken)
    else {
        return Ok(false);
    };
    let expected = if had_errors { correct } else { &mistaken };
    let [before, after] = [expected, &fixed].map(|text| CompiledNode::of_kind(text, "main", kind));
    let (Ok(before), Ok(after)) = (before, after) else {
        return Ok(false);
    };
    let rows = before.rows(random, CYCLES);
    let same = before.width() == after.width() && before.run(&rows) == after.run(&rows);
    let difference = || format!("computes something else: fixed\n{fixed}\nmistaken\n{mistaken}");
    same.then_some(true).ok_or_else(difference)
}

/// Returns a correct program.
fn correct(seed: u64) -> (String, InputKind) {
    match seed % 4 {
        0 => (clocked::text(seed, true), InputKind::Lustre),
        1 => (clocked::text(seed, false), InputKind::Rpi),
        _ => (
            program(seed, &mut Counts::default()).0.render(),
            InputKind::Rpi,
        ),
    }
}

#[test]
fn sure_fixes_never_make_another_program() {
    let (programs, first) = (number("RPI_PROGRAMS", PROGRAMS), number("RPI_SEED", SEED));
    let (mut compared, mut wrong) = (0, 0);
    for seed in first..first + programs {
        let (text, kind) = correct(seed);
        let mut random = Random::new(seed);
        for _ in 0..MISTAKES {
            let tried = catch_unwind(AssertUnwindSafe(|| holds(&text, kind, &mut random)));
            let tried = tried.unwrap_or_else(|_| Err("panics: see above".to_owned()));
            match tried {
                Ok(is_compared) => compared += u64::from(is_compared),
                Err(why) => {
                    println!("RPI_SEED={seed} RPI_PROGRAMS=1\n{why}\ncorrect\n{text}");
                    wrong += 1;
                }
            }
        }
    }
    let all = programs * MISTAKES as u64;
    println!("{compared} of {all} fixed and compared");
    assert!(compared > 0 || programs < PROGRAMS, "no fix was tried");
    assert_eq!(wrong, 0, "programs that fixes change");
}
