//! Help for functions of other languages that do not exist here.

use crate::check::bodies::body::Body;
use crate::check::calls::args::{self, CallArgument};
use crate::check::diagnostics::foreign;
use crate::check::diagnostics::suggest_callee;
use crate::ty::Ty;
use crate::units::Dimension;
use rpi_diag::{Code, Fix, Quote, Span};
use rpi_syntax::ast;

/// Adds the equivalent in RPI to the diagnostic about an undefined callee such as `len(a)`. `given` are the checked
/// arguments of the call.
pub(crate) fn suggest_for_foreign_call<'a>(
    cx: &mut Body<'_, 'a>,
    call: &'a ast::Call,
    given: &[CallArgument],
    span: Span,
) {
    suggest_callee::suggest_power_operator(cx, call, span);
    let ty = given
        .first()
        .map_or(Ty::Unknown, |first| cx.ty_of(first.value).clone());
    let name = &call.callee.name;
    let Some((help, fix)) = foreign_call_help(&name.name.to_lowercase(), call, &ty) else {
        return;
    };
    if let Some(diagnostic) = suggest_callee::diagnostic_at(cx, name.span, Code::RPI1001) {
        diagnostic.help = vec![help];
        diagnostic.fixes = fix.into_iter().collect();
    }
}

/// Checks the arguments of a call whose callee is undefined. The callee may be a function of another language, and
/// undefined names in its arguments are then of that language as well, so that they are not reported.
pub(crate) fn check_foreign_args<'a>(
    cx: &mut Body<'_, 'a>,
    call: &'a ast::Call,
    span: Span,
) -> Vec<CallArgument<'a>> {
    let name = call.callee.name.name.to_lowercase();
    let is_foreign = foreign_call_help(&name, call, &Ty::Unknown).is_some();
    let outer = cx.bindings.foreign_call;
    cx.bindings.foreign_call = outer.or(is_foreign.then_some(span));
    let arguments = args::check_args(cx, &call.args);
    cx.bindings.foreign_call = outer;
    arguments
}

/// Returns the help text for a call of a function of another language, and a fix where the intended meaning is certain
/// enough. `name` is in lower case, and `ty` is the type of the first argument. `None` if there is no advice.
fn foreign_call_help(name: &str, call: &ast::Call, ty: &Ty) -> Option<(String, Option<Fix>)> {
    let place = call.callee.name.span;
    match name {
        "prev" | "previous" | "old" => {
            let help = format!(
                "the value of the previous cycle is `... -> pre {}`, with the value of the first cycle before `->`",
                first_argument(call)
            );
            Some((help, previous_value_fix(call, ty)))
        }
        "len" | "length" | "numel" | "sizeof" => Some((size_help(call, ty), None)),
        "sum" | "prod" | "all" | "reduce" | "foldl" | "accumulate" => {
            Some(reduction_help(name, call, ty))
        }
        _ if conversion_target(name).is_some() => {
            let word = conversion_target(name)?;
            let fix = Fix::maybe(format!("write `{word}`")).replace(place, format!("{word} "));
            let help = format!(
                "a conversion is an operator before its operand: `{word} {}`",
                first_argument(call)
            );
            Some((help, (call.args.len() == 1).then_some(fix)))
        }
        "delay" => {
            let help = format!(
                "delay by one cycle: `... -> pre {}`; {ON_DELAY_HELP}",
                first_argument(call)
            );
            Some((help, None))
        }
        "wait" | "sleep" | "usleep" | "pause" | "waittime" | "waituntil" | "wait_sec" | "dwell" => {
            Some((format!("a cycle cannot wait; {ON_DELAY_HELP}"), None))
        }
        "print" | "printf" | "println" | "puts" | "echo" | "fprintf" | "disp" | "display"
        | "log" | "write" | "writeln" | "tpwrite" | "msg" | "cout" | "debug" => {
            let help = "a node cannot print; its out-ports are visible in a run, and a command can export flows: `export ...;`";
            Some((help.to_owned(), None))
        }
        _ => crate::check::diagnostics::foreign_idioms::call_help(name, &call.args)
            .map(|help| (help, None)),
    }
}

/// Help text about testing whether a condition held for some time.
const ON_DELAY_HELP: &str = "to test whether a condition held for 1 s, `use timers;` and write `on_delay<<delay: 1.0[s]>>(...)`";

/// Returns the source text of a call's first argument for use as an operand; `...` if there is no argument.
fn first_argument(call: &ast::Call) -> String {
    let first = call.args.first();
    first.map_or("...".to_owned(), |arg| {
        Quote::operand(arg.value.span).to_string()
    })
}

/// Returns the help text for a call such as `len(a)`, which asks for the size of an array. `ty` is the type of its
/// argument.
fn size_help(call: &ast::Call, ty: &Ty) -> String {
    let name = argument_name(call);
    match ty {
        Ty::Array(_, n) => {
            format!("the size is part of the type of an array: `{name}` has {n} elements")
        }
        Ty::Unknown => {
            "the size is part of the type of an array: `const n: int = 3;`, then `a: int^n`"
                .to_owned()
        }
        _ => format!(
            "`{name}` is `{ty}`, not an array; the type of an array states its size: `int^3`"
        ),
    }
}

/// Returns the fix that replaces `prev(x)` by `(0 -> pre x)`, where the first value has the type of `x`. `None` if
/// `ty`, the type of `x`, has no obvious first value.
fn previous_value_fix(call: &ast::Call, ty: &Ty) -> Option<Fix> {
    let first = match ty {
        Ty::Bool => "false".to_owned(),
        Ty::Int => "0".to_owned(),
        Ty::Real(Dimension::ONE) => "0.0".to_owned(),
        Ty::Real(dim) if !dim.has_free() => format!("0[{dim}]"),
        _ => return None,
    };
    let [only] = &call.args[..] else { return None };
    let fix = Fix::maybe("read the previous value").replace(call.callee.span, "");
    let value = &only.value;
    Some(match value.unparen().kind {
        ast::ExprKind::Name(_) => fix.insert_before(value.span, format!("{first} -> pre ")),
        _ => fix
            .insert_before(value.span, format!("{first} -> pre ("))
            .insert_after(value.span, ")"),
    })
}

/// Returns the name of the flow that is the first argument of a call; `a` if the first argument is not a name.
fn argument_name(call: &ast::Call) -> &str {
    match call.args.first().map(|arg| &arg.value.kind) {
        Some(ast::ExprKind::Name(name)) => name.as_str(),
        _ => "a",
    }
}

/// Returns the type, `real` or `int`, to which a function of another language such as `float`, `int_to_real` or `toint`
/// converts. `name` is in lower case. `None` if the function is no conversion.
fn conversion_target(name: &str) -> Option<&'static str> {
    let target = match name.rsplit_once("_to_").or_else(|| name.rsplit_once("to")) {
        Some((from, target)) if from.is_empty() || foreign::type_equivalent(from).is_some() => {
            target
        }
        Some((_, target)) if name.contains("_to_") => target,
        _ => name,
    };
    let target = target.trim_start_matches('_');
    let known = |word: &'static str| {
        (target == word || foreign::type_equivalent(target) == Some(word)).then_some(word)
    };
    known("real").or_else(|| known("int"))
}

/// Returns the help text, and a fix if possible, for replacing a reduction such as `sum(a)` by `red`. `name` is the
/// function, and `ty` is the type of its argument.
fn reduction_help(name: &str, call: &ast::Call, ty: &Ty) -> (String, Option<Fix>) {
    let (op, with) = match name {
        "prod" => ("*", "1"),
        "all" => ("and", "true"),
        _ => ("+", "0"),
    };
    let Ty::Array(element, n) = ty else {
        let help = format!("for an array of 3 elements use `red<<{op}, 3>>({with}, a)`");
        return (help, None);
    };
    let with = match (&**element, name) {
        (Ty::Real(_), "prod") => "1.0",
        (Ty::Real(_), _) => "0.0",
        _ => with,
    };
    let is_plain = match (&**element, name) {
        (Ty::Bool, "all") | (Ty::Int, "sum" | "prod") => true,
        (Ty::Real(dim), "sum" | "prod") => *dim == Dimension::ONE,
        _ => false,
    };
    let callee = format!("red<<{op}, {n}>>");
    let help = format!(
        "for this array use `{callee}({with}, {})`",
        argument_name(call)
    );
    let fix = match &call.args[..] {
        [only] if is_plain => Some(
            Fix::maybe(format!("write `{callee}`"))
                .replace(call.callee.name.span, callee)
                .insert_before(only.value.span, format!("{with}, ")),
        ),
        _ => None,
    };
    (help, fix)
}
