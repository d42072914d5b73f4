//! Random edits of program texts, as a user makes them: letters, lines, declarations, names.

use std::ops::Range;

/// Sequence of numbers that is the same in each run (xorshift; Marsaglia, 2003).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Returns a number below `bound`, which must not be 0.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % bound
    }

    fn choose<'c, T>(&mut self, all: &'c [T]) -> &'c T {
        &all[self.below(all.len())]
    }
}

/// Texts that are inserted: parts of tokens, brackets without a partner, whole statements and declarations.
const INSERTIONS: &[&str] = &[
    "x",
    "1",
    " ",
    "\n",
    ";",
    ",",
    "(",
    ")",
    "[",
    "]",
    "<<",
    ">>",
    "\"",
    "--",
    "--| Text.\n",
    "/*",
    "*/",
    "(*",
    "*)",
    "//",
    "#",
    "%",
    "=",
    ":=",
    "==",
    "->",
    "|",
    ".",
    "§",
    "0.5[mm]",
    "2 bar",
    "tel",
    "let",
    "tel\n",
    " let ",
    "end",
    "node ",
    "const ",
    "type ",
    "check ",
    "last ",
    "pre ",
    "if ",
    " then ",
    "none",
    "use motion;\n",
    "use timers, logic;\n",
    "\nnode extra (x: int) returns (y: int) let y = x + 1; tel\n",
    "\nconst extra: int = 3;\n",
    "\ntype Extra = enum { A, B };\n",
    "\nnode check (x: bool) returns (y: bool) let y = x; tel\n",
    "\nfunction ex",
    "\ncommand C (arm: Arm) let",
    "\n  y = x;\n",
    "\n  unused = 1;\n",
    "\n  assert 1 > 2;\n",
    "\ntest \"t\" let check 1 = 1; tel\n",
    "--| See [`extra`].\n",
    "given ",
    "when true",
];

type Edit = fn(&str, &mut Random) -> String;

/// Kinds of edits. Those of single letters are as frequent as all others together.
const EDITS: &[Edit] = &[
    insert,
    insert,
    insert,
    delete_letters,
    delete_letters,
    replace_letter,
    delete_lines,
    repeat_line,
    swap_lines,
    delete_declaration,
    copy_declaration,
    rename,
    break_number,
];

/// Returns the text after a random edit.
pub(crate) fn edit(text: &str, random: &mut Random) -> String {
    let edit = random.choose(EDITS);
    edit(text, random)
}

fn position(text: &str, random: &mut Random) -> usize {
    let mut at = random.below(text.len() + 1);
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

fn replaced(text: &str, range: Range<usize>, new: &str) -> String {
    format!("{}{new}{}", &text[..range.start], &text[range.end..])
}

fn insert(text: &str, random: &mut Random) -> String {
    let at = position(text, random);
    let new = *random.choose(INSERTIONS);
    replaced(text, at..at, new)
}

fn letters(text: &str, random: &mut Random) -> Range<usize> {
    let start = position(text, random);
    let length = 1 + random.below(4);
    let end = text[start..].char_indices().nth(length);
    start..end.map_or(text.len(), |(at, _)| start + at)
}

fn delete_letters(text: &str, random: &mut Random) -> String {
    replaced(text, letters(text, random), "")
}

fn replace_letter(text: &str, random: &mut Random) -> String {
    let range = letters(text, random);
    let new = *random.choose(INSERTIONS);
    replaced(text, range, new)
}

/// Returns the bytes of a random line, with its line break.
fn line(text: &str, random: &mut Random) -> Range<usize> {
    let at = position(text, random);
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let end = text[at..].find('\n').map_or(text.len(), |end| at + end + 1);
    start..end
}

fn delete_lines(text: &str, random: &mut Random) -> String {
    replaced(text, line(text, random), "")
}

fn repeat_line(text: &str, random: &mut Random) -> String {
    let (from, to) = (line(text, random), line(text, random));
    replaced(text, to.start..to.start, &text[from])
}

fn swap_lines(text: &str, random: &mut Random) -> String {
    let first = line(text, random);
    let rest = &text[first.end..];
    let end = rest.find('\n').map_or(rest.len(), |end| end + 1);
    let both = format!("{}{}", &rest[..end], &text[first.clone()]);
    replaced(text, first.start..first.end + end, &both)
}

/// Returns the bytes from the line after an empty line to the next empty line, which is often a declaration.
fn declaration(text: &str, random: &mut Random) -> Range<usize> {
    let at = position(text, random);
    let start = text[..at].rfind("\n\n").map_or(0, |end| end + 1);
    let end = text[at..]
        .find("\n\n")
        .map_or(text.len(), |end| at + end + 1);
    start..end
}

fn delete_declaration(text: &str, random: &mut Random) -> String {
    replaced(text, declaration(text, random), "")
}

fn copy_declaration(text: &str, random: &mut Random) -> String {
    let copied = declaration(text, random);
    let to = declaration(text, random).start;
    replaced(text, to..to, &text[copied])
}

/// Renames a word in the whole text, or at one place only.
fn rename(text: &str, random: &mut Random) -> String {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words: Vec<&str> = text
        .split(|c| !is_part(c))
        .filter(|word| !word.is_empty())
        .collect();
    if words.is_empty() {
        return text.to_owned();
    }
    let (word, new) = (*random.choose(&words), *random.choose(&words));
    let new = if random.below(2) == 0 {
        format!("{new}_2")
    } else {
        new.to_owned()
    };
    match random.below(3) {
        0 => text.replace(word, &new),
        _ => text.replacen(word, &new, 1),
    }
}

/// Inserts a digit behind a digit, so that a constant, a size or a unit changes.
fn break_number(text: &str, random: &mut Random) -> String {
    let digits: Vec<usize> = text
        .match_indices(|c: char| c.is_ascii_digit())
        .map(|(at, _)| at)
        .collect();
    if digits.is_empty() {
        return insert(text, random);
    }
    let at = *random.choose(&digits);
    replaced(text, at..at + 1, ["0", "7", "12", "1.5"][random.below(4)])
}
