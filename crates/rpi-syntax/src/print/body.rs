//! Bodies, statements, automata and contracts.

use super::layout::{Doc, concat, group, indent, nothing, text, word};
use super::ty::dotted;
use super::{Printer, parens};
use crate::ast::{self, *};
use crate::text::quote;
use rpi_diag::Span;

impl Printer<'_> {
    /// A head with contract, local declarations and `let ... tel` below it.
    pub(super) fn with_body(
        &mut self,
        head: Doc,
        contract: &Option<Contract>,
        body: &Body,
        end: u32,
    ) -> Doc {
        let between = self.after_head(contract.as_ref(), body, end);
        let contract = self.contract(contract.as_ref());
        concat([head, between, contract, Doc::Hard, self.body(body, end)])
    }

    /// The comments between a head and what follows it.
    fn after_head(&mut self, contract: Option<&Contract>, body: &Body, end: u32) -> Doc {
        let first = contract.map_or_else(|| body.first_span(), |contract| contract.span);
        let limit = if first.is_none() { end } else { first.start };
        let next = self.trivia.next_token(self.trivia.reached());
        self.gap(next.min(limit))
    }

    /// The comments between what was written last and what stands at `next`: at the end of the line, and on lines of their own.
    pub(super) fn gap(&mut self, next: u32) -> Doc {
        let suffixes = self.trivia.after(self.trivia.reached(), next);
        let own = self.trivia.before(next).into_iter();
        let own = own.flat_map(|own| [Doc::Hard, own.doc]);
        concat(suffixes.into_iter().chain(own))
    }

    /// The comments behind a phrase that ends at `end`, on its line.
    fn behind(&mut self, end: u32) -> Doc {
        concat(self.trivia.after(end, self.trivia.next_token(end)))
    }

    /// Local declarations and `let ... tel`, each statement on a line.
    fn body(&mut self, body: &Body, end: u32) -> Doc {
        let locals = self.locals(&body.locals);
        let statements = self.statements(&body.statements, end);
        concat([locals, block("let", statements, "tel")])
    }

    /// The same, on one line if it is short enough.
    fn short_body(&mut self, body: &Body, end: u32) -> Doc {
        let short = body.locals.is_empty()
            && body.statements.len() <= MAX_ON_ONE_LINE
            && !body
                .statements
                .iter()
                .any(|statement| has_body(&statement.kind));
        if !short || self.trivia.any_before(end) {
            return self.body(body, end);
        }
        let statements = body.statements.iter().flat_map(|statement| {
            let doc = self.doc_lines(statement.doc.as_ref());
            [
                Doc::Line,
                doc,
                self.statement(&statement.kind, 0, statement.span),
            ]
        });
        one_line_body(concat(statements.collect::<Vec<_>>()))
    }

    fn locals(&mut self, locals: &[Locals]) -> Doc {
        let sections = locals.iter().flat_map(|section| {
            let section = match section {
                Locals::Var(vars) => {
                    self.section("var", vars, |v| (v.span, &v.doc), Self::var_decl)
                }
                Locals::Const(defs) => {
                    self.section("const", defs, |d| (d.span, &d.doc), Self::const_def)
                }
            };
            [section, Doc::Hard]
        });
        concat(sections.collect::<Vec<_>>())
    }

    /// `var x: int;`, or one declaration on a line of its own each.
    pub(super) fn section<T>(
        &mut self,
        head: &'static str,
        elements: &[T],
        place: impl Fn(&T) -> (Span, &Option<ast::Doc>),
        mut write: impl FnMut(&mut Self, &T) -> Doc,
    ) -> Doc {
        if let [only] = elements
            && !self.trivia.any_before(place(only).0.start)
            && place(only).1.is_none()
        {
            let element = write(self, only);
            let behind = self.behind(place(only).0.end);
            return concat([word(head), word(" "), element, word(";"), behind]);
        }
        let lines = self.open_lines(
            elements,
            |e| place(e).0,
            |p, _, element| (concat([write(p, element), word(";")]), false),
        );
        concat([word(head), indent(concat([Doc::Hard, lines]))])
    }

    pub(super) fn statements(&mut self, statements: &[Statement], end: u32) -> Doc {
        let widths = end_widths(statements);
        self.lines(
            statements,
            |statement| statement.span,
            end,
            |p, i, statement| {
                let doc = p.doc_lines(statement.doc.as_ref());
                let written = p.statement(&statement.kind, widths[i], statement.span);
                (concat([doc, written]), has_body(&statement.kind))
            },
        )
    }

    /// A statement; `width` is that of the first word in a column of ends.
    fn statement(&mut self, kind: &StatementKind, width: usize, span: Span) -> Doc {
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
            StatementKind::Fragment(fragment) => return self.fragment(fragment, span),
            StatementKind::Automaton(automaton) => return self.automaton(automaton, span),
            StatementKind::Choice(choice) => return self.choice(choice, span),
            StatementKind::Keep(keep) => return self.keep(keep, span),
            StatementKind::Broken(_) => return nothing(),
        };
        concat([phrase, word(";")])
    }

    fn equation(&mut self, equation: &Equation) -> Doc {
        let mut parts = Vec::new();
        for (i, target) in equation.targets.iter().enumerate() {
            parts.push(word(if i == 0 { "" } else { ", " }));
            parts.extend([text(&*target.name.name), self.path(&target.path)]);
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

    /// `--%PROPERTY x;` ends with its line; comments in it stand before it.
    fn property(&mut self, claim: &Claim) -> Doc {
        let inside = self.trivia.before(claim.condition.span.end);
        let inside = inside.into_iter().flat_map(|own| [own.doc, Doc::Hard]);
        let before = concat(inside.collect::<Vec<_>>());
        let line = concat([self.claim(claim), word(";")]);
        concat([before, Doc::Flat(Box::new(line))])
    }

    /// Label and condition of a claim.
    pub(super) fn condition(&mut self, claim: &Claim) -> Doc {
        match &claim.label {
            Some(label) => {
                let label = text(format!("{} ", quote(&label.name)));
                concat([label, self.expr(&claim.condition)])
            }
            None => self.wrapped(&claim.condition, parens::begins_with_text(&claim.condition)),
        }
    }

    fn fragment(&mut self, fragment: &FragmentDecl, span: Span) -> Doc {
        let head = self.fragment_head(fragment);
        let between = self.after_head(fragment.contract.as_ref(), &fragment.body, span.end);
        let contract = self.contract(fragment.contract.as_ref());
        concat([
            head,
            between,
            contract,
            Doc::Hard,
            self.short_body(&fragment.body, span.end),
        ])
    }

    fn automaton(&mut self, automaton: &Automaton, span: Span) -> Doc {
        let states = self.lines(
            &automaton.states,
            |s| s.span,
            span.end,
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
        self.trivia.reach(state.name.span.end);
        let parts = [
            self.clause("unless ", &state.unless),
            self.state_body(&state.body),
            self.clause("until ", &state.until),
        ];
        concat([word(head), text(&*state.name.name), indent(concat(parts))])
    }

    fn state_body(&mut self, body: &Body) -> Doc {
        if *body == Body::default() {
            return nothing();
        }
        let gap = self.gap(self.trivia.next_token(self.trivia.reached()));
        let end = self.end_of(body);
        let lines = self.short_body(body, end);
        let behind = self.behind(end + "tel".len() as u32);
        concat([gap, Doc::Hard, lines, behind])
    }

    /// Where the `tel` of the body stands that comes next.
    fn end_of(&self, body: &Body) -> u32 {
        let behind_let = |before| self.trivia.next_token(before) + "let".len() as u32;
        let last = body.statements.last().map(|statement| statement.span.end);
        let last = last.unwrap_or_else(|| {
            let locals = body.locals.iter().rev().find_map(Locals::end);
            behind_let(locals.unwrap_or(self.trivia.reached()))
        });
        self.trivia.next_token(last)
    }

    /// All transitions at one end of a state as one clause: the first that holds is taken, however they are written.
    fn clause(&mut self, head: &'static str, transitions: &[Transition]) -> Doc {
        let [first, ..] = transitions else {
            return nothing();
        };
        let gap = self.gap(first.span.start);
        let alternatives = self.transitions(transitions);
        let last = transitions.last().unwrap_or(first);
        let behind = self.behind(last.span.end);
        concat([gap, Doc::Hard, word(head), alternatives, word(";"), behind])
    }

    fn transitions(&mut self, transitions: &[Transition]) -> Doc {
        self.phrases(
            transitions,
            |t| t.span,
            |p, i, transition| {
                let condition = match &transition.condition {
                    Some(condition) => p.expr(condition),
                    None => word("otherwise"),
                };
                let then = if transition.resumes {
                    " continue "
                } else {
                    " then "
                };
                let target = text(&*transition.target.name);
                concat([
                    word(if i == 0 { "" } else { "| " }),
                    condition,
                    word(then),
                    target,
                ])
            },
        )
    }
}

/// More statements than these are never set on one line.
const MAX_ON_ONE_LINE: usize = 2;

/// `let ... tel` on one line if it is short enough; each statement has a `Line` before it.
pub(super) fn one_line_body(statements: Doc) -> Doc {
    group(concat([
        word("let"),
        indent(statements),
        Doc::Line,
        word("tel"),
    ]))
}

/// Lines between two words.
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

impl Locals {
    /// Where its last declaration ends.
    fn end(&self) -> Option<u32> {
        match self {
            Locals::Var(vars) => vars.last().map(|var| var.span.end),
            Locals::Const(defs) => defs.last().map(|def| def.span.end),
        }
    }
}

impl Body {
    /// Where its first declaration or statement stands; [`Span::NONE`] if there is none.
    fn first_span(&self) -> Span {
        let local = self.locals.iter().find_map(|locals| match locals {
            Locals::Var(vars) => vars.first().map(|var| var.span),
            Locals::Const(defs) => defs.first().map(|def| def.span),
        });
        let statement = || self.statements.first().map(|statement| statement.span);
        local.or_else(statement).unwrap_or(Span::NONE)
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

/// For each statement that ends the command the width of the longest word in its run.
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
    /// The word that begins it.
    fn word(self) -> &'static str {
        match self {
            EndKind::Finish => "finish",
            EndKind::Yield => "yield",
            EndKind::Fail => "fail",
        }
    }
}

impl ClaimKind {
    /// The word that begins it.
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
