//! Constants. They are evaluated by the same elaboration that builds nets: an expression is constant if it folds to
//! values.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::expr;
use crate::check::limits::nesting;
use crate::check::reuse;
use crate::check::signatures::unit;
use crate::check::signatures::units_on_demand;
use crate::check::types;
use crate::check::types::subrange;
use crate::check::types::type_decls;
use crate::check::{Checker, Constant, Lazy};
use crate::elab::{self, NotConstantError};
use crate::program::{DeclId, DeclKind};
use crate::ty::{Geometry, Ty};
use crate::typed::TypedKind;
use crate::typed::{ExprId, Leaf, Unit, UnitId};
use crate::units::Dimension;
use rpi_diag::{Code, Diagnostic};
use rpi_image::Scalar;
use rpi_syntax::ast;
use std::rc::Rc;

/// Returns the value of a constant, or the pose of a frame, and checks its definition on first use; `None` after an
/// error.
pub(crate) fn check_constant(checker: &mut Checker<'_>, id: DeclId) -> Option<Constant> {
    match checker.constants.get(&id) {
        Some(Lazy::Done(constant)) => {
            let constant = constant.clone();
            checker
                .diagnostics
                .extend(checker.valueless_constants.get(&id).cloned());
            return constant;
        }
        Some(Lazy::InProgress) => {
            type_decls::report_dependency_cycle(checker, "constant", id);
            return None;
        }
        None => {}
    }
    let decl = checker.program.decl(id);
    if !matches!(decl.kind, DeclKind::Const(_) | DeclKind::Frame(_)) {
        return None;
    }
    if !nesting::may_store_constant(checker, &[], decl.span)
        || !nesting::may_nest(checker, "constant", decl.span)
    {
        return None;
    }
    let before = checker.diagnostics.len();
    checker.constants.insert(id, Lazy::InProgress);
    checker.in_progress.push(id);
    let constant = nesting::check_nested(checker, |checker| {
        let mut body = Body::for_top_level(checker, id);
        let constant = match decl.kind {
            DeclKind::Const(def) => constant_def(&mut body, def),
            DeclKind::Frame(frame) => frame_pose(&mut body, &decl.name, frame),
            _ => None,
        };
        body.finish();
        constant
    });
    checker.in_progress.pop();
    if checker.diagnostics.len() > before {
        reuse::taint(checker);
    }
    let mut found = checker.diagnostics[before..].iter();
    if let Some(outside) = found.find(|diagnostic| diagnostic.code == Code::RPI1012) {
        checker.valueless_constants.insert(id, outside.clone());
    }
    let constant = constant
        .filter(|constant| nesting::may_store_constant(checker, &constant.leaves, decl.span));
    checker.constants.insert(id, Lazy::Done(constant.clone()));
    constant
}

/// Checks a constant of Lustre on its own. The constant, or one on which it depends, may lack a value as long as no
/// node needs it; the missing value is then reported where the constant is used.
pub(crate) fn check_lustre_constant(checker: &mut Checker<'_>, id: DeclId) {
    let before = checker.diagnostics.len();
    check_constant(checker, id);
    let found = checker.diagnostics.split_off(before);
    let (outside, found): (Vec<_>, Vec<_>) =
        found.into_iter().partition(|f| f.code == Code::RPI1012);
    checker.diagnostics.extend(found);
    if !outside.is_empty() {
        checker
            .constants
            .retain(|_, constant| !matches!(constant, Lazy::Done(None)));
        checker.valueless_constants.extend(
            outside
                .into_iter()
                .next()
                .map(|diagnostic| (id, diagnostic)),
        );
    }
}

/// Returns the value of a constant definition; `None` after an error.
pub(crate) fn constant_def<'a>(cx: &mut Body<'_, 'a>, def: &'a ast::ConstDef) -> Option<Constant> {
    let declared = def.ty.as_ref().map(|ty| types::resolve_type(cx, ty));
    let Some(value) = &def.value else {
        // A definition with a syntax error has been reported.
        let is_broken = |ty: &ast::Type| matches!(ty.kind, ast::TypeKind::Error);
        let is_whole = !def.ty.as_ref().is_some_and(is_broken);
        let name = def.names.first().filter(|_| is_whole)?;
        let diagnostic = constant_without_value(name, unit::reads_rpi_syntax(cx));
        report::report_diagnostic(cx, diagnostic);
        let ty = declared.filter(|_| !unit::reads_rpi_syntax(cx))?;
        let leaves = crate::check::signatures::sample_check::sample_value(&ty)?;
        return Some(Constant { ty, leaves });
    };
    let id = expr::check_expr(cx, value);
    if let Some(declared) = &declared {
        statement::expect_type(cx, id, declared, &ExpectationReason::Unexplained);
    }
    let leaves = fold(cx, id)?;
    if let Some(declared) = &declared {
        subrange::is_in_subranges(cx, &leaves, declared, cx.span_of(id));
    }
    let found = cx.ty_of(id).clone();
    let ty = declared.map_or(found.clone(), |ty| {
        crate::ty::join(&ty, &found).unwrap_or(ty)
    });
    Some(Constant { ty, leaves })
}

/// Returns the pose of a frame in its parent frame; `None` if the declaration gives no pose, or after an error.
fn frame_pose<'a>(
    cx: &mut Body<'_, 'a>,
    name: &rpi_syntax::Name,
    frame: &'a ast::FrameDecl,
) -> Option<Constant> {
    let in_frame = frame
        .parent
        .as_ref()
        .map(|parent| types::parent_frame(cx, parent));
    let geometry = Geometry {
        dim: None,
        of: Some(name.clone()),
        in_frame: in_frame.flatten(),
    };
    let ty = Ty::Spatial(Scalar::Pose, Rc::new(geometry));
    let leaves = const_value(cx, frame.pose.as_ref()?, &ty)?;
    Some(Constant { ty, leaves })
}

/// Returns the value of a constant expression of the given type as the values of its leaves (scalar parts). Reports an
/// expression that has another type or is not constant, and returns `None`.
pub(crate) fn const_value<'a>(
    cx: &mut Body<'_, 'a>,
    value: &'a ast::Expr,
    ty: &Ty,
) -> Option<Rc<[Leaf]>> {
    let id = expr::check_expr(cx, value);
    const_value_of(cx, id, ty)
}

/// Returns the value of an expression that has been checked, with the same conditions as [`const_value`].
pub(crate) fn const_value_of(cx: &mut Body<'_, '_>, id: ExprId, ty: &Ty) -> Option<Rc<[Leaf]>> {
    if !statement::expect_type(cx, id, ty, &ExpectationReason::Unexplained) {
        return None;
    }
    let leaves = fold(cx, id)?;
    subrange::is_in_subranges(cx, &leaves, ty, cx.span_of(id)).then_some(leaves)
}

/// Returns the value of a constant integer expression; `None` after an error.
pub(crate) fn const_integer<'a>(cx: &mut Body<'_, 'a>, value: &'a ast::Expr) -> Option<i64> {
    const_value(cx, value, &Ty::Int)?.first()?.as_int()
}

/// Returns a constant duration in nanoseconds; `None` if it is negative or above 1e18 ns, or after an error.
pub(crate) fn const_nanoseconds<'a>(cx: &mut Body<'_, 'a>, value: &'a ast::Expr) -> Option<u64> {
    let seconds = const_value(cx, value, &Ty::Real(Dimension::TIME))?
        .first()?
        .as_real()?;
    let ns = (seconds * 1e9).round();
    (0.0..1e18).contains(&ns).then_some(ns as u64)
}

/// Returns the value of a constant expression as the values of its leaves (scalar parts). Reports the part that is not
/// constant and returns `None`.
pub(crate) fn fold(cx: &mut Body<'_, '_>, id: ExprId) -> Option<Rc<[Leaf]>> {
    match try_fold(cx, id) {
        Ok(leaves) => Some(leaves),
        Err(NotConstantError::Reported) => None,
        Err(NotConstantError::RunTime(span)) => {
            report::report_diagnostic(
                cx,
                Diagnostic::new(Code::RPI2008, "a constant is needed here")
                    .primary(span, "this is only known at run time")
                    .secondary(cx.span_of(id), "needed at compile time")
                    .help("use a number, a constant or a static parameter"),
            );
            None
        }
        Err(NotConstantError::Fault(span, what)) => {
            report::report_diagnostic(
                cx,
                Diagnostic::new(Code::RPI2010, what)
                    .primary(span, "while evaluating this constant")
                    .help("correct the values from which it is computed"),
            );
            None
        }
    }
}

/// Returns the value of an expression as the values of its leaves (scalar parts); `None`, without a diagnostic, if it
/// is not constant.
pub(crate) fn fold_silently(cx: &mut Body<'_, '_>, id: ExprId) -> Option<Rc<[Leaf]>> {
    try_fold(cx, id).ok()
}

/// Returns the value of an expression as the values of its leaves (scalar parts), or the reason why it is not constant.
pub(crate) fn try_fold(cx: &mut Body<'_, '_>, id: ExprId) -> Result<Rc<[Leaf]>, NotConstantError> {
    match &cx.unit.expr(id).kind {
        TypedKind::Literal(leaf) => return Ok([leaf.clone()].into()),
        TypedKind::Const(leaves) => return Ok(leaves.clone()),
        _ => {}
    }
    // Elaboration inlines calls, so that the called units must be checked first.
    for unit in called_units(&cx.unit, id) {
        units_on_demand::check_unit_now(cx.checker, unit);
    }
    elab::evaluate_constant(&cx.checker.units, &cx.unit, id)
}

/// Returns the diagnostic for a constant that is declared without a value. In Lustre, such external constants are
/// allowed but not supported, so that another code is used unless `is_rpi`.
fn constant_without_value(name: &ast::Ident, is_rpi: bool) -> Diagnostic {
    let code = match is_rpi {
        true => Code::RPI1009,
        false => Code::RPI1012,
    };
    Diagnostic::new(code, format!("the constant `{}` has no value", name.name))
        .primary(name.span, "external constants are not supported")
        .help("add a value: `= ...`")
}

/// Returns the units that an expression calls, directly or in its operands.
fn called_units(unit: &Unit, id: ExprId) -> Vec<UnitId> {
    let mut found = Vec::new();
    let mut parts = unit.traverse(id);
    while let Some((id, expr)) = parts.next() {
        if let TypedKind::Call(call) = &expr.kind {
            found.push(call.unit);
        }
        parts.enter(id);
    }
    found
}
