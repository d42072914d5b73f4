//! Tests of operator precedence and associativity.

use crate::support::{dump_without_parens, parse_clean};
use rpi_diag::FileId;
use rpi_syntax::ops::{Associativity, BINARY, UNARY, UnaryOp, UnaryOpInfo};
use rpi_syntax::{Dialect, parse, print};

/// Returns the dump of an expression's tree, without the program around it.
fn tree(expr: &str) -> String {
    let text = format!("const x = {expr};");
    let dump = dump_without_parens(&parse_clean(&text, Dialect::Rpi).file);
    let flat = dump.split_whitespace().collect::<Vec<_>>().join(" ");
    let inner = flat.strip_prefix("(const (def (names x) (value ");
    inner
        .and_then(|inner| inner.strip_suffix(")))"))
        .unwrap_or(&flat)
        .to_owned()
}

#[track_caller]
fn same(expr: &str, with_parens: &str) {
    assert_eq!(tree(expr), tree(with_parens), "{expr} is not {with_parens}");
}

#[test]
fn levels_are_those_of_lustre_v6() {
    same("a -> b | c -> d", "(a -> b) | (c -> d)");
    same("a => b -> c", "(a => b) -> c");
    same("a or b => c", "(a or b) => c");
    same("a and b or c and d", "(a and b) or (c and d)");
    same("a = b and c < d", "(a = b) and (c < d)");
    same("not a = b", "(not a) = b");
    same("not a + b", "not (a + b)");
    same("a + b * c", "a + (b * c)");
    same("a * b ** c", "a * (b ** c)");
    same("x + y when c", "x + (y when c)");
    same("-x when c", "(-x) when c");
    same("pre x + y", "(pre x) + y");
    same("-x^3", "-(x^3)");
    same("pre x fby y", "pre (x fby y)");
    same("x fby y^3", "(x fby y)^3");
    same("x fby a.b[1]", "x fby ((a.b)[1])");
    same("current pre -x", "current (pre (-x))");
}

#[test]
fn coalescing_is_weaker_than_comparison_and_logic() {
    same("predecessor = C.r ?? false", "(predecessor = C.r) ?? false");
    same("a or b ?? c", "(a or b) ?? c");
    same("a.x ?? b.x ?? still", "a.x ?? (b.x ?? still)");
    same("0 -> pre x ?? 0", "0 -> ((pre x) ?? 0)");
    same("a => b ?? c", "(a => b) ?? c");
    same("if c then a else b ?? d", "if c then a else (b ?? d)");
}

#[test]
fn equals_group_to_the_left_but_for_a_few() {
    same("a - b - c", "(a - b) - c");
    same("a / b * c", "(a / b) * c");
    same("a ** b ** c", "(a ** b) ** c");
    same("a^2^3", "(a^2)^3");
    same("a -> b -> c", "a -> (b -> c)");
    same("a => b => c", "a => (b => c)");
    same("a fby b fby c", "a fby (b fby c)");
}

#[test]
fn a_word_before_an_operand_takes_all_that_binds_more_strongly() {
    same("a * not b + c", "a * (not (b + c))");
    same(
        "a + if c then x else y + z",
        "a + (if c then x else (y + z))",
    );
    same("0 fby pre x + 1", "(0 fby (pre x)) + 1");
    same("0 fby -1", "0 fby (-1)");
    same(
        "if a then b else if c then d else e",
        "if a then b else (if c then d else e)",
    );
    same(
        "not if a then b else c and d",
        "not (if a then b else (c and d))",
    );
}

#[test]
fn every_pair_of_operators_groups_by_the_table() {
    let both = || BINARY.iter().filter(|row| !row.only_lustre);
    for first in both() {
        for second in both() {
            let chain = format!("a {} b {} c", first.spelling, second.spelling);
            let left = first.precedence > second.precedence
                || first.precedence == second.precedence
                    && first.associativity == Associativity::Left;
            let grouped = match left {
                true => format!("(a {} b) {} c", first.spelling, second.spelling),
                false => format!("a {} (b {} c)", first.spelling, second.spelling),
            };
            if first.precedence == second.precedence && first.associativity == Associativity::None {
                let text = format!("const x = {chain};");
                let diagnostics = parse(FileId(0), &text, Dialect::Rpi).diagnostics;
                assert_eq!(diagnostics.len(), 1, "{chain}");
                assert_eq!(diagnostics[0].code.as_str(), "RPI0009");
            } else {
                same(&chain, &grouped);
            }
        }
    }
}

#[test]
fn every_unary_operator_groups_by_the_table() {
    // `last` applies to names only; before a bracket it is a name itself.
    let plain = |unary: &&UnaryOpInfo| unary.op != UnaryOp::Last && !unary.only_lustre;
    for unary in UNARY.iter().filter(plain) {
        for binary in BINARY.iter().filter(|row| !row.only_lustre) {
            let chain = format!("{} a {} b", unary.spelling, binary.spelling);
            let grouped = match unary.precedence > binary.precedence {
                true => format!("({} a) {} b", unary.spelling, binary.spelling),
                false => format!("{} (a {} b)", unary.spelling, binary.spelling),
            };
            same(&chain, &grouped);
        }
    }
}

#[test]
fn printing_sets_the_parentheses_that_are_needed() {
    for expr in [
        "(a + b) * c",
        "a - (b - c)",
        "(a -> b) -> c",
        "(a * not b) + c",
        "(if a then b else c) + d",
        "-(-x)",
        "(-x)^3",
        "(a + b).c",
        "(a + b)[1]",
        "(a < b) = c",
        "(x + y) when c",
        "(a fby b).c",
        "-(-x + y)",
        "-(-x when c)",
    ] {
        let text = format!("const x = {expr};\n");
        let mut file = parse_clean(&text, Dialect::Rpi).file;
        super::generated_trees::strip_parens(&mut file);
        let printed = print(&file, Dialect::Rpi);
        assert_eq!(
            dump_without_parens(&parse_clean(&printed, Dialect::Rpi).file),
            dump_without_parens(&file),
            "{printed}"
        );
        assert_eq!(
            printed.matches('(').count(),
            text.matches('(').count(),
            "{printed}"
        );
    }
}
