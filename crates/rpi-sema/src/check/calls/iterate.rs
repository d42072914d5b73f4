//! Iterators over arrays. They are expanded to one call per element.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::arg_tuples;
use crate::check::calls::args::CallArgument;
use crate::check::calls::call;
use crate::check::calls::callable::Callable;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::access::leaf_count;
use crate::check::exprs::compose;
use crate::check::exprs::ops;
use crate::check::limits::nesting;
use crate::check::signatures::callable_args;
use crate::check::types::consts;
use crate::program::Program;
use crate::ty::{Member, Ty};
use crate::typed::{Activation, TypedKind};
use crate::typed::{ExprId, Leaf};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_net::prim;
use rpi_syntax::ast::{StaticArg, StaticValue};
use rpi_syntax::ops::BinaryOp;
use std::rc::Rc;

/// Names of the operators that apply a node along arrays. A declaration with one of these names hides the operator.
pub(crate) const ITERATORS: &[&str] = &[
    "map", "red", "fold", "fill", "fillred", "mapfold", "boolred", "condact",
];

/// Pattern by which an iterator applies its callee along arrays.
#[derive(Clone, Copy, PartialEq, Debug)]
enum IteratorKind {
    /// Applies the callee to each element separately (`map`).
    Map,
    /// Passes an accumulator through the calls (`red`, `fill`, `fillred`); each call may also read an element and
    /// produce an element.
    Fold,
    /// Tests whether the number of true elements is at least the first and at most the second bound (`boolred`).
    Count(i64, i64),
}

/// Iterator with its static arguments: the callee that is applied to the elements (`None` for `boolred`), and the size
/// of the arrays.
#[derive(Clone, Debug)]
pub(crate) struct IteratorCall {
    name: &'static str,
    kind: IteratorKind,
    callee: Option<Callable>,
    size: u32,
}

impl IteratorCall {
    /// Returns the iterator with its static arguments, as in `map<<f; 3>>`, for messages.
    pub(crate) fn name(&self, program: &Program<'_>) -> String {
        let size = self.size;
        match (&self.callee, self.kind) {
            (Some(callee), _) => format!("{}<<{}; {size}>>", self.name, callee.name(program)),
            (None, IteratorKind::Count(least, most)) => {
                format!("{}<<{least}; {most}; {size}>>", self.name)
            }
            (None, _) => format!("{}<<{size}>>", self.name),
        }
    }

    /// Appends text that distinguishes this iterator from all other callables, for the keys under which checked
    /// instances are stored.
    pub(crate) fn write_key(&self, key: &mut String) {
        key.push_str(self.name);
        key.push_str("<<");
        if let Some(callee) = &self.callee {
            callee.write_key(key);
        }
        key.push_str(&format!("; {}; {:?}>>", self.size, self.kind));
    }

    /// Returns the callable that is applied to each element; `None` for `boolred`.
    pub(crate) fn resolve_callee(&self) -> Option<&Callable> {
        self.callee.as_ref()
    }

    /// Returns the type of port `place` of the iterator. `of_callee` is the type of the callee's port at the same
    /// place, which is the type of one element or, for port 0 of `fold`, of the accumulator.
    pub(crate) fn port_type(&self, place: usize, of_callee: &Ty) -> Ty {
        match self.kind {
            IteratorKind::Fold if place == 0 => of_callee.clone(),
            _ => Ty::Array(Rc::new(of_callee.clone()), self.size),
        }
    }
}

/// Resolves the static arguments of the iterator `name`: the callee and the size of the arrays. Returns `None` after an
/// error.
pub(crate) fn resolve_iterator<'a>(
    cx: &mut Body<'_, 'a>,
    name: &'static str,
    statics: &'a [StaticArg],
    span: Span,
) -> Option<IteratorCall> {
    match (name, statics) {
        ("boolred", [least, most, size]) => {
            let bounds = (static_int_arg(cx, least)?, static_int_arg(cx, most)?);
            let n = static_size_arg(cx, size)?;
            check_boolred_bounds(cx, bounds, n, [least, most])?;
            Some(IteratorCall {
                name,
                kind: IteratorKind::Count(bounds.0, bounds.1),
                callee: None,
                size: n,
            })
        }
        ("map" | "red" | "fold" | "fill" | "fillred" | "mapfold", [callee, size]) => {
            let way = if name == "map" {
                IteratorKind::Map
            } else {
                IteratorKind::Fold
            };
            Some(IteratorCall {
                name,
                kind: way,
                callee: Some(callable_args::static_callee(cx, callee)?),
                size: static_size_arg(cx, size)?,
            })
        }
        _ => {
            let form = match name {
                "boolred" => "boolred<<least; most; size>>(array)".to_owned(),
                _ => format!("{name}<<node; size>>(...)"),
            };
            let diagnostic = Diagnostic::new(
                Code::RPI1010,
                format!("wrong number of static arguments of `{name}`"),
            )
            .primary(span, "wrong number of arguments")
            .help(format!("write `{form}`"));
            report::report_diagnostic(cx, diagnostic);
            None
        }
    }
}

/// Checks that 0 <= `least` <= `most` <= `n` for `boolred<<least; most; n>>`, as Lustre V6 does. Reports a violation at
/// the static arguments `args` and returns `None`.
fn check_boolred_bounds(
    cx: &mut Body<'_, '_>,
    (least, most): (i64, i64),
    n: u32,
    args: [&StaticArg; 2],
) -> Option<()> {
    let (arg, text) = match (least, most) {
        _ if least < 0 => (args[0], format!("{least} is less than 0")),
        _ if most > n.into() => (args[1], format!("{most} is greater than the size {n}")),
        _ if least > most => (args[0], format!("{least} is greater than {most}")),
        _ => return Some(()),
    };
    let message = "`boolred<<least; most; size>>` requires 0 <= least <= most <= size";
    report::report_diagnostic(
        cx,
        Diagnostic::new(Code::RPI2009, message)
            .primary(arg.span, text)
            .help("write how many elements must be true, at least and at most, then the size"),
    );
    None
}

fn static_int_arg<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<i64> {
    match &arg.value {
        StaticValue::Expr(expr) => consts::const_integer(cx, expr),
        _ => {
            let diagnostic = Diagnostic::new(Code::RPI1010, "an integer is expected here")
                .primary(arg.span, "not an integer");
            report::report_diagnostic(cx, diagnostic);
            None
        }
    }
}

fn static_size_arg<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<u32> {
    match &arg.value {
        StaticValue::Expr(expr) => compose::const_size(cx, expr),
        _ => static_int_arg(cx, arg).and_then(|n| u32::try_from(n).ok()),
    }
}

/// Checks the application of an iterator to arguments that have been checked, and returns its typed expression.
pub(crate) fn apply_iterator<'a>(
    cx: &mut Body<'_, 'a>,
    iteration: &IteratorCall,
    given: &[CallArgument<'a>],
    span: Span,
) -> ExprId {
    let given = arg_tuples::flatten_tuple_args(cx, given.to_vec());
    let values: Vec<ExprId> = given.iter().map(|arg| arg.value).collect();
    match (iteration.kind, &iteration.callee) {
        (IteratorKind::Map, Some(callee)) => map_arrays(cx, callee, &values, iteration.size, span),
        (IteratorKind::Fold, Some(callee)) => {
            fold_arrays(cx, callee, &values, iteration.size, span)
        }
        (IteratorKind::Count(least, most), _) => {
            count_true(cx, least, most, &values, iteration.size, span)
        }
        _ => cx.error_expr(span),
    }
}

/// Adds an expression for element `k` of each array, and returns these expressions. Reports an array whose size is not
/// `n` and returns `None`.
fn elements_at(cx: &mut Body<'_, '_>, arrays: &[ExprId], k: u32, n: u32) -> Option<Vec<ExprId>> {
    let place = arrays
        .first()
        .map_or(Span::NONE, |array| cx.span_of(*array));
    if !nesting::may_expand(cx, place) {
        return None;
    }
    let mut elements = Vec::with_capacity(arrays.len());
    for array in arrays {
        let span = cx.span_of(*array);
        match cx.ty_of(*array).clone() {
            Ty::Array(element, m) if m == n => {
                let at = k * leaf_count(&element);
                elements.push(cx.add(
                    TypedKind::Part { base: *array, at },
                    (*element).clone(),
                    span,
                ));
            }
            Ty::Unknown => return None,
            ty => {
                let diagnostic = Diagnostic::new(
                    Code::RPI2009,
                    format!(
                        "expected an array of {}, found `{ty}`",
                        rpi_diag::with_noun(n, "element")
                    ),
                )
                .primary(span, format!("this is `{ty}`"));
                report::report_diagnostic(cx, diagnostic);
                return None;
            }
        }
    }
    Some(elements)
}

/// Adds a call of the callee for one element and returns its outputs, one expression for each.
fn call_element(
    cx: &mut Body<'_, '_>,
    callee: &Callable,
    args: Vec<ExprId>,
    span: Span,
) -> Vec<ExprId> {
    let given = args.into_iter().map(CallArgument::positional).collect();
    let result = call::call_callable(cx, callee, given, Activation::Always, span);
    match cx.ty_of(result) {
        Ty::Tuple(_) => arg_tuples::tuple_elements(cx, result),
        _ => vec![result],
    }
}

/// Checks `map`: applies the callee to each of the `n` elements of the arrays. Returns the array, or the tuple of
/// arrays, of the results.
fn map_arrays(
    cx: &mut Body<'_, '_>,
    callee: &Callable,
    arrays: &[ExprId],
    n: u32,
    span: Span,
) -> ExprId {
    let mut columns: Vec<Vec<ExprId>> = Vec::new();
    for k in 0..n {
        let Some(elements) = elements_at(cx, arrays, k, n) else {
            return cx.error_expr(span);
        };
        let results = call_element(cx, callee, elements, span);
        push_row(&mut columns, &results);
    }
    let arrays: Vec<ExprId> = columns
        .into_iter()
        .map(|c| collect_column(cx, &c, span))
        .collect();
    one_or_tuple(cx, arrays, span)
}

/// Checks `fill`, `red` (`fold`) and `fillred` (`mapfold`), which differ only in the ports of the callee. The first of
/// `values` is the initial accumulator; the others are arrays of `n` elements. Returns the last accumulator, in a tuple
/// with the arrays of further results if there are any.
fn fold_arrays(
    cx: &mut Body<'_, '_>,
    callee: &Callable,
    values: &[ExprId],
    n: u32,
    span: Span,
) -> ExprId {
    let Some((first, arrays)) = values.split_first() else {
        let diagnostic = Diagnostic::new(Code::RPI1010, "missing initial value of the accumulator")
            .primary(span, "expected an argument");
        return cx.report_error_expr(diagnostic, span);
    };
    let mut accumulator = *first;
    let mut columns: Vec<Vec<ExprId>> = Vec::new();
    for k in 0..n {
        let Some(elements) = elements_at(cx, arrays, k, n) else {
            return cx.error_expr(span);
        };
        let args = std::iter::once(accumulator).chain(elements).collect();
        let results = call_element(cx, callee, args, span);
        let Some((next, rest)) = results.split_first() else {
            return cx.error_expr(span);
        };
        accumulator = *next;
        push_row(&mut columns, rest);
    }
    let mut results = vec![accumulator];
    results.extend(columns.iter().map(|c| collect_column(cx, c, span)));
    one_or_tuple(cx, results, span)
}

/// Adds an array of the values that one output of the callee has for all elements, and returns it.
fn collect_column(cx: &mut Body<'_, '_>, elements: &[ExprId], span: Span) -> ExprId {
    let n = u32::try_from(elements.len()).unwrap_or(u32::MAX);
    let element = elements
        .first()
        .map_or(Ty::Unknown, |id| cx.ty_of(*id).clone());
    compose::add_array(
        cx,
        TypedKind::Build(elements.into()),
        Rc::new(element),
        n,
        span,
    )
}

/// Returns the value itself if there is only one, else a new tuple expression of all values.
fn one_or_tuple(cx: &mut Body<'_, '_>, values: Vec<ExprId>, span: Span) -> ExprId {
    if let [one] = values[..] {
        return one;
    }
    let member = |ty| Member { name: None, ty };
    let members = values
        .iter()
        .map(|id| member(cx.ty_of(*id).clone()))
        .collect();
    cx.add(TypedKind::Build(values.into()), Ty::Tuple(members), span)
}

/// Checks `boolred<<least; most; n>>(a)` and returns a Boolean expression: whether at least `least` and at most `most`
/// of the `n` elements are true.
fn count_true(
    cx: &mut Body<'_, '_>,
    least: i64,
    most: i64,
    values: &[ExprId],
    n: u32,
    span: Span,
) -> ExprId {
    let [array] = values else {
        let diagnostic = Diagnostic::new(Code::RPI1010, "`boolred` takes one array")
            .primary(span, "wrong number of arguments");
        return cx.report_error_expr(diagnostic, span);
    };
    let mut total = cx.add(TypedKind::Literal(Leaf::int(0)), Ty::Int, span);
    for k in 0..n {
        let Some(element) = elements_at(cx, &[*array], k, n) else {
            return cx.error_expr(span);
        };
        statement::expect_type(cx, element[0], &Ty::Bool, &ExpectationReason::Unexplained);
        total = increment_if(cx, element[0], total, span);
    }
    let bounds = [(BinaryOp::Ge, least), (BinaryOp::Le, most)];
    let [at_least, at_most] = bounds.map(|(op, bound)| {
        let bound = cx.add(TypedKind::Literal(Leaf::int(bound)), Ty::Int, span);
        ops::binary_prim(cx, op, total, bound, span)
    });
    ops::logical_prim(cx, prim!("Core::BooleanAnd"), &[at_least, at_most], span)
}

/// Adds the expression `if condition then total + 1 else total` and returns it.
fn increment_if(cx: &mut Body<'_, '_>, condition: ExprId, total: ExprId, span: Span) -> ExprId {
    let [one, zero] = [1, 0].map(|v| cx.add(TypedKind::Literal(Leaf::int(v)), Ty::Int, span));
    let more = TypedKind::Each(
        crate::typed::ElementwiseOp::If,
        [condition, one, zero].into(),
    );
    let more = cx.add(more, Ty::Int, span);
    ops::binary_prim(cx, BinaryOp::Add, total, more, span)
}

/// Appends the outputs of one call of the callee to `columns`, which has one list for each output.
fn push_row(columns: &mut Vec<Vec<ExprId>>, row: &[ExprId]) {
    columns.resize_with(columns.len().max(row.len()), Vec::new);
    for (column, value) in columns.iter_mut().zip(row) {
        column.push(*value);
    }
}
