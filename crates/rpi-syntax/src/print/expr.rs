//! Printing of expressions.

use super::layout::{Doc, concat, group, indent, text, word};
use super::list::{CURLY, PARENS, SQUARE, brackets};
use super::{Printer, parens};
use crate::ast::*;
use crate::ops::{BinaryOp, Grouping, LEVEL_PRIMARY, UnaryOp};
use crate::text::quote;
use rpi_diag::Span;

impl Printer<'_> {
    pub(super) fn expr(&mut self, expr: &Expr) -> Doc {
        match &expr.kind {
            ExprKind::Bool(value) => {
                self.part(expr.span, word(if *value { "true" } else { "false" }))
            }
            ExprKind::Number(number) => self.part(expr.span, text(&*number.text)),
            ExprKind::Quantity(quantity) => self.part(expr.span, self.quantity(quantity)),
            ExprKind::Str(content) => self.part(expr.span, text(quote(content))),
            ExprKind::Name(name) => self.part(expr.span, text(&**name)),
            ExprKind::Field(field) => self.field(field),
            ExprKind::Index(index) => self.index(index),
            ExprKind::Slice(slice) => self.slice_of(slice),
            ExprKind::Bits(of) => self.bits(of),
            ExprKind::Unary(op, operand) => self.unary(*op, operand),
            ExprKind::Binary(binary) => self.chain(binary),
            ExprKind::When(when) => self.when(when),
            ExprKind::If(conditional) => self.conditional(conditional),
            ExprKind::Call(call) => self.call(call),
            ExprKind::Among(among, elements) => self.among(*among, elements),
            ExprKind::Merge(merge) => self.merge(merge),
            ExprKind::Paren(inner) => self.paren(inner),
            ExprKind::Tuple(elements) => self.list(PARENS, elements, |e| e.span, Self::expr),
            ExprKind::Array(elements) => self.list(SQUARE, elements, |e| e.span, Self::expr),
            ExprKind::Quantified(of) => {
                let head = word(if of.for_all { "forall " } else { "exists " });
                concat([
                    head,
                    self.ports(&of.vars),
                    word(" "),
                    self.expr(&of.condition),
                ])
            }
            ExprKind::Ascribed(of) => {
                let value = self.expr(&of.value);
                concat([word("("), value, word(": "), self.ty(&of.ty), word(")")])
            }
            ExprKind::IsA(of) => {
                let value = self.expr(&of.value);
                concat([self.name(&of.constructor), word("?("), value, word(")")])
            }
            ExprKind::Match(of) => self.match_expr(of),
            ExprKind::EmptySet(types) => concat([word("{}"), self.type_args("@<", types)]),
            ExprKind::Struct(value) => self.struct_expr(value),
            ExprKind::Update(update) => self.update(update),
        }
    }

    /// Prints an expression, in parentheses if `needed`.
    pub(super) fn wrapped(&mut self, expr: &Expr, needed: bool) -> Doc {
        match needed {
            true => self.paren(expr),
            false => self.expr(expr),
        }
    }

    fn paren(&mut self, inner: &Expr) -> Doc {
        let inner = self.expr(inner);
        group(concat([
            word("("),
            indent(concat([Doc::Soft, inner])),
            Doc::Soft,
            word(")"),
        ]))
    }

    fn quantity(&self, quantity: &Quantity) -> Doc {
        let number = text(&*quantity.number.text);
        match quantity.unit.is_percent() {
            true => concat([number, word("%")]),
            false => concat([number, word("["), self.unit(&quantity.unit), word("]")]),
        }
    }

    fn base(&mut self, base: &Expr) -> Doc {
        self.wrapped(base, parens::base(base))
    }

    fn field(&mut self, field: &Field) -> Doc {
        concat([self.base(&field.base), word("."), self.name(&field.field)])
    }

    fn index(&mut self, index: &Index) -> Doc {
        concat([
            self.base(&index.base),
            word("["),
            self.expr(&index.index),
            word("]"),
        ])
    }

    fn bits(&mut self, of: &Bits) -> Doc {
        let [high, low] = [&of.high, &of.low].map(|bound| self.expr(bound));
        concat([
            self.base(&of.base),
            word("["),
            high,
            word(":"),
            low,
            word("]"),
        ])
    }

    fn slice_of(&mut self, of: &SliceOf) -> Doc {
        concat([
            self.base(&of.base),
            word("["),
            self.slice(&of.slice),
            word("]"),
        ])
    }

    pub(super) fn slice(&mut self, slice: &Slice) -> Doc {
        // `1.` directly before `..` would be lexed as three dots.
        let ends_in_dot = matches!(&slice.from.kind, ExprKind::Number(n) if n.text.ends_with('.'));
        let apart = ends_in_dot || parens::level(&slice.from) < LEVEL_PRIMARY;
        let dots = word(if apart { " .. " } else { ".." });
        let mut parts = vec![self.expr(&slice.from), dots, self.expr(&slice.to)];
        if let Some(step) = &slice.step {
            parts.extend([word(" step "), self.expr(step)]);
        }
        concat(parts)
    }

    fn unary(&mut self, op: UnaryOp, operand: &Expr) -> Doc {
        let space = if op == UnaryOp::Neg { "" } else { " " };
        let needed = parens::operand(op, operand);
        concat([
            word(op.spelling()),
            word(space),
            self.wrapped(operand, needed),
        ])
    }

    /// Prints a chain of operators of one precedence level, `a and b and c`. Lines break at all operators or at none.
    fn chain(&mut self, binary: &Binary) -> Doc {
        if binary.op == BinaryOp::Repeat {
            return self.repeated(binary);
        }
        let links = links(binary);
        self.phrases(&links, |p, _, link| {
            let operand = p.wrapped(link.operand, link.parens);
            match link.op {
                Some(op) => concat([word(op.spelling()), word(" "), operand]),
                None => operand,
            }
        })
    }

    /// Prints an array of repeated elements: `x^3`.
    fn repeated(&mut self, binary: &Binary) -> Doc {
        let element = self.wrapped(&binary.lhs, parens::left(binary.op, &binary.lhs));
        let size = self.wrapped(&binary.rhs, parens::right(binary.op, &binary.rhs));
        concat([element, word("^"), size])
    }

    fn when(&mut self, when: &When) -> Doc {
        let value = self.wrapped(&when.value, parens::sampled(&when.value));
        concat([value, word(" when "), self.clock(&when.clock)])
    }

    pub(super) fn clock(&mut self, clock: &Clock) -> Doc {
        let flow = self.name(&clock.flow);
        match &clock.tick {
            Tick::True => flow,
            Tick::False => concat([word("not "), flow]),
            Tick::Value(value) => concat([self.name(value), word("("), flow, word(")")]),
        }
    }

    /// Prints `if a then x else if b then y else z`. Lines break at all branches or at none.
    fn conditional(&mut self, conditional: &If) -> Doc {
        let branches = branches(conditional);
        self.phrases(&branches, |p, _, branch| match branch {
            Alternative::If {
                head,
                condition,
                yes,
            } => concat([word(head), p.expr(condition), word(" then "), p.expr(yes)]),
            Alternative::Else(no) => concat([word("else "), p.expr(no)]),
        })
    }

    fn among(&mut self, among: Among, elements: &[Expr]) -> Doc {
        let head = match among {
            Among::AtMostOne => "#",
            Among::Nor => "nor",
        };
        concat([
            word(head),
            self.list(PARENS, elements, |e| e.span, Self::expr),
        ])
    }

    fn merge(&mut self, merge: &Merge) -> Doc {
        match (&merge.on.kind, &merge.cases[..]) {
            (ExprKind::Name(name), cases) if !name.is_qualified() => {
                let cases = cases
                    .iter()
                    .flat_map(|case| [Doc::Line, self.merge_case(case)]);
                let cases = concat(cases.collect::<Vec<_>>());
                group(concat([
                    word("merge "),
                    self.expr(&merge.on),
                    indent(cases),
                ]))
            }
            (_, cases) => {
                let on = self.expr(&merge.on);
                let rest = cases
                    .iter()
                    .flat_map(|case| [word("; "), self.expr(&case.then)]);
                concat([
                    word("merge("),
                    on,
                    concat(rest.collect::<Vec<_>>()),
                    word(")"),
                ])
            }
        }
    }

    fn merge_case(&mut self, case: &MergeCase) -> Doc {
        let value = self.name(&case.value);
        concat([
            word("("),
            value,
            word(" -> "),
            self.expr(&case.then),
            word(")"),
        ])
    }

    fn struct_expr(&mut self, value: &StructExpr) -> Doc {
        let statics = self.type_args("@<", &value.statics);
        let name = concat([self.name(&value.ty), statics]);
        let field = |p: &mut Self, field: &FieldValue| p.field_value(field);
        let Some(base) = &value.base else {
            let fields = self.list(CURLY, &value.fields, field_span, field);
            return concat([name, fields]);
        };
        let base = concat([word("{"), self.base(base), word(" with")]);
        let after_base = brackets(" ", ";", "}");
        concat([
            name,
            base,
            self.list(after_base, &value.fields, field_span, field),
        ])
    }

    fn match_expr(&mut self, of: &Match) -> Doc {
        let head = concat([word("match "), self.expr(&of.value), word(" with")]);
        let arms = of.arms.iter().flat_map(|arm| {
            let pattern = text(format!("| {}: ", pattern(&arm.pattern)));
            [Doc::Line, pattern, self.expr(&arm.then)]
        });
        let arms = indent(concat(arms.collect::<Vec<_>>()));
        group(concat([head, arms, Doc::Line, word("end")]))
    }

    fn field_value(&mut self, field: &FieldValue) -> Doc {
        concat([
            self.name(&field.field),
            word(" = "),
            self.expr(&field.value),
        ])
    }

    /// Prints an update in the syntax of Kind 2: `a[0 := x; 1 := y]`.
    fn keyed(&mut self, update: &Update) -> Doc {
        let base = self.base(&update.base);
        let key = |change: &Change| match &change.path[..] {
            [Access::Index(key)] => key.span.merge(change.value.span),
            _ => Span::NONE,
        };
        let changes = self.list(
            brackets("[", ";", "]"),
            &update.changes,
            key,
            |p, change| {
                let key = match &change.path[..] {
                    [Access::Index(key)] => p.expr(key),
                    path => p.path(path),
                };
                concat([key, word(" := "), p.expr(&change.value)])
            },
        );
        concat([base, changes])
    }

    fn update(&mut self, update: &Update) -> Doc {
        if update.is_keyed {
            return self.keyed(update);
        }
        let base = concat([word("("), self.expr(&update.base), word(" with")]);
        let after_base = brackets(" ", ";", ")");
        // A change begins with `.` or `[`, which has no span in the tree.
        let nowhere = |_: &Change| Span::NONE;
        let changes = self.list(after_base, &update.changes, nowhere, |p, change| {
            concat([p.path(&change.path), word(" = "), p.expr(&change.value)])
        });
        concat([base, changes])
    }

    /// Prints a path of fields, indices and slices: `.f[1]`.
    pub(super) fn path(&mut self, path: &[Access]) -> Doc {
        let steps = path.iter().map(|access| match access {
            Access::Field(field) => concat([word("."), self.name(field)]),
            Access::Index(index) => concat([word("["), self.expr(index), word("]")]),
            Access::Slice(slice) => concat([word("["), self.slice(slice), word("]")]),
        });
        concat(steps.collect::<Vec<_>>())
    }
}

/// Returns the text of a pattern: `B(x, C(y))`.
fn pattern(of: &Pattern) -> String {
    let parts: Vec<String> = of.parts.iter().map(pattern).collect();
    match &parts[..] {
        [] => of.name.name.to_string(),
        all => format!("{}({})", of.name.name, all.join(", ")),
    }
}

fn field_span(field: &FieldValue) -> Span {
    field.field.span.merge(field.value.span)
}

/// Operand of a chain, with the operator before it.
struct Link<'e> {
    op: Option<BinaryOp>,
    operand: &'e Expr,
    parens: bool,
}

/// Returns the operands of a chain of operators of one precedence level.
fn links(binary: &Binary) -> Vec<Link<'_>> {
    match binary.op.grouping() {
        Grouping::Right => links_to_right(binary),
        Grouping::Left | Grouping::None => links_to_left(binary),
    }
}

fn links_to_left(mut binary: &Binary) -> Vec<Link<'_>> {
    let mut links = Vec::new();
    loop {
        let (op, lhs) = (binary.op, &binary.lhs);
        links.push(Link {
            op: Some(op),
            operand: &binary.rhs,
            parens: parens::right(op, &binary.rhs),
        });
        match &lhs.kind {
            ExprKind::Binary(inner) if inner.op.level() == op.level() && !parens::left(op, lhs) => {
                binary = inner
            }
            _ => {
                let parens = parens::left(op, lhs);
                links.push(Link {
                    op: None,
                    operand: lhs,
                    parens,
                });
                links.reverse();
                return links;
            }
        }
    }
}

fn links_to_right(mut binary: &Binary) -> Vec<Link<'_>> {
    let mut links = Vec::new();
    let mut before = None;
    loop {
        let (op, rhs) = (binary.op, &binary.rhs);
        let parens = parens::left(op, &binary.lhs);
        links.push(Link {
            op: before,
            operand: &binary.lhs,
            parens,
        });
        before = Some(op);
        match &rhs.kind {
            ExprKind::Binary(inner) if inner.op.level() == op.level() => binary = inner,
            _ => {
                let parens = parens::right(op, rhs);
                links.push(Link {
                    op: before,
                    operand: rhs,
                    parens,
                });
                return links;
            }
        }
    }
}

/// Branch of a chain of conditional expressions.
enum Alternative<'e> {
    If {
        head: &'static str,
        condition: &'e Expr,
        yes: &'e Expr,
    },
    Else(&'e Expr),
}

fn branches(mut conditional: &If) -> Vec<Alternative<'_>> {
    let mut branches = Vec::new();
    loop {
        branches.push(Alternative::If {
            head: match (branches.is_empty(), conditional.is_static) {
                (true, false) => "if ",
                (true, true) => "with ",
                (false, false) => "else if ",
                (false, true) => "else with ",
            },
            condition: &conditional.condition,
            yes: &conditional.yes,
        });
        match &conditional.no.kind {
            ExprKind::If(inner) => conditional = inner,
            _ => {
                branches.push(Alternative::Else(&conditional.no));
                return branches;
            }
        }
    }
}
