//! What needs arguments or values that nobody gives, checked all the same: types by types of which nothing is known, sizes by
//! a small number. It never runs, so only what does not depend on the choice is reported: of a `.rpi` declaration, what
//! is wrong with its names and with types that are known.

use super::statics::{Param, Static, Statics, tells_apart};
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

/// Whether a finding about a sample is one about what it is a sample of.
fn is_its_fault(finding: &Finding) -> bool {
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
            | Code::RPI2001
            | Code::RPI2002
            | Code::RPI2003
            | Code::RPI2006
            | Code::RPI3005
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
    /// Checks the nodes that nobody calls and that need static arguments.
    pub(super) fn check_samples(&mut self) {
        for id in self.program.root().decls.clone() {
            if self.called.contains(&id) {
                continue;
            }
            let before = self.findings.len();
            let (sample, is_told): (_, fn(&Finding) -> bool) = match self.is_lustre(id) {
                true => (self.sample(id), is_its_fault),
                false => (self.unknown(id), is_about_text),
            };
            if let Some(statics) = sample
                && let Some(header) = self.header(id, Rc::new(statics))
            {
                self.unit(&header, header.span);
                self.check_queued();
            }
            let found = self.findings.split_off(before);
            self.findings.extend(found.into_iter().filter(is_told));
        }
    }

    /// Static arguments of which as little as possible is known; none if it needs none, or something to call.
    fn unknown(&mut self, id: DeclId) -> Option<Statics> {
        let params = self.params_of(id);
        let mut statics = Statics::new();
        for param in &params {
            let unknown = match param {
                Param::Type(_) => Static::Ty(Ty::Unknown),
                Param::Value(_, def) => {
                    let ty = self.static_ty(id, def, &statics);
                    match value(&ty).filter(|_| tells_apart(&ty)) {
                        Some(leaves) => Static::Value(Constant { ty, leaves }),
                        None => Static::Opaque,
                    }
                }
                Param::Node(_) => return None,
            };
            statics.insert(param.name().name.clone(), unknown);
        }
        (!params.is_empty()).then_some(statics)
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
