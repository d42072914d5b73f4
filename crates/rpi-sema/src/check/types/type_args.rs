//! Help texts for the arguments of generic types.

use crate::check::bodies::body::Body;
use crate::check::bodies::type_inference::EquationLhs;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::signatures::unit;
use crate::ty::StructTy;
use crate::ty::Ty;
use crate::typed::ExprId;
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::FieldValue;

/// Returns how the type arguments of a struct value are written: those of the flow that it defines, if that is known.
pub(crate) fn struct_args_help(cx: &Body<'_, '_>, name: &Name, value: Span) -> String {
    let mut equations = cx.pending.iter();
    let target = equations
        .find(|equation| equation.value.span == value)
        .and_then(|equation| match equation.lhs {
            EquationLhs::Targets([target]) if target.path.is_empty() => Some(target),
            _ => None,
        });
    let flow = target.and_then(|target| cx.find_flow(&target.name.name));
    let ty = flow.map(|flow| cx.unit.flow(flow).ty.to_string());
    let known = ty.as_deref().and_then(|ty| {
        let args = ty.strip_prefix(name.as_str())?;
        args.strip_prefix("<<")?.strip_suffix(">>")
    });
    let form = |args: &str| match unit::reads_rpi_syntax(cx) {
        true => format!("`{name}<<{args}>> {{ ... }}`"),
        false => format!("`{name}@<{args}> {{ ... }}`"),
    };
    match known {
        Some(args) => format!("write them after the name: {}", form(args)),
        None => format!("write them after the name, for example {}", form("int")),
    }
}

/// Returns how a type with `count` type arguments is written.
pub(crate) fn type_args_help(cx: &Body<'_, '_>, name: &str, count: usize) -> String {
    let args = vec!["int"; count];
    match (count, unit::reads_rpi_syntax(cx)) {
        (0, _) => format!("write only its name: `{name}`"),
        (_, true) => format!("for example `{name}<<{}>>`", args.join("; ")),
        (_, false) => format!("for example `{name}<{}>`", args.join(", ")),
    }
}

/// Returns why a field of the declared type `ty` has its type: an earlier value for a field of the same declared type
/// has decided the type parameter.
pub(crate) fn same_type_reason(
    cx: &Body<'_, '_>,
    open: &StructTy,
    earlier: &[(&FieldValue, ExprId)],
    ty: &Ty,
) -> ExpectationReason {
    let is_same = |(field, _): &&(&FieldValue, ExprId)| {
        let mut fields = open.fields.iter();
        let declared = fields.find(|f| f.name.as_ref() == Some(&field.field.name));
        declared.is_some_and(|declared| declared.ty == *ty)
    };
    match earlier.iter().find(is_same) {
        Some((_, given)) => {
            let found = cx.ty_of(*given);
            let text = format!("this is `{found}`; both fields have the type `{ty}`");
            ExpectationReason::Because(cx.span_of(*given), text)
        }
        None => ExpectationReason::Unexplained,
    }
}
