//! Blocks of equations (`if`, `when`, `cond`, and `frame` of Kind 2). The parser has replaced each block by plain
//! equations; this module declares these and reports the block's errors.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::diagnostics::report;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{BlockError, Desugared, MissingBranch};

/// Reports the errors of a block of equations (`if`, `when`, `cond` or `frame`) that the parser has translated to plain
/// equations, and declares these equations. A flow whose equation has a reported error counts as defined, so that no
/// second error is reported for it.
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

/// Returns the diagnostic for an error in a block of equations (`if`, `when`, `cond` or `frame`).
fn block_diagnostic(fault: &BlockError) -> Diagnostic {
    match fault {
        BlockError::MissingDefinition(name, branch) => {
            missing_definition(&name.name, name.span, *branch)
        }
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
        .help(format!(
            "list `{}` in the parentheses after `frame`, or define it outside of the block",
            name.name
        )),
        BlockError::DuplicateDefinition(name, first) => {
            Diagnostic::new(Code::RPI1008, format!("`{}` is defined twice", name.name))
                .primary(name.span, "defined again here")
                .secondary(*first, "first defined here")
                .help("delete one of the two equations")
        }
    }
}

/// Returns the diagnostic for a flow without a definition in one branch of a block.
fn missing_definition(name: &Name, defined: Span, branch: MissingBranch) -> Diagnostic {
    let message = format!("`{name}` is not defined in every branch");
    let diagnostic = Diagnostic::new(Code::RPI1009, message).primary(defined, "defined here");
    let (diagnostic, place) = match branch {
        MissingBranch::Condition(span) => (
            diagnostic.secondary(
                span,
                format!("the branch of this condition has no `{name} = ...;`"),
            ),
            "to this branch",
        ),
        MissingBranch::Else(span) => (
            diagnostic.secondary(span, format!("this `else` branch has no `{name} = ...;`")),
            "to the `else`",
        ),
        MissingBranch::NoElse(span) => (
            diagnostic.secondary(
                span,
                format!("without an `else`, `{name}` has no value if no condition holds"),
            ),
            "in an `else`",
        ),
    };
    diagnostic.help(format!(
        "add `{name} = ...;` {place}; to keep the previous value of `{name}` instead, put the block into `frame ({name}) {name} = ...; let ... tel`"
    ))
}
