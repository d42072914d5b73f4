//! Limits on nesting and program size. Each level of nested declarations costs stack, here and in later passes.
//! Iterators and recursions expand to far more expressions than the text contains.

use crate::check::Checker;
use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::types::MAX_LEAVES;
use crate::program::Program;
use crate::ty::{Member, Ty};
use crate::typed::Leaf;
use rpi_diag::{Code, Diagnostic, Span};

/// Maximum number of nested expressions and declarations in progress at which a further declaration is checked. The
/// parser limits the nesting within one expression.
const MAX_NESTING: u32 = 420;

/// Maximum number of aliases in a chain such as `node f = g; node g = h;`.
const MAX_ALIAS_CHAIN: usize = 64;

/// Maximum number of levels of structs and arrays in a type.
const MAX_TYPE_DEPTH: u32 = 420;

/// Maximum number of fields and elements of a struct, over all levels.
const MAX_STRUCT_PARTS: usize = MAX_LEAVES;

/// Maximum number of expressions and flows in all units of a program, in addition to a share that grows with the source
/// text.
const MAX_EXPANDED_SIZE: usize = 320_000;

/// Number of further expressions and flows allowed for each byte of source text.
const EXPRS_PER_BYTE: usize = 4;

/// Number of leaves (scalar parts) of constants that count as one expression in the size of a program.
const LEAVES_PER_EXPR: usize = 4;

/// Number of parts of the value of an expression that count as one further expression in the size of a program.
const PARTS_PER_EXPR: usize = 16;

/// Maximum number of parts of one value, over all levels. An array of [`MAX_LEAVES`] leaves (scalar parts) and the
/// parts that contain them are allowed.
const MAX_VALUE_PARTS: usize = 2 * MAX_LEAVES;

/// Returns the maximum number of expressions and flows of all units of a program.
pub(crate) fn max_expanded_size(program: &Program<'_>) -> usize {
    MAX_EXPANDED_SIZE + EXPRS_PER_BYTE * program.text_len()
}

/// Whether the size of the program is below its limit, so that another array element or instance can be added. Reports
/// an excess once.
pub(crate) fn may_expand(cx: &mut Body<'_, '_>, span: Span) -> bool {
    let may =
        cx.checker.limits.expanded_size + cx.unit.exprs.len() < cx.checker.limits.max_expanded_size;
    if !may {
        program_too_large(cx.checker, span);
    }
    may
}

/// Whether a constant with these leaves (scalar parts) can be stored within the limit on the size of the program.
/// Reports an excess once.
pub(crate) fn may_store_constant(checker: &mut Checker<'_>, leaves: &[Leaf], span: Span) -> bool {
    checker.limits.expanded_size += leaves.len() / LEAVES_PER_EXPR;
    let may = checker.limits.expanded_size < checker.limits.max_expanded_size;
    if !may {
        program_too_large(checker, span);
    }
    may
}

/// Reports at `span` that the program with all its instances and elements is too large. Only the first call reports it.
pub(crate) fn program_too_large(checker: &mut Checker<'_>, span: Span) {
    if std::mem::replace(&mut checker.limits.size_reported, true) {
        return;
    }
    let most = checker.limits.max_expanded_size;
    let message = format!("program too large: more than {most} expressions after expansion");
    let diagnostic = Diagnostic::new(Code::RPI1011, message).primary(span, "limit exceeded here");
    checker.diagnostics.push(diagnostic.help("use smaller sizes: iterators expand to one copy per element, generic nodes to one per choice of static arguments"));
}

/// Whether the declaration of kind `what` that the current one needs can be checked within the limit on nesting.
/// Reports an excess once.
pub(crate) fn may_nest(checker: &mut Checker<'_>, what: &str, span: Span) -> bool {
    check_nesting_limit(checker, checker.limits.nesting < MAX_NESTING, what, span)
}

/// Whether another alias in a chain of aliases can be resolved within the limit. Reports an excess once.
pub(crate) fn may_alias(checker: &mut Checker<'_>, span: Span) -> bool {
    check_nesting_limit(
        checker,
        checker.aliases.len() < MAX_ALIAS_CHAIN,
        "node",
        span,
    )
}

fn check_nesting_limit(checker: &mut Checker<'_>, may: bool, what: &str, span: Span) -> bool {
    if !may && !std::mem::replace(&mut checker.limits.nesting_reported, true) {
        checker.diagnostics.push(
            Diagnostic::new(
                Code::RPI1011,
                format!("the chain of declarations that this {what} depends on is too long"),
            )
            .primary(span, "end of the chain")
            .help("declare each name before its use, or shorten the chain"),
        );
    }
    may
}

/// Runs `work`, the check of a declaration that another one needs, with the nesting level increased by one, and returns
/// its result.
pub(crate) fn check_nested<'a, T>(
    checker: &mut Checker<'a>,
    work: impl FnOnce(&mut Checker<'a>) -> T,
) -> T {
    checker.limits.nesting += 1;
    let result = work(checker);
    checker.limits.nesting -= 1;
    result
}

/// Whether an expression may have a value of this type. Reports a value with too many parts. The parts are counted
/// before anything is computed for each part, because tuples of tuples can double in size with every line; the total
/// for all expressions is limited, too.
pub(crate) fn may_hold(cx: &mut Body<'_, '_>, ty: &Ty, span: Span) -> bool {
    if !matches!(ty, Ty::Tuple(_) | Ty::Array(..) | Ty::Struct(_)) {
        return true;
    }
    match part_count(ty, MAX_TYPE_DEPTH, MAX_VALUE_PARTS) {
        Some(parts) => {
            cx.checker.limits.expanded_size += parts / PARTS_PER_EXPR;
            may_expand(cx, span)
        }
        None => {
            let diagnostic = Diagnostic::new(Code::RPI2009, "the value is too large")
                .primary(
                    span,
                    format!(
                        "more than {MAX_VALUE_PARTS} parts, or more than {MAX_TYPE_DEPTH} levels"
                    ),
                )
                .help(
                    "use fewer parts: a tuple or array of tuples holds all parts of each of them",
                );
            report::report_diagnostic(cx, diagnostic);
            false
        }
    }
}

/// Whether a struct type with these fields is within the limits on the number of parts and levels.
pub(crate) fn is_within_size_limits(fields: &[Member]) -> bool {
    total_part_count(fields, MAX_TYPE_DEPTH, MAX_STRUCT_PARTS).is_some()
}

/// Returns the number of parts of a type, including the whole; `None` if there are more than `most` parts or `levels`
/// levels. Counting stops at the limit.
fn part_count(ty: &Ty, levels: u32, most: usize) -> Option<usize> {
    let below = levels.checked_sub(1)?;
    let count = match ty {
        Ty::Array(element, n) => part_count(element, below, most)?.checked_mul(*n as usize)?,
        Ty::Struct(_) | Ty::Tuple(_) => total_part_count(ty.members(), below, most)?,
        _ => 0,
    };
    Some(count + 1).filter(|count| *count <= most)
}

fn total_part_count(members: &[Member], levels: u32, most: usize) -> Option<usize> {
    members.iter().try_fold(0usize, |sum, member| {
        Some(sum + part_count(&member.ty, levels, most - sum)?)
    })
}
