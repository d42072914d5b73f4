//! Operators by their Lustre V6 names: `Lustre::plus` is the overloaded `+`, `Lustre::iplus` is `+` of integers.

use crate::check::calls::callable::Callable;
use crate::ty::Ty;
use crate::units::Dim;
use rpi_syntax::ast::StaticOp;
use rpi_syntax::ops::{BinaryOp, UnaryOp};

/// An operator with its Lustre V6 name.
#[derive(Debug)]
pub(crate) struct Predef {
    name: &'static str,
    pub(crate) op: StaticOp,
    /// Operand type and result type; `None` for an overloaded operator.
    types: Option<(Of, Of)>,
}

/// Operand or result type of an operator.
#[derive(Clone, Copy, Debug)]
enum Of {
    Bool,
    Int,
    Real,
}

impl Of {
    fn ty(self) -> Ty {
        match self {
            Of::Bool => Ty::Bool,
            Of::Int => Ty::Int,
            Of::Real => Ty::Real(Dim::ONE),
        }
    }
}

const fn any(name: &'static str, op: StaticOp) -> Predef {
    let types = None;
    Predef { name, op, types }
}

const fn typed(name: &'static str, op: StaticOp, takes: Of, gives: Of) -> Predef {
    let types = Some((takes, gives));
    Predef { name, op, types }
}

use BinaryOp::{Add, And, Div, Eq, Ge, Gt, Implies, IntDiv, Le, Lt, Mod, Mul, Ne, Or, Sub, Xor};
use Of::{Bool, Int, Real};
use StaticOp::{Binary, Unary};

#[rustfmt::skip]
const PREDEFS: &[Predef] = &[
    any("plus", Binary(Add)),
    any("minus", Binary(Sub)),
    any("times", Binary(Mul)),
    any("slash", Binary(Div)),
    any("uminus", Unary(UnaryOp::Neg)),
    any("eq", Binary(Eq)),
    any("neq", Binary(Ne)),
    any("lt", Binary(Lt)),
    any("lte", Binary(Le)),
    any("gt", Binary(Gt)),
    any("gte", Binary(Ge)),
    any("if", StaticOp::If),
    typed("and", Binary(And), Bool, Bool),
    typed("or", Binary(Or), Bool, Bool),
    typed("xor", Binary(Xor), Bool, Bool),
    typed("impl", Binary(Implies), Bool, Bool),
    typed("not", Unary(UnaryOp::Not), Bool, Bool),
    typed("div", Binary(IntDiv), Int, Int),
    typed("mod", Binary(Mod), Int, Int),
    typed("iplus", Binary(Add), Int, Int),
    typed("iminus", Binary(Sub), Int, Int),
    typed("itimes", Binary(Mul), Int, Int),
    typed("islash", Binary(Div), Int, Int),
    typed("iuminus", Unary(UnaryOp::Neg), Int, Int),
    typed("ilt", Binary(Lt), Int, Bool),
    typed("ilte", Binary(Le), Int, Bool),
    typed("igt", Binary(Gt), Int, Bool),
    typed("igte", Binary(Ge), Int, Bool),
    typed("rplus", Binary(Add), Real, Real),
    typed("rminus", Binary(Sub), Real, Real),
    typed("rtimes", Binary(Mul), Real, Real),
    typed("rslash", Binary(Div), Real, Real),
    typed("ruminus", Unary(UnaryOp::Neg), Real, Real),
    typed("rlt", Binary(Lt), Real, Bool),
    typed("rlte", Binary(Le), Real, Bool),
    typed("rgt", Binary(Gt), Real, Bool),
    typed("rgte", Binary(Ge), Real, Bool),
    typed("real2int", Unary(UnaryOp::ToInt), Real, Int),
    typed("int2real", Unary(UnaryOp::ToReal), Int, Real),
];

/// Returns the operator of a name. The conversions `int2real` and `real2int` need no `Lustre::` prefix.
pub(crate) fn operator(name: &str) -> Option<Callable> {
    let plain = name.strip_prefix("Lustre::");
    let name = plain.or_else(|| matches!(name, "int2real" | "real2int").then_some(name))?;
    let found = PREDEFS.iter().find(|predef| predef.name == name);
    found.map(Callable::Predef)
}

impl Predef {
    pub(crate) fn name(&self) -> String {
        format!("Lustre::{}", self.name)
    }

    /// Returns the operand types and the result type; `None` for an overloaded operator.
    pub(crate) fn signature(&self) -> Option<(Vec<Ty>, Ty)> {
        let (takes, gives) = self.types?;
        let count = match self.op {
            Unary(_) => 1,
            Binary(_) => 2,
            StaticOp::If => 3,
        };
        Some((vec![takes.ty(); count], gives.ty()))
    }
}
