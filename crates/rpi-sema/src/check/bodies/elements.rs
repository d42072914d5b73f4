//! Array definitions by element, `a[i] = e` of Kind 2 with an undeclared `i`: every element of `a` is `e` for its
//! index.
//!
//! Such an equation is expanded to one equation per element, and conditions on the index are evaluated at compile time.
//! Elements are defined in ascending order: an element may read elements at a fixed distance before it.

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::targets;
use crate::check::bodies::type_inference::EquationLhs;
use crate::check::bodies::type_inference::EquationState;
use crate::check::bodies::type_inference::PendingEquation;
use crate::check::diagnostics::report;
use crate::check::exprs::bindings;
use crate::check::exprs::bindings::BindingValue;
use crate::check::signatures::unit;
use crate::check::types::consts;
use crate::program::{Lookup, NameSpace};
use crate::ty::Ty;
use crate::typed::Leaf;
use rpi_diag::suppression;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_net::passes::causality::{self, Read};
use rpi_syntax::ast::{Access, Equation, Expr, ExprKind, Ident, Statement, StatementKind, Target};
use rpi_syntax::ops::{BinaryOp, UnaryOp};

/// Maximum number of array elements that one equation such as `a[i] = i` may define.
const MAX_ELEMENTS: u64 = 1 << 14;

/// Maximum number of equations in a dependency cycle for which the search looks. The search takes exponential time.
const MAX_CYCLE: usize = 12;

/// Whether an equation of Lustre defines an array element by element, as in `a[i] = b[i] + 1`.
pub(crate) fn defines_elements(cx: &Body<'_, '_>, equation: &Equation) -> bool {
    !unit::reads_rpi_syntax(cx)
        && equation
            .targets
            .iter()
            .any(|target| elementwise_array_name(cx, target).is_some())
}

/// Counts for each name the equations of Lustre that define a part of the flow with this name.
pub(crate) fn count_parts(cx: &mut Body<'_, '_>, statements: &[Statement]) {
    if unit::reads_rpi_syntax(cx) {
        return;
    }
    for statement in statements {
        let StatementKind::Equation(equation) = &statement.kind else {
            continue;
        };
        let parts = equation.targets.iter();
        for target in parts.filter(|target| !target.path.is_empty()) {
            let name = target.name.name.clone();
            *cx.definitions.part_equation_counts.entry(name).or_insert(0) += 1;
        }
    }
}

/// Returns the name of the array on the left side of an equation if its first index is an undeclared name, as in
/// `a[i]`; `None` for any other target.
fn elementwise_array_name<'t>(cx: &Body<'_, '_>, target: &'t Target) -> Option<&'t Ident> {
    let Some(Access::Index(index)) = target.path.first() else {
        return None;
    };
    let name = index.as_name()?;
    let found = cx
        .checker
        .program
        .lookup_in(NameSpace::Value, cx.module, name);
    let is_outside = matches!(found, Lookup::Found(_));
    // If it is the only equation of the array, it cannot be meant for one element: the index hides the constant of
    // the same name.
    let is_only = || cx.definitions.part_equation_counts.get(&target.name.name) == Some(&1);
    let known = matches!(locals::find_local(cx, name), Some(Local::Constant(_)))
        || cx.statics.contains_key(name)
        || (is_outside && !is_only());
    let is_array = matches!(
        locals::find_local(cx, &target.name.name),
        Some(Local::Flow(_))
    );
    (!known && is_array).then_some(&target.name)
}

/// Expands an equation such as `a[i] = b[i] + 1` to one pending equation for each element of the array. Reports an
/// equation that cannot be expanded.
pub(crate) fn expand_element_equation<'a>(
    cx: &mut Body<'_, 'a>,
    equation: &'a Equation,
    span: Span,
) {
    let [target] = &equation.targets[..] else {
        return report_invalid_element_equation(
            cx,
            &equation.targets,
            span,
            "such an equation must define exactly one array",
        );
    };
    let Some(flow) = cx.find_flow(&target.name.name) else {
        return;
    };
    let Some(names) = index_names(target) else {
        return report_invalid_element_equation(
            cx,
            &equation.targets,
            span,
            "each index must be a plain name",
        );
    };
    let (sizes, element) = dimensions(cx.unit.flow(flow).ty.clone());
    if element.is_unknown() {
        return cx.reported.erroneous_flows.push(flow);
    }
    if sizes.len() != names.len() {
        let found = match names.len() {
            1 => "1 index".to_owned(),
            n => format!("{n} indices"),
        };
        let expected = rpi_diag::with_noun(sizes.len(), "dimension");
        let text = format!("`{}` has {expected}, found {found}", target.name.name);
        return report_invalid_element_equation(cx, &equation.targets, span, &text);
    }
    let count: u64 = sizes.iter().map(|n| u64::from(*n)).product();
    if count > MAX_ELEMENTS {
        let text = format!("more than {MAX_ELEMENTS} elements");
        return report_invalid_element_equation(cx, &equation.targets, span, &text);
    }
    cx.definitions.element_equations.push(equation);
    for at in 0..count {
        cx.pending.push(PendingEquation {
            block: cx.block,
            lhs: EquationLhs::Targets(&equation.targets),
            value: &equation.value,
            span,
            inferred_flows: [None].into_iter().collect(),
            state: EquationState::Unchecked,
            indices: names
                .iter()
                .cloned()
                .zip(element_indices(at, &sizes))
                .collect(),
        });
    }
}

/// Returns the size of each dimension of nested arrays, outermost first, and the type of the innermost elements.
fn dimensions(mut ty: Ty) -> (Vec<u32>, Ty) {
    let mut sizes = Vec::new();
    while let Ty::Array(element, n) = ty {
        sizes.push(n);
        ty = (*element).clone();
    }
    (sizes, ty)
}

/// Reports an equation that cannot define its arrays element by element. `why` is the reason for the label.
fn report_invalid_element_equation(
    cx: &mut Body<'_, '_>,
    targets: &[Target],
    span: Span,
    why: &str,
) {
    let flows = targets
        .iter()
        .filter_map(|target| cx.find_flow(&target.name.name));
    let flows: Vec<_> = flows.collect();
    cx.reported.erroneous_flows.extend(flows);
    let diagnostic = Diagnostic::new(
        Code::RPI2013,
        "this array cannot be defined by its elements",
    )
    .primary(span, why.to_owned())
    .help(match targets {
        [target] => format!(
            "write an index for each dimension, such as `{}[i][j] = ...;` for two",
            target.name.name
        ),
        _ => "write an equation of its own for each array".to_owned(),
    });
    report::report_diagnostic(cx, diagnostic);
}

/// Runs `work` with the index variables of a pending equation bound to their values. `index` is the index of the
/// equation in `pending`.
pub(crate) fn with_index_bindings<'c, 'a, T>(
    cx: &mut Body<'c, 'a>,
    index: usize,
    work: impl FnOnce(&mut Body<'c, 'a>) -> T,
) -> T {
    let before = cx.bindings.bound_names.len();
    for (name, value) in cx.pending[index].indices.clone() {
        bindings::bind_name(cx, &name, BindingValue::Index(value));
    }
    let result = work(cx);
    cx.bindings.bound_names.truncate(before);
    result
}

/// Checks the equation of one array element. `index` is the index of the equation in `pending`. An error that has been
/// reported for the first element is not reported again.
pub(crate) fn check_element_equation(cx: &mut Body<'_, '_>, index: usize) {
    let is_first = cx.pending[index].indices.iter().all(|(_, at)| *at == 0);
    let before = cx.diagnostics.len();
    with_index_bindings(cx, index, |body| targets::check_equation(body, index));
    if !is_first {
        let new = cx.diagnostics.split_off(before);
        suppression::add_new(&mut cx.diagnostics, new);
    }
}

/// Returns the value of a condition that depends on array indices and constants only; `None` for other conditions.
/// `value` is the typed expression of `condition`.
pub(crate) fn const_condition(
    cx: &mut Body<'_, '_>,
    condition: &Expr,
    value: crate::typed::ExprId,
) -> Option<bool> {
    if cx.bindings.bound_names.is_empty() || !bindings::reads_binding(cx, condition) {
        return None;
    }
    consts::fold_silently(cx, value)?
        .first()
        .and_then(Leaf::as_bool)
}

/// Reports arrays that are defined element by element such that an element depends on itself or on a later element in
/// the same cycle.
pub(crate) fn check_element_order(cx: &mut Body<'_, '_>) {
    let equations = cx.definitions.element_equations.clone();
    let mut links = Vec::new();
    for (from, equation) in equations.iter().enumerate() {
        let mut reads = Vec::new();
        element_reads(&equation.value, &mut reads);
        for (array, indices, span) in reads {
            let to = equations
                .iter()
                .position(|e| e.targets[0].name.name == *array);
            let Some(to) = to else { continue };
            let names = index_names(&equation.targets[0]).unwrap_or_default();
            let offset: Option<Vec<i64>> = indices
                .iter()
                .zip(&names)
                .map(|(index, name)| index_offset(index, name))
                .collect();
            match offset {
                Some(offset) if indices.len() == names.len() => links.push(ElementDependency {
                    from,
                    to,
                    offset,
                    span,
                }),
                _ if to == from => report_variable_offset(cx, equation, span),
                _ => {}
            }
        }
    }
    for (start, equation) in equations.iter().enumerate() {
        let dims = equation.targets[0].path.len();
        if let Some(ring) =
            find_nonnegative_cycle(&links, start, start, &vec![0; dims], &mut Vec::new())
        {
            return report_element_cycle(cx, &equations, &ring);
        }
    }
}

fn report_variable_offset(cx: &mut Body<'_, '_>, equation: &Equation, span: Span) {
    let name = &equation.targets[0].name;
    let diagnostic = Diagnostic::new(
        Code::RPI2013,
        format!("cannot order the elements of `{}`", name.name),
    )
    .primary(span, "not at a fixed distance from the defined element")
    .secondary(name.span, "defined by its elements here")
    .help(match index_names(&equation.targets[0]).as_deref() {
        Some([index]) => format!(
            "read an element at a fixed distance before it, such as `{}[{} - 1]`",
            name.name, index.name
        ),
        _ => "read elements at a fixed distance before it".to_owned(),
    });
    report::report_diagnostic(cx, diagnostic);
}

/// Reports equations of array elements that depend on one another in one cycle. `ring` is the dependency cycle; it
/// refers to `equations` by index.
fn report_element_cycle<'a>(
    cx: &mut Body<'_, 'a>,
    equations: &[&'a Equation],
    ring: &[&ElementDependency],
) {
    let name = |at: usize| equations[at].targets[0].name.name.to_string();
    let reads = ring.iter().rev().map(|link| Read {
        from: name(link.to),
        to: name(link.from),
        span: link.span,
    });
    let reads: Vec<Read> = reads.collect();
    let help = "elements are defined in ascending order: read an earlier one, `a[i - 1]`";
    let diagnostic = Diagnostic {
        help: vec![help.to_owned()],
        ..causality::dependency_cycle(&reads)
    };
    report::report_diagnostic(cx, diagnostic);
    let flows = ring
        .iter()
        .filter_map(|link| cx.find_flow(&equations[link.from].targets[0].name.name));
    let flows: Vec<_> = flows.collect();
    cx.reported.erroneous_flows.extend(flows);
}

/// Read of elements of one array in the equation that defines another array element by element. `from` is the index of
/// the equation that reads, and `to` is the index of the equation that defines the array that is read.
struct ElementDependency {
    from: usize,
    to: usize,
    /// Index that is read minus index that is defined, for each dimension: -1 for `a[i - 1]` in the equation of `b[i]`.
    offset: Vec<i64>,
    span: Span,
}

/// Returns the index names of a target such as `a[i][j]`; `None` if an index is not a plain name.
fn index_names(target: &Target) -> Option<Vec<Ident>> {
    let name = |access: &Access| match access {
        Access::Index(index) => Some(Ident {
            name: index.as_name()?.clone(),
            span: index.span,
        }),
        _ => None,
    };
    target.path.iter().map(name).collect()
}

/// Returns the indices of the array element at the row-major position `at`. `sizes` has the size of each dimension,
/// outermost first.
fn element_indices(mut at: u64, sizes: &[u32]) -> Vec<i64> {
    let mut indices: Vec<i64> = Vec::with_capacity(sizes.len());
    for n in sizes.iter().rev() {
        let n = u64::from((*n).max(1));
        indices.push((at % n).cast_signed());
        at /= n;
    }
    indices.reverse();
    indices
}

/// Appends the array elements that an expression reads in the current cycle to `reads`: the array's name, the index
/// expressions, and the location.
fn element_reads<'e>(expr: &'e Expr, reads: &mut Vec<(&'e rpi_syntax::Name, Vec<&'e Expr>, Span)>) {
    let mut base = expr;
    let mut indices = Vec::new();
    while let ExprKind::Index(index) = &base.kind {
        indices.push(&index.index);
        base = &index.base;
    }
    if let (Some(name), false) = (base.as_name(), indices.is_empty()) {
        indices.reverse();
        return reads.push((name, indices, expr.span));
    }
    match &expr.kind {
        ExprKind::Unary(UnaryOp::Pre, _) => {}
        ExprKind::Binary(binary) if binary.op == BinaryOp::Fby => element_reads(&binary.lhs, reads),
        _ => expr
            .children()
            .into_iter()
            .for_each(|part| element_reads(part, reads)),
    }
}

/// Returns the difference between an index expression and the index variable `name`: 1 for `i + 1`; `None` for
/// expressions of another form.
fn index_offset(index: &Expr, name: &Ident) -> Option<i64> {
    let is_index = |expr: &Expr| expr.unparen().as_name() == Some(&name.name);
    let number = |expr: &Expr| match &expr.unparen().kind {
        ExprKind::Number(number) => number.int_value().and_then(|n| i64::try_from(n).ok()),
        _ => None,
    };
    match &index.unparen().kind {
        _ if is_index(index) => Some(0),
        ExprKind::Binary(sum) if sum.op == BinaryOp::Add && is_index(&sum.lhs) => number(&sum.rhs),
        ExprKind::Binary(sum) if sum.op == BinaryOp::Add && is_index(&sum.rhs) => number(&sum.lhs),
        ExprKind::Binary(sum) if sum.op == BinaryOp::Sub && is_index(&sum.lhs) => {
            number(&sum.rhs).map(|n| -n)
        }
        _ => None,
    }
}

/// Searches for a dependency cycle of array elements from equation `at` back to equation `start` whose total index
/// offset is not negative, and returns it; `None` if there is none. `way` is the path from `start` to `at`, and
/// `so_far` is the offset of this path for each dimension.
fn find_nonnegative_cycle<'l>(
    links: &'l [ElementDependency],
    start: usize,
    at: usize,
    so_far: &[i64],
    way: &mut Vec<&'l ElementDependency>,
) -> Option<Vec<&'l ElementDependency>> {
    if way.len() >= MAX_CYCLE {
        return None;
    }
    for link in links.iter().filter(|link| link.from == at) {
        let is_new = way.iter().all(|known| known.to != link.to);
        if !is_new || link.offset.len() != so_far.len() {
            continue;
        }
        let sum: Vec<i64> = so_far
            .iter()
            .zip(&link.offset)
            .map(|(a, b)| a + b)
            .collect();
        way.push(link);
        if link.to == start {
            // Elements are ordered by their first index, then by the next: the first offset that is not 0 decides.
            let first = sum.iter().find(|n| **n != 0).copied().unwrap_or(0);
            if first >= 0 {
                return Some(way.clone());
            }
        } else if let Some(found) = find_nonnegative_cycle(links, start, link.to, &sum, way) {
            return Some(found);
        }
        way.pop();
    }
    None
}
