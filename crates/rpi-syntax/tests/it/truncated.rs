//! Every prefix and suffix of every program, and every program with a word deleted or doubled, gets a tree.

use crate::support::programs;
use rpi_diag::FileId;
use rpi_syntax::{Parens, dump_ast, parse};

#[test]
fn no_prefix_panics() {
    for program in programs() {
        for end in (0..program.text.len()).filter(|at| program.text.is_char_boundary(*at)) {
            let prefix = &program.text[..end];
            let parsed = parse(FileId(0), prefix, program.mode);
            places_are_in_order(&parsed, prefix);
        }
    }
}

#[test]
fn no_suffix_panics() {
    for program in programs() {
        for start in (0..program.text.len())
            .step_by(3)
            .filter(|at| program.text.is_char_boundary(*at))
        {
            let suffix = &program.text[start..];
            places_are_in_order(&parse(FileId(0), suffix, program.mode), suffix);
        }
    }
}

#[test]
fn a_missing_or_doubled_word_leaves_a_tree() {
    for program in programs() {
        let words: Vec<&str> = program
            .text
            .split_inclusive([' ', '\n', ';', '(', ')'])
            .collect();
        for at in 0..words.len() {
            let missing = [&words[..at], &words[at + 1..]].concat().concat();
            let doubled = [&words[..at + 1], &words[at..]].concat().concat();
            for text in [missing, doubled] {
                let parsed = parse(FileId(0), &text, program.mode);
                places_are_in_order(&parsed, &text);
                dump_ast(&parsed.file, Parens::Keep);
            }
        }
    }
}

/// Checks that diagnostics lie in the text and in text order, and that declarations do not overlap.
fn places_are_in_order(parsed: &rpi_syntax::Parse, text: &str) {
    for diagnostic in &parsed.diagnostics {
        for label in &diagnostic.labels {
            let (start, end) = (label.span.start as usize, label.span.end as usize);
            assert!(
                text.get(start..end).is_some(),
                "{diagnostic:?} lies outside of\n{text}"
            );
        }
    }
    assert!(
        parsed
            .diagnostics
            .is_sorted_by_key(rpi_diag::Diagnostic::span)
    );
    for pair in parsed.file.items.windows(2) {
        assert!(pair[0].span.end <= pair[1].span.start, "{text}");
    }
}
