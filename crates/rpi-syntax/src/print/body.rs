//! Printing of bodies, statements and automata.

use super::layout::{Doc, concat, group, indent, nothing, text, word};
use super::ty::dotted;
use super::{Printer, parens};
use crate::ast::{self, *};
use crate::text::quote;
use rpi_diag::Span;

impl Printer<'_> {
    /// Prints a header with its contract, local declarations and `let ... tel` below it.
    pub(super) fn with_body(&mut self, head: Doc, contract: &Option<Contract>, body: &Body) -> Doc {
        let contract = self.contract(contract.as_ref());
        concat([head, contract, Doc::Hard, self.body(body)])
    }

    /// Prints local declarations and `let ... tel`, with each statement on its own line.
    fn body(&mut self, body: &Body) -> Doc {
        let locals = self.locals(&body.locals);
        let statements = self.statements(&body.statements);
        concat([locals, block("let", statements, "tel")])
    }

    /// Prints a body on one line if it is short enough.
    fn short_body(&mut self, body: &Body) -> Doc {
        let short = body.locals.is_empty()
            && body.statements.len() <= MAX_ON_ONE_LINE
            && !body
                .statements
                .iter()
                .any(|statement| has_body(&statement.kind));
        if !short {
            return self.body(body);
        }
        let statements = body.statements.iter().flat_map(|statement| {
            let doc = self.doc_lines(statement.doc.as_ref());
            [Doc::Line, doc, self.statement(&statement.kind, 0)]
        });
        one_line_body(concat(statements.collect::<Vec<_>>()))
    }

    fn locals(&mut self, locals: &[Locals]) -> Doc {
        let sections = locals.iter().flat_map(|section| {
            let section = match section {
                Locals::Var(vars) => {
                    self.section("var", vars, |v| v.span, |v| &v.doc, Self::var_decl)
                }
                Locals::Const(defs) => {
                    self.section("const", defs, |d| d.span, |d| &d.doc, Self::const_def)
                }
            };
            [section, Doc::Hard]
        });
        concat(sections.collect::<Vec<_>>())
    }

    /// Prints a section of declarations: `var x: int;`, or several declarations on a line each.
    pub(super) fn section<T>(
        &mut self,
        head: &'static str,
        elements: &[T],
        span: impl Fn(&T) -> Span,
        doc: impl Fn(&T) -> &Option<ast::Doc>,
        mut write: impl FnMut(&mut Self, &T) -> Doc,
    ) -> Doc {
        if let [only] = elements
            && doc(only).is_none()
        {
            let element = write(self, only);
            return concat([word(head), word(" "), element, word(";")]);
        }
        let lines = self.lines(elements, span, |p, _, element| {
            (concat([write(p, element), word(";")]), false)
        });
        concat([word(head), indent(concat([Doc::Hard, lines]))])
    }

    pub(super) fn statements(&mut self, statements: &[Statement]) -> Doc {
        let widths = end_widths(statements);
        self.lines(
            statements,
            |statement| statement.span,
            |p, i, statement| {
                let doc = p.doc_lines(statement.doc.as_ref());
                let written = p.statement(&statement.kind, widths[i]);
                (concat([doc, written]), has_body(&statement.kind))
            },
        )
    }

    /// Prints a statement. `width` is the column width of `finish`, `yield` and `fail` in adjacent statements.
    fn statement(&mut self, kind: &StatementKind, width: usize) -> Doc {
        let phrase = match kind {
            StatementKind::Equation(equation) => self.equation(equation),
            StatementKind::Call(call) => self.expr(call),
            StatementKind::Claim(claim) if claim.kind == ClaimKind::Property => {
                return self.property(claim);
            }
            StatementKind::Claim(claim) => self.claim(claim),
            StatementKind::End(end) => {
                let head = format!("{:width$} {} when ", end.kind.word(), end.result.name);
                concat([text(head), self.expr(&end.condition)])
            }
            StatementKind::Export(flows) => {
                let flows: Vec<String> = flows.iter().map(dotted).collect();
                text(format!("export {}", flows.join(", ")))
            }
            StatementKind::Fragment(fragment) => return self.fragment(fragment),
            StatementKind::Automaton(automaton) => return self.automaton(automaton),
            StatementKind::Choice(choice) => return self.choice(choice),
            StatementKind::Keep(keep) => return self.keep(keep),
            StatementKind::Broken(_) => return nothing(),
        };
        concat([phrase, word(";")])
    }

    fn equation(&mut self, equation: &Equation) -> Doc {
        let mut parts = Vec::new();
        for (i, target) in equation.targets.iter().enumerate() {
            parts.push(word(if i == 0 { "" } else { ", " }));
            parts.extend([self.name(&target.name), self.path(&target.path)]);
        }
        if parts.is_empty() {
            parts.push(word("()"));
        }
        parts.extend([word(" = "), self.expr(&equation.value)]);
        concat(parts)
    }

    pub(super) fn claim(&mut self, claim: &Claim) -> Doc {
        let condition = self.condition(claim);
        let provided = claim.provided.as_ref();
        let provided = provided.map_or_else(nothing, |when| {
            concat([word(" provided "), self.expr(when)])
        });
        concat([word(claim.kind.word()), word(" "), condition, provided])
    }

    /// Prints `--%PROPERTY x;`, which ends with its line. Comments within it are moved before it.
    fn property(&mut self, claim: &Claim) -> Doc {
        let line = concat([self.claim(claim), word(";")]);
        Doc::Flat(Box::new(line))
    }

    /// Prints the label and condition of a claim.
    pub(super) fn condition(&mut self, claim: &Claim) -> Doc {
        match &claim.label {
            Some(label) => {
                let label = text(format!("{} ", quote(&label.name)));
                concat([label, self.expr(&claim.condition)])
            }
            None => self.wrapped(&claim.condition, parens::begins_with_text(&claim.condition)),
        }
    }

    fn fragment(&mut self, fragment: &FragmentDecl) -> Doc {
        let head = self.fragment_head(fragment);
        let contract = self.contract(fragment.contract.as_ref());
        concat([head, contract, Doc::Hard, self.short_body(&fragment.body)])
    }

    fn automaton(&mut self, automaton: &Automaton) -> Doc {
        let states = self.lines(
            &automaton.states,
            |s| s.span,
            |p, _, state| {
                let doc = p.doc_lines(state.doc.as_ref());
                (concat([doc, p.state(state)]), false)
            },
        );
        block("automaton", states, "end")
    }

    fn state(&mut self, state: &State) -> Doc {
        let head = if state.initial {
            "initial state "
        } else {
            "state "
        };
        let parts = [
            self.clause("unless ", &state.unless),
            self.state_body(&state.body),
            self.clause("until ", &state.until),
        ];
        concat([word(head), self.name(&state.name), indent(concat(parts))])
    }

    fn state_body(&mut self, body: &Body) -> Doc {
        if *body == Body::default() {
            return nothing();
        }
        concat([Doc::Hard, self.short_body(body)])
    }

    /// Prints all strong or all weak transitions of a state as one clause.
    // Several clauses and one clause with alternatives mean the same: the first transition that holds is taken.
    fn clause(&mut self, head: &'static str, transitions: &[Transition]) -> Doc {
        if transitions.is_empty() {
            return nothing();
        }
        let alternatives = self.transitions(transitions);
        concat([Doc::Hard, word(head), alternatives, word(";")])
    }

    fn transitions(&mut self, transitions: &[Transition]) -> Doc {
        self.phrases(transitions, |p, i, transition| {
            let condition = match &transition.condition {
                Some(condition) => p.expr(condition),
                None => word("otherwise"),
            };
            let then = if transition.resumes {
                " continue "
            } else {
                " then "
            };
            let target = p.name(&transition.target);
            concat([
                word(if i == 0 { "" } else { "| " }),
                condition,
                word(then),
                target,
            ])
        })
    }
}

/// Maximum number of statements of a body on one line.
const MAX_ON_ONE_LINE: usize = 2;

/// Prints `let ... tel` on one line if it fits. Each statement has a `Line` before it.
pub(super) fn one_line_body(statements: Doc) -> Doc {
    group(concat([
        word("let"),
        indent(statements),
        Doc::Line,
        word("tel"),
    ]))
}

/// Prints indented lines between two keywords.
pub(super) fn block(open: &'static str, lines: Doc, close: &'static str) -> Doc {
    match lines.is_nothing() {
        true => concat([word(open), Doc::Hard, word(close)]),
        false => concat([
            word(open),
            indent(concat([Doc::Hard, lines])),
            Doc::Hard,
            word(close),
        ]),
    }
}

fn has_body(kind: &StatementKind) -> bool {
    matches!(
        kind,
        StatementKind::Fragment(_)
            | StatementKind::Automaton(_)
            | StatementKind::Choice(_)
            | StatementKind::Keep(_)
    )
}

/// Returns for each statement the longest keyword width among adjacent `finish`, `yield` and `fail` statements, or 0.
fn end_widths(statements: &[Statement]) -> Vec<usize> {
    let width = |statement: &Statement| match &statement.kind {
        StatementKind::End(end) => end.kind.word().len(),
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

impl EndKind {
    /// Returns the keyword of the statement.
    fn word(self) -> &'static str {
        match self {
            EndKind::Finish => "finish",
            EndKind::Yield => "yield",
            EndKind::Fail => "fail",
        }
    }
}

impl ClaimKind {
    /// Returns the keyword of the claim.
    fn word(self) -> &'static str {
        match self {
            ClaimKind::Assert => "assert",
            ClaimKind::Check => "check",
            ClaimKind::Property => "--%PROPERTY",
            ClaimKind::Assume => "assume",
            ClaimKind::Guarantee => "guarantee",
        }
    }
}
