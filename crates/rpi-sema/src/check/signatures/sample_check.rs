//! Checks callables with static parameters that are never called, with sample arguments: unknown types, and a small
//! number for sizes. A sample never runs, so that only errors that do not depend on the arguments are reported; in RPI
//! text these are errors in names and in known types.

use crate::check::calls::callable::Callable;
use crate::check::signatures::constraint::nothing_known;
use crate::check::signatures::header;
use crate::check::signatures::static_args::Static;
use crate::check::signatures::static_args::Statics;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::Param;
use crate::check::signatures::static_params::tells_apart;
use crate::check::signatures::unit;
use crate::check::{Checker, Constant};
use crate::program::{DeclId, DeclKind};
use crate::ty::Ty;
use crate::typed::Leaf;
use rpi_diag::{Code, Finding, Severity};
use rpi_syntax::ast::{StaticParam, StaticParamKind};
use std::rc::Rc;

/// Sample value of a size.
const SIZE: i64 = 4;

/// Whether a diagnostic may be caused by the sample size alone.
pub(crate) fn may_be_its_fault(finding: &Finding) -> bool {
    matches!(
        finding.code,
        Code::RPI1011 | Code::RPI2009 | Code::RPI2010 | Code::RPI2012
    )
}

/// Whether a diagnostic about a sample applies to the declaration itself.
pub(crate) fn is_its_fault(finding: &Finding) -> bool {
    !may_be_its_fault(finding) && finding.code != Code::RPI1012
}

/// Whether a diagnostic is about names or known types, which do not depend on the arguments.
fn is_about_text(finding: &Finding) -> bool {
    matches!(
        finding.code,
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

/// Adds a note about the sample size if the message contains it.
fn says_its_size(finding: Finding) -> Finding {
    // Array types are printed as `int^4`. A message with this text for another reason only gets a needless note.
    match finding.message.contains(&format!("^{SIZE}")) {
        true => finding.note(format!("checked with {SIZE} for each unknown size")),
        false => finding,
    }
}

/// Turns an error in a Lustre V6 callable that is never called into a warning.
fn weighs_less(finding: Finding) -> Finding {
    let told = Finding {
        code: Code::RPI1015,
        ..finding
    };
    told.note("it is never called, so the program still runs; any call to it would be an error")
}

/// Returns a sample value of a type; `None` if there is none.
pub(crate) fn value(ty: &Ty) -> Option<Rc<[Leaf]>> {
    Some(match ty {
        Ty::Bool => [Leaf::bool(false)].into(),
        Ty::Machine(_) => [Leaf::int(0)].into(),
        Ty::Subrange(range) => [Leaf::int(range.nearest(SIZE))].into(),
        Ty::Int | Ty::Enum(_) => [Leaf::int(if *ty == Ty::Int { SIZE } else { 0 })].into(),
        Ty::Real(_) | Ty::Duration => [Leaf::real(1.0)].into(),
        Ty::Array(element, n) => {
            let one = value(element)?;
            let all = std::iter::repeat_n(one.iter().cloned(), *n as usize);
            all.flatten().collect()
        }
        _ => return None,
    })
}

/// Checks callables that need static arguments and are never called, and the node parameters of all generic
/// callables.
pub(crate) fn check_samples(checker: &mut Checker<'_>) {
    for id in checker.program.root().decls.clone() {
        if static_params::static_params_of(checker, id).is_empty() {
            continue;
        }
        let before = checker.findings.len();
        let is_of_kind2 = is_kind2_only(checker, id);
        let is_checked = !checker.is_lustre(id) && has_type_params(checker, id);
        let (sample, is_told): (_, fn(&Finding) -> bool) = match (is_of_kind2, is_checked) {
            (true, _) => (sample_statics(checker, id), is_its_fault),
            // `generic.rs` checks these bodies for all types that satisfy the constraints.
            (_, true) => (Some(unknown_statics(checker, id)), |_| false),
            _ => (Some(unknown_statics(checker, id)), is_about_text),
        };
        if let Some(statics) = sample.map(Rc::new) {
            check_sample(checker, id, statics);
        }
        let is_text = checker.is_lustre(id) && !is_of_kind2;
        let found = checker.findings.split_off(before).into_iter();
        let found = found.filter(is_told).map(says_its_size);
        let weighed = found.map(
            |finding| match is_text && finding.severity() == Severity::Error {
                true => weighs_less(finding),
                false => finding,
            },
        );
        checker.findings.extend(weighed);
    }
}

fn check_sample(checker: &mut Checker<'_>, id: DeclId, statics: Rc<Statics>) {
    static_params::check_node_params(checker, id, &statics);
    if checker.instances.called.contains(&id) {
        return;
    }
    if let Some(header) = header::check_header(checker, id, statics) {
        unit::instantiate(checker, &header, header.span);
        unit::check_queued(checker);
    }
}

/// Whether a declaration is a generic node of Kind 2, `<<T>>`, whose types are opaque. Types of Lustre V6,
/// `<<type t>>`, behave like text substitution.
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
    let params = static_params::static_params_of(checker, id);
    params.iter().any(|param| matches!(param, Param::Type(..)))
}

/// Returns static arguments of which as little as possible is known.
pub(crate) fn unknown_statics(checker: &mut Checker<'_>, id: DeclId) -> Statics {
    let mut statics = Statics::new();
    for param in static_params::static_params_of(checker, id) {
        let unknown = match param {
            Param::Type(..) => Static::Ty(Ty::Unknown),
            Param::Value(_, def) => {
                let ty = static_params::static_param_type(checker, id, def, &statics);
                match value(&ty).filter(|_| tells_apart(&ty)) {
                    Some(leaves) => Static::Value(Constant { ty, leaves }),
                    None => Static::Opaque,
                }
            }
            Param::Node(signature) => {
                let header = header::node_param_header(checker, id, &statics, signature);
                Static::Callee(Callable::Open(Rc::new(header)), None)
            }
        };
        statics.insert(param.name().name.clone(), unknown);
    }
    statics
}

/// Returns opaque types and sample values as static arguments; `None` for node parameters and types without sample
/// values.
fn sample_statics(checker: &mut Checker<'_>, id: DeclId) -> Option<Statics> {
    let mut statics = Statics::new();
    for param in static_params::static_params_of(checker, id) {
        let name = param.name().name.clone();
        let sample = match param {
            Param::Type(..) => Static::Ty(nothing_known(&name)),
            Param::Value(_, def) => {
                let ty = static_params::static_param_type(checker, id, def, &statics);
                let leaves = value(&ty)?;
                Static::Value(Constant { ty, leaves })
            }
            Param::Node(_) => return None,
        };
        statics.insert(name, sample);
    }
    Some(statics)
}
