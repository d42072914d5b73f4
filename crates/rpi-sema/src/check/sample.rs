//! What needs arguments or values that nobody gives, checked all the same: types by types of which nothing is known, sizes by
//! a small number. It never runs, so only what does not depend on the choice is reported: of a `.rpi` declaration, what
//! is wrong with its names and with types that are known.

use super::callable::Callable;
use super::constraint::nothing_known;
use super::statics::{Param, Static, Statics, tells_apart};
use super::{Checker, Constant};
use crate::program::{DeclId, DeclKind};
use crate::ty::Ty;
use crate::typed::Leaf;
use rpi_diag::{Code, Finding, Severity};
use rpi_syntax::ast::{StaticParam, StaticParamKind};
use std::rc::Rc;

/// The number that stands for a size.
const SIZE: i64 = 4;

/// Whether a finding may only be due to the number chosen.
pub(super) fn may_be_its_fault(finding: &Finding) -> bool {
    matches!(
        finding.code,
        Code::RPI1011 | Code::RPI2009 | Code::RPI2010 | Code::RPI2012
    )
}

/// Whether a finding about a sample is one about what it is a sample of.
pub(super) fn is_its_fault(finding: &Finding) -> bool {
    !may_be_its_fault(finding) && finding.code != Code::RPI1012
}

/// Whether a finding is about names, or types that are known: these are the same whatever is given.
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

/// Says where a size in its words comes from.
fn says_its_size(finding: Finding) -> Finding {
    match finding.message.contains(&format!("^{SIZE}")) {
        true => finding.note(format!(
            "checked with {SIZE} for each size that is left open"
        )),
        false => finding,
    }
}

/// What nobody calls is no part of a program of Lustre V6.
fn weighs_less(finding: Finding) -> Finding {
    let told = Finding {
        code: Code::RPI1015,
        ..finding
    };
    told.note("nothing calls it, so the program runs; a call would be refused, whatever it gives")
}

/// A value of a type that stands for one from outside.
pub(super) fn value(ty: &Ty) -> Option<Rc<[Leaf]>> {
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

impl Checker<'_> {
    /// Checks what nobody calls and what needs static arguments; and the nodes that are wanted as such, in any case.
    pub(super) fn check_samples(&mut self) {
        for id in self.program.root().decls.clone() {
            if self.params_of(id).is_empty() {
                continue;
            }
            let before = self.findings.len();
            let is_of_kind2 = self.is_of_kind2(id);
            let is_checked = !self.is_lustre(id) && self.has_type_params(id);
            let (sample, is_told): (_, fn(&Finding) -> bool) = match (is_of_kind2, is_checked) {
                (true, _) => (self.sample(id), is_its_fault),
                // For all types that its constraints admit.
                (_, true) => (Some(self.unknown(id)), |_| false),
                _ => (Some(self.unknown(id)), is_about_text),
            };
            if let Some(statics) = sample.map(Rc::new) {
                self.check_sample(id, statics);
            }
            let is_text = self.is_lustre(id) && !is_of_kind2;
            let found = self.findings.split_off(before).into_iter();
            let found = found.filter(is_told).map(says_its_size);
            let weighed =
                found.map(
                    |finding| match is_text && finding.severity() == Severity::Error {
                        true => weighs_less(finding),
                        false => finding,
                    },
                );
            self.findings.extend(weighed);
        }
    }

    fn check_sample(&mut self, id: DeclId, statics: Rc<Statics>) {
        self.check_wanted_nodes(id, &statics);
        if self.called.contains(&id) {
            return;
        }
        if let Some(header) = self.header(id, statics) {
            self.unit(&header, header.span);
            self.check_queued();
        }
    }

    /// Whether it is a node of Kind 2, `<<T>>`, whose types are opaque. Those of Lustre V6, `<<type t>>`, are like text
    /// that is put in.
    fn is_of_kind2(&self, id: DeclId) -> bool {
        let of_kind2 = |param: &StaticParam| matches!(&param.kind, StaticParamKind::Type(name, _) if name.span == param.span);
        match self.program.decl(id).kind {
            DeclKind::Node(node) if self.is_lustre(id) => {
                node.signature.statics.iter().all(of_kind2)
            }
            _ => false,
        }
    }

    fn has_type_params(&self, id: DeclId) -> bool {
        let params = self.params_of(id);
        params.iter().any(|param| matches!(param, Param::Type(..)))
    }

    /// Static arguments of which as little as possible is known.
    pub(super) fn unknown(&mut self, id: DeclId) -> Statics {
        let mut statics = Statics::new();
        for param in self.params_of(id) {
            let unknown = match param {
                Param::Type(..) => Static::Ty(Ty::Unknown),
                Param::Value(_, def) => {
                    let ty = self.static_ty(id, def, &statics);
                    match value(&ty).filter(|_| tells_apart(&ty)) {
                        Some(leaves) => Static::Value(Constant { ty, leaves }),
                        None => Static::Opaque,
                    }
                }
                Param::Node(signature) => {
                    let header = self.open_header(id, &statics, signature);
                    Static::Callee(Callable::Open(Rc::new(header)), None)
                }
            };
            statics.insert(param.name().name.clone(), unknown);
        }
        statics
    }

    /// Types of which nothing is known and a small number for sizes; none if a value of its type cannot be had.
    fn sample(&mut self, id: DeclId) -> Option<Statics> {
        let mut statics = Statics::new();
        for param in self.params_of(id) {
            let name = param.name().name.clone();
            let sample = match param {
                Param::Type(..) => Static::Ty(nothing_known(&name)),
                Param::Value(_, def) => {
                    let ty = self.static_ty(id, def, &statics);
                    let leaves = value(&ty)?;
                    Static::Value(Constant { ty, leaves })
                }
                Param::Node(_) => return None,
            };
            statics.insert(name, sample);
        }
        Some(statics)
    }
}
