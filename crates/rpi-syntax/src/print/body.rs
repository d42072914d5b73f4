//! Printing of bodies, statements and automata.

use super::blocks;
use super::contract;
use super::decl;
use super::expr;
use super::layout::{Doc, concat, empty, group, indent, text, word};
use super::list;
use super::ty;
use super::ty::dotted;
use super::{Printer, parens};
use crate::ast::{self, *};
use crate::string_literal::quote;
use rpi_diag::Span;

/// Prints a declaration: the header `head`, and below it the contract, the local declarations and `let ... tel`.
pub(super) fn with_body(
    printer: &Printer<'_>,
    head: Doc,
    contract: &Option<Contract>,
    body: &Body,
) -> Doc {
    let contract = contract::print_contract(printer, contract.as_ref());
    concat([head, contract, Doc::HardLine, print_body(printer, body)])
}

/// Prints local declarations and `let ... tel`, with each statement on its own line.
fn print_body(printer: &Printer<'_>, body: &Body) -> Doc {
    let locals = print_locals(printer, &body.locals);
    let statements = print_statements(printer, &body.statements);
    concat([locals, block("let", statements, "tel")])
}

/// Prints a body on one line if it has no local declarations and few simple statements, else like [`print_body`].
fn short_body(printer: &Printer<'_>, body: &Body) -> Doc {
    let short = body.locals.is_empty()
        && body.statements.len() <= MAX_ON_ONE_LINE
        && !body
            .statements
            .iter()
            .any(|statement| has_body(&statement.kind));
    if !short {
        return print_body(printer, body);
    }
    let statements = body.statements.iter().flat_map(|statement| {
        let doc = list::doc_lines(printer, statement.doc.as_ref());
        [Doc::Line, doc, print_statement(printer, &statement.kind, 0)]
    });
    one_line_body(concat(statements.collect::<Vec<_>>()))
}

fn print_locals(printer: &Printer<'_>, locals: &[Locals]) -> Doc {
    let sections = locals.iter().flat_map(|section| {
        let section = match section {
            Locals::Var(vars) => {
                print_section(printer, "var", vars, |v| v.span, |v| &v.doc, ty::var_decl)
            }
            Locals::Const(defs) => print_section(
                printer,
                "const",
                defs,
                |d| d.span,
                |d| &d.doc,
                ty::const_def,
            ),
        };
        [section, Doc::HardLine]
    });
    concat(sections.collect::<Vec<_>>())
}

/// Prints a section of declarations: `var x: int;` on one line, or several declarations with one per line. `head` is
/// the keyword of the section.
pub(super) fn print_section<T>(
    printer: &Printer<'_>,
    head: &'static str,
    elements: &[T],
    span: impl Fn(&T) -> Span,
    doc: impl Fn(&T) -> &Option<ast::Doc>,
    mut write: impl FnMut(&Printer, &T) -> Doc,
) -> Doc {
    if let [only] = elements
        && doc(only).is_none()
    {
        let element = write(printer, only);
        return concat([word(head), word(" "), element, word(";")]);
    }
    let lines = list::print_lines(printer, elements, span, |p, _, element| {
        (concat([write(p, element), word(";")]), false)
    });
    concat([word(head), indent(concat([Doc::HardLine, lines]))])
}

pub(super) fn print_statements(printer: &Printer<'_>, statements: &[Statement]) -> Doc {
    let widths = result_keyword_widths(statements);
    list::print_lines(
        printer,
        statements,
        |statement| statement.span,
        |p, i, statement| {
            let doc = list::doc_lines(p, statement.doc.as_ref());
            let written = print_statement(p, &statement.kind, widths[i]);
            (concat([doc, written]), has_body(&statement.kind))
        },
    )
}

/// Prints a statement. `width` is the number of characters to which `finish`, `yield` and `fail` in adjacent statements
/// are padded.
fn print_statement(printer: &Printer<'_>, kind: &StatementKind, width: usize) -> Doc {
    let phrase = match kind {
        StatementKind::Equation(equation) => print_equation(printer, equation),
        StatementKind::Call(call) => expr::print_expr(printer, call),
        StatementKind::Claim(claim) if claim.kind == ClaimKind::Property => {
            return property(printer, claim);
        }
        StatementKind::Claim(claim) => print_claim(printer, claim),
        StatementKind::CommandEnd(end) => {
            let head = format!("{:width$} {} when ", end.kind.keyword(), end.result.name);
            concat([text(head), expr::print_expr(printer, &end.condition)])
        }
        StatementKind::Export(flows) => {
            let flows: Vec<String> = flows.iter().map(dotted).collect();
            text(format!("export {}", flows.join(", ")))
        }
        StatementKind::Fragment(fragment) => return print_fragment(printer, fragment),
        StatementKind::Automaton(automaton) => return print_automaton(printer, automaton),
        StatementKind::Conditional(choice) => return blocks::print_choice(printer, choice),
        StatementKind::FrameBlock(keep) => return blocks::print_keep(printer, keep),
        StatementKind::Error(_) => return empty(),
    };
    concat([phrase, word(";")])
}

fn print_equation(printer: &Printer<'_>, equation: &Equation) -> Doc {
    let mut parts = Vec::new();
    for (i, target) in equation.targets.iter().enumerate() {
        parts.push(word(if i == 0 { "" } else { ", " }));
        parts.extend([
            ty::print_name(printer, &target.name),
            expr::print_path(printer, &target.path),
        ]);
    }
    if parts.is_empty() {
        parts.push(word("()"));
    }
    parts.extend([word(" = "), expr::print_expr(printer, &equation.value)]);
    concat(parts)
}

pub(super) fn print_claim(printer: &Printer<'_>, claim: &Claim) -> Doc {
    let condition = print_condition(printer, claim);
    let provided = claim.provided.as_ref();
    let provided = provided.map_or_else(empty, |when| {
        concat([word(" provided "), expr::print_expr(printer, when)])
    });
    concat([word(claim.kind.keyword()), word(" "), condition, provided])
}

/// Prints a property in a comment, `--%PROPERTY x;`, which extends to the end of its line. Comments inside it are
/// printed before it.
fn property(printer: &Printer<'_>, claim: &Claim) -> Doc {
    let line = concat([print_claim(printer, claim), word(";")]);
    Doc::Flat(Box::new(line))
}

/// Prints the optional label and the condition of a claim.
pub(super) fn print_condition(printer: &Printer<'_>, claim: &Claim) -> Doc {
    match &claim.label {
        Some(label) => {
            let label = text(format!("{} ", quote(&label.name)));
            concat([label, expr::print_expr(printer, &claim.condition)])
        }
        None => expr::wrapped(
            printer,
            &claim.condition,
            parens::begins_with_text(&claim.condition),
        ),
    }
}

fn print_fragment(printer: &Printer<'_>, fragment: &FragmentDecl) -> Doc {
    let head = decl::fragment_head(printer, fragment);
    let contract = contract::print_contract(printer, fragment.contract.as_ref());
    concat([
        head,
        contract,
        Doc::HardLine,
        short_body(printer, &fragment.body),
    ])
}

fn print_automaton(printer: &Printer<'_>, automaton: &Automaton) -> Doc {
    let states = list::print_lines(
        printer,
        &automaton.states,
        |s| s.span,
        |p, _, state| {
            let doc = list::doc_lines(p, state.doc.as_ref());
            (concat([doc, print_state(p, state)]), false)
        },
    );
    block("automaton", states, "end")
}

fn print_state(printer: &Printer<'_>, state: &State) -> Doc {
    let head = if state.is_initial {
        "initial state "
    } else {
        "state "
    };
    let parts = [
        clause(printer, "unless ", &state.unless),
        state_body(printer, &state.body),
        clause(printer, "until ", &state.until),
    ];
    concat([
        word(head),
        ty::print_name(printer, &state.name),
        indent(concat(parts)),
    ])
}

fn state_body(printer: &Printer<'_>, body: &Body) -> Doc {
    if *body == Body::default() {
        return empty();
    }
    concat([Doc::HardLine, short_body(printer, body)])
}

/// Prints transitions of one state as one clause. `head` is its keyword: `unless` for strong transitions, `until` for
/// weak ones.
// Several clauses and one clause with alternatives mean the same: the first transition that holds is taken.
fn clause(printer: &Printer<'_>, head: &'static str, transitions: &[Transition]) -> Doc {
    if transitions.is_empty() {
        return empty();
    }
    let alternatives = print_transitions(printer, transitions);
    concat([Doc::HardLine, word(head), alternatives, word(";")])
}

fn print_transitions(printer: &Printer<'_>, transitions: &[Transition]) -> Doc {
    list::print_phrases(printer, transitions, |p, i, transition| {
        let condition = match &transition.condition {
            Some(condition) => expr::print_expr(p, condition),
            None => word("otherwise"),
        };
        let then = if transition.resumes {
            " continue "
        } else {
            " then "
        };
        let target = ty::print_name(p, &transition.target);
        concat([
            word(if i == 0 { "" } else { "| " }),
            condition,
            word(then),
            target,
        ])
    })
}

/// Maximum number of statements that a body on one line may have.
const MAX_ON_ONE_LINE: usize = 2;

/// Prints `let ... tel` on one line if it fits, else on several. Each document in `statements` begins with a
/// [`Doc::Line`].
pub(super) fn one_line_body(statements: Doc) -> Doc {
    group(concat([
        word("let"),
        indent(statements),
        Doc::Line,
        word("tel"),
    ]))
}

/// Prints indented lines between the keywords `open` and `close`.
pub(super) fn block(open: &'static str, lines: Doc, close: &'static str) -> Doc {
    match lines.is_empty() {
        true => concat([word(open), Doc::HardLine, word(close)]),
        false => concat([
            word(open),
            indent(concat([Doc::HardLine, lines])),
            Doc::HardLine,
            word(close),
        ]),
    }
}

fn has_body(kind: &StatementKind) -> bool {
    matches!(
        kind,
        StatementKind::Fragment(_)
            | StatementKind::Automaton(_)
            | StatementKind::Conditional(_)
            | StatementKind::FrameBlock(_)
    )
}

/// Returns for each statement the width in characters of the longest keyword among adjacent `finish`, `yield` and
/// `fail` statements; 0 for other statements.
fn result_keyword_widths(statements: &[Statement]) -> Vec<usize> {
    let width = |statement: &Statement| match &statement.kind {
        StatementKind::CommandEnd(end) => end.kind.keyword().len(),
        _ => 0,
    };
    let both_end = |a: &Statement, b: &Statement| width(a) > 0 && width(b) > 0;
    let runs = statements.chunk_by(both_end);
    let widths = runs.flat_map(|run| {
        let longest = run.iter().map(width).max().unwrap_or(0);
        std::iter::repeat_n(longest, run.len())
    });
    widths.collect()
}

impl CommandEndKind {
    /// Returns the keyword that begins the statement.
    fn keyword(self) -> &'static str {
        match self {
            CommandEndKind::Finish => "finish",
            CommandEndKind::Yield => "yield",
            CommandEndKind::Fail => "fail",
        }
    }
}

impl ClaimKind {
    /// Returns the keyword that begins the claim.
    fn keyword(self) -> &'static str {
        match self {
            ClaimKind::Assert => "assert",
            ClaimKind::Check => "check",
            ClaimKind::Property => "--%PROPERTY",
            ClaimKind::Assume => "assume",
            ClaimKind::Guarantee => "guarantee",
        }
    }
}
