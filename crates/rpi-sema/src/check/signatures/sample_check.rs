//! Checks callables with static parameters that are never called, with sample arguments: unknown types, and a small
//! number for sizes. A sample never runs, so that only errors that do not depend on the arguments are reported; in RPI
//! text these are errors in names and in known types.

use crate::check::calls::callable::Callable;
use crate::check::signatures::constraint::opaque_type;
use crate::check::signatures::header;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::check::signatures::static_params::distinguishes_instances;
use crate::check::signatures::unit;
use crate::check::{Checker, Constant};
use crate::program::{DeclId, DeclKind};
use crate::ty::Ty;
use crate::typed::Leaf;
use rpi_diag::suppression::Cause;
use rpi_diag::{Code, Diagnostic, Severity};
use rpi_syntax::ast::{StaticParam, StaticParamKind};
use std::rc::Rc;

/// Sample value for a size parameter without an argument, with which the body is checked.
const SAMPLE_SIZE: i64 = 4;

/// Whether a diagnostic about a callable that was checked with sample arguments applies to the declaration itself,
/// whatever the arguments are.
pub(crate) fn is_sample_independent(diagnostic: &Diagnostic) -> bool {
    !Cause::SampleValue.explains(diagnostic) && diagnostic.code != Code::RPI1012
}

/// Whether a diagnostic has a code for errors in names or known types, which do not depend on the arguments of a call.
fn is_argument_independent(diagnostic: &Diagnostic) -> bool {
    matches!(
        diagnostic.code,
        Code::RPI1001
            | Code::RPI1002
            | Code::RPI1003
            | Code::RPI1005
            | Code::RPI1008
            | Code::RPI1009
            | Code::RPI1010
            | Code::RPI2001
            | Code::RPI2002
            | Code::RPI2003
            | Code::RPI2006
            | Code::RPI3005
    )
}

/// Adds a note about the sample size to a diagnostic whose message contains an array type of this size.
fn with_sample_size_note(diagnostic: Diagnostic) -> Diagnostic {
    // Array types are printed as `int^4`. A message with this text for another reason only gets a needless note.
    match diagnostic.message.contains(&format!("^{SAMPLE_SIZE}")) {
        true => diagnostic.note(format!("checked with {SAMPLE_SIZE} for each unknown size")),
        false => diagnostic,
    }
}

/// Changes an error in a Lustre V6 callable that is never called to a warning. `name` is the callable.
fn as_uncalled_warning(diagnostic: Diagnostic, name: &str) -> Diagnostic {
    let warning = Diagnostic {
        code: Code::RPI1015,
        ..diagnostic
    };
    warning.note(format!(
        "`{name}` is never called, so the program still runs; any call of `{name}` would be an error"
    ))
}

/// Returns a sample value of a type, as the values of its leaves (scalar parts); `None` for types without one, such as
/// structs.
pub(crate) fn sample_value(ty: &Ty) -> Option<Rc<[Leaf]>> {
    Some(match ty {
        Ty::Bool => [Leaf::bool(false)].into(),
        Ty::Machine(_) => [Leaf::int(0)].into(),
        Ty::Subrange(range) => [Leaf::int(range.clamp(SAMPLE_SIZE))].into(),
        Ty::Int | Ty::Enum(_) => [Leaf::int(if *ty == Ty::Int { SAMPLE_SIZE } else { 0 })].into(),
        Ty::Real(_) | Ty::Duration => [Leaf::real(1.0)].into(),
        Ty::Array(element, n) => {
            let one = sample_value(element)?;
            let all = std::iter::repeat_n(one.iter().cloned(), *n as usize);
            all.flatten().collect()
        }
        _ => return None,
    })
}

/// Checks callables of the first module that need static arguments and are never called, using sample arguments. Checks
/// the port types of static parameters that stand for nodes as well.
pub(crate) fn check_samples(checker: &mut Checker<'_>) {
    for id in checker.program.root().decls.clone() {
        if static_params::static_params_of_decl(checker, id).is_empty() {
            continue;
        }
        let before = checker.diagnostics.len();
        let is_of_kind2 = is_kind2_only(checker, id);
        let is_checked = !checker.is_lustre(id) && has_type_params(checker, id);
        let (sample, is_reported): (_, fn(&Diagnostic) -> bool) = match (is_of_kind2, is_checked) {
            (true, _) => (sample_statics(checker, id), is_sample_independent),
            // `generic.rs` checks these bodies for all types that satisfy the constraints.
            (_, true) => (Some(unknown_statics(checker, id)), |_| false),
            _ => (Some(unknown_statics(checker, id)), is_argument_independent),
        };
        if let Some(statics) = sample.map(Rc::new) {
            check_sample(checker, id, statics);
        }
        let is_warning_only = checker.is_lustre(id) && !is_of_kind2;
        let found = checker.diagnostics.split_off(before).into_iter();
        let found = found.filter(is_reported).map(with_sample_size_note);
        let found = found.map(|diagnostic| match is_warning_only {
            true => without_error_severity(diagnostic, &checker.program.decl(id).name),
            false => diagnostic,
        });
        checker.diagnostics.extend(found);
    }
}

/// Changes an error in the callable `name`, which is never called, to a warning. Warnings and notes remain unchanged.
fn without_error_severity(diagnostic: Diagnostic, name: &str) -> Diagnostic {
    match diagnostic.severity() {
        Severity::Error => as_uncalled_warning(diagnostic, name),
        _ => diagnostic,
    }
}

fn check_sample(checker: &mut Checker<'_>, id: DeclId, statics: Rc<StaticBindings>) {
    static_params::check_node_params(checker, id, &statics);
    if checker.instances.called.contains(&id) {
        return;
    }
    if let Some(header) = header::check_header(checker, id, statics) {
        unit::instantiate(checker, &header, header.span);
        unit::check_queued(checker);
    }
}

/// Whether a declaration is a generic node of Kind 2, `<<T>>`, whose type parameters stand for unknown types. Type
/// parameters of Lustre V6, `<<type t>>`, are replaced as text.
fn is_kind2_only(checker: &Checker<'_>, id: DeclId) -> bool {
    let of_kind2 = |param: &StaticParam| matches!(&param.kind, StaticParamKind::Type(name, _) if name.span == param.span);
    match checker.program.decl(id).kind {
        DeclKind::Node(node) if checker.is_lustre(id) => {
            node.signature.statics.iter().all(of_kind2)
        }
        _ => false,
    }
}

fn has_type_params(checker: &Checker<'_>, id: DeclId) -> bool {
    let params = static_params::static_params_of_decl(checker, id);
    params
        .iter()
        .any(|param| matches!(param, StaticParamDecl::Type(..)))
}

/// Returns static arguments for checking declaration `id` without a call: unknown types, sample sizes, and nodes of
/// which only the ports are known.
pub(crate) fn unknown_statics(checker: &mut Checker<'_>, id: DeclId) -> StaticBindings {
    let mut statics = StaticBindings::new();
    for param in static_params::static_params_of_decl(checker, id) {
        let unknown = match param {
            StaticParamDecl::Type(..) => StaticBinding::Type(Ty::Unknown),
            StaticParamDecl::Value(_, def) => {
                let ty = static_params::static_param_type(checker, id, def, &statics);
                match sample_value(&ty).filter(|_| distinguishes_instances(&ty)) {
                    Some(leaves) => StaticBinding::Value(Constant { ty, leaves }),
                    None => StaticBinding::LoadTime,
                }
            }
            StaticParamDecl::Node(signature) => {
                let header = header::node_param_header(checker, id, &statics, signature);
                StaticBinding::Callable(Callable::NodeParam(Rc::new(header)), None)
            }
        };
        statics.insert(param.name().name.clone(), unknown);
    }
    statics
}

/// Returns static arguments for checking a generic node of Kind 2: types that are equal to themselves only, and sample
/// values. `None` if a parameter stands for a node or has a type without sample values.
fn sample_statics(checker: &mut Checker<'_>, id: DeclId) -> Option<StaticBindings> {
    let mut statics = StaticBindings::new();
    for param in static_params::static_params_of_decl(checker, id) {
        let name = param.name().name.clone();
        let sample = match param {
            StaticParamDecl::Type(..) => StaticBinding::Type(opaque_type(&name)),
            StaticParamDecl::Value(_, def) => {
                let ty = static_params::static_param_type(checker, id, def, &statics);
                let leaves = sample_value(&ty)?;
                StaticBinding::Value(Constant { ty, leaves })
            }
            StaticParamDecl::Node(_) => return None,
        };
        statics.insert(name, sample);
    }
    Some(statics)
}
