//! What needs arguments or values that nobody gives, checked all the same: types by types of which nothing is known, sizes by
//! a small number. It never runs, so only what does not depend on the choice is reported.

use super::statics::{Param, Static, Statics};
use super::{Checker, Constant};
use crate::program::{DeclId, DeclKind};
use crate::ty::{StructTy, Ty};
use crate::typed::Leaf;
use rpi_diag::{Code, Finding};
use rpi_syntax::Name;
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

/// A value of a type that stands for one from outside.
pub(super) fn value(ty: &Ty) -> Option<Rc<[Leaf]>> {
    Some(match ty {
        Ty::Bool => [Leaf::bool(false)].into(),
        Ty::Int | Ty::Enum(_) => [Leaf::int(if *ty == Ty::Int { SIZE } else { 0 })].into(),
        Ty::Real(_) => [Leaf::real(1.0)].into(),
        Ty::Array(element, n) => {
            let one = value(element)?;
            let all = std::iter::repeat_n(one.iter().cloned(), *n as usize);
            all.flatten().collect()
        }
        _ => return None,
    })
}

impl Checker<'_> {
    /// Checks the Lustre nodes that nobody calls and that need static arguments.
    pub(super) fn check_samples(&mut self) {
        for id in self.program.root().decls.clone() {
            if self.called.contains(&id) || !self.is_lustre(id) {
                continue;
            }
            let before = self.findings.len();
            if let Some(statics) = self.sample(id)
                && let Some(header) = self.header(id, Rc::new(statics))
            {
                self.unit(&header, header.span);
                self.check_queued();
            }
            let found = self.findings.split_off(before);
            let found = found
                .into_iter()
                .filter(|finding| !may_be_its_fault(finding));
            self.findings
                .extend(found.filter(|finding| finding.code != Code::RPI1012));
        }
    }

    /// Static arguments for a declaration; none if it needs none, or something to call.
    fn sample(&mut self, id: DeclId) -> Option<Statics> {
        let DeclKind::Node(node) = self.program.decl(id).kind else {
            return None;
        };
        // Those of Lustre V6, `<<type t>>`, are like text that is put in: nothing can be said of them.
        let of_kind2 = |param: &StaticParam| matches!(&param.kind, StaticParamKind::Type(name) if name.span == param.span);
        if !node.signature.statics.iter().all(of_kind2) {
            return None;
        }
        let params = self.params_of(id);
        let mut statics = Statics::new();
        for param in &params {
            let name = param.name().name.clone();
            let sample = match param {
                Param::Type(_) => Static::Ty(nothing_known(&name)),
                Param::Value(_, def) => {
                    let ty = self.static_ty(id, def, &statics);
                    let leaves = value(&ty)?;
                    Static::Value(Constant { ty, leaves })
                }
                Param::Node(_) => return None,
            };
            statics.insert(name, sample);
        }
        (!params.is_empty()).then_some(statics)
    }
}

fn nothing_known(name: &Name) -> Ty {
    Ty::Struct(Rc::new(StructTy {
        name: name.clone(),
        fields: Vec::new(),
        defaults: Vec::new(),
    }))
}
