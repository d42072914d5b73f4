//! Printing of expressions.

use super::call;
use super::layout::{Doc, concat, group, indent, text, word};
use super::list;
use super::list::{CURLY, PARENS, SQUARE, brackets};
use super::ty;
use super::{Printer, parens};
use crate::ast::*;
use crate::ops::{PRECEDENCE_PRIMARY, UnaryOp};
use crate::print::infix;
use crate::string_literal::quote;
use rpi_diag::Span;

pub(super) fn print_expr(printer: &Printer<'_>, expr: &Expr) -> Doc {
    match &expr.kind {
        ExprKind::Bool(value) => {
            printer.mark_offset(expr.span, word(if *value { "true" } else { "false" }))
        }
        ExprKind::Number(number) => printer.mark_offset(expr.span, text(&*number.text)),
        ExprKind::Quantity(quantity) => printer.mark_offset(expr.span, print_quantity(quantity)),
        ExprKind::Str(content) => printer.mark_offset(expr.span, text(quote(content))),
        ExprKind::Name(name) => printer.mark_offset(expr.span, text(&**name)),
        ExprKind::Field(field) => print_field(printer, field),
        ExprKind::Index(index) => print_index(printer, index),
        ExprKind::Slice(slice) => slice_of(printer, slice),
        ExprKind::BitRange(of) => bits(printer, of),
        ExprKind::Unary(op, operand) => unary(printer, *op, operand),
        ExprKind::Binary(binary) => infix::chain(printer, binary),
        ExprKind::When(when) => print_when(printer, when),
        ExprKind::If(conditional) => infix::print_conditional(printer, conditional),
        ExprKind::Call(call) => call::print_call(printer, call),
        ExprKind::BoolList(among, elements) => print_among(printer, *among, elements),
        ExprKind::Merge(merge) => print_merge(printer, merge),
        ExprKind::Paren(inner) => paren(printer, inner),
        ExprKind::Tuple(elements) => {
            list::print_list(printer, PARENS, elements, |e| e.span, print_expr)
        }
        ExprKind::Array(elements) => {
            list::print_list(printer, SQUARE, elements, |e| e.span, print_expr)
        }
        ExprKind::Quantified(of) => print_quantified(printer, of),
        ExprKind::Ascription(of) => print_ascribed(printer, of),
        ExprKind::ConstructorTest(of) => print_is_a(printer, of),
        ExprKind::Match(of) => match_expr(printer, of),
        ExprKind::EmptySet(types) => concat([word("{}"), call::type_args(printer, "@<", types)]),
        ExprKind::Struct(value) => struct_expr(printer, value),
        ExprKind::Update(update) => print_update(printer, update),
    }
}

fn print_quantified(printer: &Printer<'_>, of: &Quantified) -> Doc {
    concat([
        word(if of.is_forall { "forall " } else { "exists " }),
        ty::print_ports(printer, &of.vars),
        word(" "),
        print_expr(printer, &of.condition),
    ])
}

fn print_ascribed(printer: &Printer<'_>, of: &Ascription) -> Doc {
    concat([
        word("("),
        print_expr(printer, &of.value),
        word(": "),
        ty::print_ty(printer, &of.ty),
        word(")"),
    ])
}

fn print_is_a(printer: &Printer<'_>, of: &ConstructorTest) -> Doc {
    concat([
        ty::print_name(printer, &of.constructor),
        word("?("),
        print_expr(printer, &of.value),
        word(")"),
    ])
}

/// Prints an expression, in parentheses if `needed` is true.
pub(super) fn wrapped(printer: &Printer<'_>, expr: &Expr, needed: bool) -> Doc {
    match needed {
        true => paren(printer, expr),
        false => print_expr(printer, expr),
    }
}

fn paren(printer: &Printer<'_>, inner: &Expr) -> Doc {
    let inner = print_expr(printer, inner);
    group(concat([
        word("("),
        indent(concat([Doc::SoftLine, inner])),
        Doc::SoftLine,
        word(")"),
    ]))
}

fn print_quantity(quantity: &Quantity) -> Doc {
    let number = text(&*quantity.number.text);
    match quantity.unit.is_percent() {
        true => concat([number, word("%")]),
        false => concat([number, word("["), ty::print_unit(&quantity.unit), word("]")]),
    }
}

fn print_base(printer: &Printer<'_>, base: &Expr) -> Doc {
    wrapped(printer, base, parens::base(base))
}

fn print_field(printer: &Printer<'_>, field: &Field) -> Doc {
    concat([
        print_base(printer, &field.base),
        word("."),
        ty::print_name(printer, &field.field),
    ])
}

fn print_index(printer: &Printer<'_>, index: &Index) -> Doc {
    concat([
        print_base(printer, &index.base),
        word("["),
        print_expr(printer, &index.index),
        word("]"),
    ])
}

fn bits(printer: &Printer<'_>, of: &BitRange) -> Doc {
    let [high, low] = [&of.high, &of.low].map(|bound| print_expr(printer, bound));
    concat([
        print_base(printer, &of.base),
        word("["),
        high,
        word(":"),
        low,
        word("]"),
    ])
}

fn slice_of(printer: &Printer<'_>, of: &SliceExpr) -> Doc {
    concat([
        print_base(printer, &of.base),
        word("["),
        print_slice(printer, &of.slice),
        word("]"),
    ])
}

pub(super) fn print_slice(printer: &Printer<'_>, slice: &SliceBounds) -> Doc {
    // `1.` directly before `..` would be lexed as three dots.
    let ends_in_dot = matches!(&slice.from.kind, ExprKind::Number(n) if n.text.ends_with('.'));
    let apart = ends_in_dot || parens::level(&slice.from) < PRECEDENCE_PRIMARY;
    let dots = word(if apart { " .. " } else { ".." });
    let mut parts = vec![
        print_expr(printer, &slice.from),
        dots,
        print_expr(printer, &slice.to),
    ];
    if let Some(step) = &slice.step {
        parts.extend([word(" step "), print_expr(printer, step)]);
    }
    concat(parts)
}

fn unary(printer: &Printer<'_>, op: UnaryOp, operand: &Expr) -> Doc {
    let space = if op == UnaryOp::Neg { "" } else { " " };
    let needed = parens::operand(op, operand);
    concat([
        word(op.spelling()),
        word(space),
        wrapped(printer, operand, needed),
    ])
}

/// Prints an array that repeats one value: `x^3`.
pub(crate) fn array_repeat(printer: &Printer<'_>, binary: &Binary) -> Doc {
    let element = wrapped(printer, &binary.lhs, parens::left(binary.op, &binary.lhs));
    let size = wrapped(printer, &binary.rhs, parens::right(binary.op, &binary.rhs));
    concat([element, word("^"), size])
}

fn print_when(printer: &Printer<'_>, when: &WhenExpr) -> Doc {
    let value = wrapped(printer, &when.value, parens::sampled(&when.value));
    concat([value, word(" when "), print_clock(printer, &when.clock)])
}

pub(super) fn print_clock(printer: &Printer<'_>, clock: &Clock) -> Doc {
    let flow = ty::print_name(printer, &clock.flow);
    match &clock.value {
        ClockValue::True => flow,
        ClockValue::False => concat([word("not "), flow]),
        ClockValue::Value(value) => {
            concat([ty::print_name(printer, value), word("("), flow, word(")")])
        }
    }
}

fn print_among(printer: &Printer<'_>, among: BoolListOp, elements: &[Expr]) -> Doc {
    let head = match among {
        BoolListOp::AtMostOne => "#",
        BoolListOp::Nor => "nor",
    };
    concat([
        word(head),
        list::print_list(printer, PARENS, elements, |e| e.span, print_expr),
    ])
}

fn print_merge(printer: &Printer<'_>, merge: &Merge) -> Doc {
    match (&merge.selector.kind, &merge.cases[..]) {
        (ExprKind::Name(name), cases) if !name.is_qualified() => {
            let cases = cases
                .iter()
                .flat_map(|case| [Doc::Line, merge_case(printer, case)]);
            let cases = concat(cases.collect::<Vec<_>>());
            group(concat([
                word("merge "),
                print_expr(printer, &merge.selector),
                indent(cases),
            ]))
        }
        (_, cases) => {
            let on = print_expr(printer, &merge.selector);
            let rest = cases
                .iter()
                .flat_map(|case| [word("; "), print_expr(printer, &case.then)]);
            concat([
                word("merge("),
                on,
                concat(rest.collect::<Vec<_>>()),
                word(")"),
            ])
        }
    }
}

fn merge_case(printer: &Printer<'_>, case: &MergeCase) -> Doc {
    let value = ty::print_name(printer, &case.value);
    concat([
        word("("),
        value,
        word(" -> "),
        print_expr(printer, &case.then),
        word(")"),
    ])
}

fn struct_expr(printer: &Printer<'_>, value: &StructExpr) -> Doc {
    let statics = call::type_args(printer, "@<", &value.statics);
    let name = concat([ty::print_name(printer, &value.ty), statics]);
    let field = |p: &Printer, field: &FieldValue| field_value(p, field);
    let Some(base) = &value.base else {
        let fields = list::print_list(printer, CURLY, &value.fields, field_span, field);
        return concat([name, fields]);
    };
    let base = concat([word("{"), print_base(printer, base), word(" with")]);
    let after_base = brackets(" ", ";", "}");
    concat([
        name,
        base,
        list::print_list(printer, after_base, &value.fields, field_span, field),
    ])
}

fn match_expr(printer: &Printer<'_>, of: &Match) -> Doc {
    let head = concat([
        word("match "),
        print_expr(printer, &of.value),
        word(" with"),
    ]);
    let arms = of.arms.iter().flat_map(|arm| {
        let pattern = text(format!("| {}: ", pattern(&arm.pattern)));
        [Doc::Line, pattern, print_expr(printer, &arm.then)]
    });
    let arms = indent(concat(arms.collect::<Vec<_>>()));
    group(concat([head, arms, Doc::Line, word("end")]))
}

fn field_value(printer: &Printer<'_>, field: &FieldValue) -> Doc {
    concat([
        ty::print_name(printer, &field.field),
        word(" = "),
        print_expr(printer, &field.value),
    ])
}

/// Prints an update of elements in the syntax of Kind 2: `a[0 := x; 1 := y]`.
fn keyed_update(printer: &Printer<'_>, update: &Update) -> Doc {
    let base = print_base(printer, &update.base);
    let key = |change: &Change| match &change.path[..] {
        [Access::Index(key)] => key.span.merge(change.value.span),
        _ => Span::NONE,
    };
    let changes = list::print_list(
        printer,
        brackets("[", ";", "]"),
        &update.changes,
        key,
        |p, change| {
            let key = match &change.path[..] {
                [Access::Index(key)] => print_expr(p, key),
                path => print_path(p, path),
            };
            concat([key, word(" := "), print_expr(p, &change.value)])
        },
    );
    concat([base, changes])
}

fn print_update(printer: &Printer<'_>, update: &Update) -> Doc {
    if update.is_keyed {
        return keyed_update(printer, update);
    }
    let base = concat([word("("), print_expr(printer, &update.base), word(" with")]);
    let after_base = brackets(" ", ";", ")");
    // A change begins with `.` or `[`, which has no span in the tree.
    let nowhere = |_: &Change| Span::NONE;
    let changes = list::print_list(
        printer,
        after_base,
        &update.changes,
        nowhere,
        |p, change| {
            concat([
                print_path(p, &change.path),
                word(" = "),
                print_expr(p, &change.value),
            ])
        },
    );
    concat([base, changes])
}

/// Prints a path of fields, indices and slices: `.f[1]`.
pub(super) fn print_path(printer: &Printer<'_>, path: &[Access]) -> Doc {
    let steps = path.iter().map(|access| match access {
        Access::Field(field) => concat([word("."), ty::print_name(printer, field)]),
        Access::Index(index) => concat([word("["), print_expr(printer, index), word("]")]),
        Access::Slice(slice) => concat([word("["), print_slice(printer, slice), word("]")]),
    });
    concat(steps.collect::<Vec<_>>())
}

/// Returns the text of a pattern of a `match` arm: `B(x, C(y))`.
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
