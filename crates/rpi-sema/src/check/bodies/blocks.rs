//! Blocks of equations (`if`, `when`, `cond`, and `frame` of Kind 2). The parser has replaced each block by plain
//! equations; this module declares these and reports the block's errors.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::diagnostics::report;
use rpi_diag::{Code, Diagnostic};
use rpi_syntax::ast::{BlockError, Desugared};

/// Reports the errors of a block that was desugared to equations, and declares these equations. A flow whose equation
/// is faulty counts as defined, so that it is reported once.
pub(crate) fn declare_equation_block<'a>(cx: &mut Body<'_, 'a>, means: &'a Desugared) {
    for fault in &means.errors {
        report::report_diagnostic(cx, block_diagnostic(fault));
    }
    let names = means.errors.iter().filter_map(|fault| match fault {
        BlockError::MissingDefinition(name, _) | BlockError::NotInFrame(name) => Some(&name.name),
        _ => None,
    });
    let faulty: Vec<_> = names.collect();
    for (equation, span) in &means.equations {
        let is_faulty = equation
            .targets
            .iter()
            .any(|target| faulty.contains(&&target.name.name));
        match is_faulty {
            true => {
                let flows = equation.targets.iter();
                let flows: Vec<_> = flows.filter_map(|t| cx.find_flow(&t.name.name)).collect();
                cx.reported.erroneous_flows.extend(flows);
            }
            false => statement::declare_equation(cx, equation, *span),
        }
    }
}

/// Returns the diagnostic for an error in a block of equations.
fn block_diagnostic(fault: &BlockError) -> Diagnostic {
    match fault {
        BlockError::MissingDefinition(name, branch) => Diagnostic::new(
            Code::RPI1009,
            format!("`{}` is not defined in every branch", name.name),
        )
        .primary(name.span, "defined here")
        .secondary(*branch, "not defined in a branch of this condition")
        .help("add the equation, or use a `frame` to keep the value of the previous cycle"),
        BlockError::NotAnEquation(span, what) => Diagnostic::new(
            Code::RPI1014,
            format!("{what} is not allowed in a block of equations"),
        )
        .primary(*span, "expected an equation or a block of equations")
        .help("move it out of the block"),
        BlockError::NotInFrame(name) => Diagnostic::new(
            Code::RPI1014,
            format!("`{}` is not listed in the header of the `frame`", name.name),
        )
        .primary(name.span, "defined in the `frame`")
        .help("list it in the parentheses after `frame`, or define it outside"),
        BlockError::DuplicateDefinition(name, first) => {
            Diagnostic::new(Code::RPI1008, format!("`{}` is defined twice", name.name))
                .primary(name.span, "defined again here")
                .secondary(*first, "first defined here")
                .help("delete one of the two equations")
        }
    }
}
