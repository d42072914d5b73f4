//! Operators by their Lustre V6 names: `Lustre::plus` is the overloaded `+`, `Lustre::iplus` is `+` of integers.

use crate::check::calls::callable::Callable;
use crate::ty::Ty;
use crate::units::Dimension;
use rpi_syntax::ast::StaticOp;
use rpi_syntax::ops::{BinaryOp, UnaryOp};

/// Operator that can be called by its Lustre V6 name.
#[derive(Debug)]
pub(crate) struct PredefinedOp {
    name: &'static str,
    pub(crate) op: StaticOp,
    /// Type of all operands, and type of the result; `None` for an operator that accepts several types.
    types: Option<(OperandType, OperandType)>,
}

/// Type of the operands or of the result of an operator in the table of predefined operators.
#[derive(Clone, Copy, Debug)]
enum OperandType {
    Bool,
    Int,
    Real,
}

impl OperandType {
    fn resolve_type(self) -> Ty {
        match self {
            OperandType::Bool => Ty::Bool,
            OperandType::Int => Ty::Int,
            OperandType::Real => Ty::Real(Dimension::ONE),
        }
    }
}

const fn overloaded(name: &'static str, op: StaticOp) -> PredefinedOp {
    let types = None;
    PredefinedOp { name, op, types }
}

const fn monomorphic(
    name: &'static str,
    op: StaticOp,
    takes: OperandType,
    gives: OperandType,
) -> PredefinedOp {
    let types = Some((takes, gives));
    PredefinedOp { name, op, types }
}

use BinaryOp::{Add, And, Div, Eq, Ge, Gt, Implies, IntDiv, Le, Lt, Mod, Mul, Ne, Or, Sub, Xor};
use OperandType::{Bool, Int, Real};
use StaticOp::{Binary, Unary};

#[rustfmt::skip]
const PREDEFINED_OPS: &[PredefinedOp] = &[
    overloaded("plus", Binary(Add)),
    overloaded("minus", Binary(Sub)),
    overloaded("times", Binary(Mul)),
    overloaded("slash", Binary(Div)),
    overloaded("uminus", Unary(UnaryOp::Neg)),
    overloaded("eq", Binary(Eq)),
    overloaded("neq", Binary(Ne)),
    overloaded("lt", Binary(Lt)),
    overloaded("lte", Binary(Le)),
    overloaded("gt", Binary(Gt)),
    overloaded("gte", Binary(Ge)),
    overloaded("if", StaticOp::If),
    monomorphic("and", Binary(And), Bool, Bool),
    monomorphic("or", Binary(Or), Bool, Bool),
    monomorphic("xor", Binary(Xor), Bool, Bool),
    monomorphic("impl", Binary(Implies), Bool, Bool),
    monomorphic("not", Unary(UnaryOp::Not), Bool, Bool),
    monomorphic("div", Binary(IntDiv), Int, Int),
    monomorphic("mod", Binary(Mod), Int, Int),
    monomorphic("iplus", Binary(Add), Int, Int),
    monomorphic("iminus", Binary(Sub), Int, Int),
    monomorphic("itimes", Binary(Mul), Int, Int),
    monomorphic("islash", Binary(Div), Int, Int),
    monomorphic("iuminus", Unary(UnaryOp::Neg), Int, Int),
    monomorphic("ilt", Binary(Lt), Int, Bool),
    monomorphic("ilte", Binary(Le), Int, Bool),
    monomorphic("igt", Binary(Gt), Int, Bool),
    monomorphic("igte", Binary(Ge), Int, Bool),
    monomorphic("rplus", Binary(Add), Real, Real),
    monomorphic("rminus", Binary(Sub), Real, Real),
    monomorphic("rtimes", Binary(Mul), Real, Real),
    monomorphic("rslash", Binary(Div), Real, Real),
    monomorphic("ruminus", Unary(UnaryOp::Neg), Real, Real),
    monomorphic("rlt", Binary(Lt), Real, Bool),
    monomorphic("rlte", Binary(Le), Real, Bool),
    monomorphic("rgt", Binary(Gt), Real, Bool),
    monomorphic("rgte", Binary(Ge), Real, Bool),
    monomorphic("real2int", Unary(UnaryOp::ToInt), Real, Int),
    monomorphic("int2real", Unary(UnaryOp::ToReal), Int, Real),
];

/// Returns the operator with a Lustre V6 name such as `Lustre::iplus`; `None` if there is none. The conversions
/// `int2real` and `real2int` need no `Lustre::` prefix.
pub(crate) fn predefined_op(name: &str) -> Option<Callable> {
    let plain = name.strip_prefix("Lustre::");
    let name = plain.or_else(|| matches!(name, "int2real" | "real2int").then_some(name))?;
    let found = PREDEFINED_OPS.iter().find(|predef| predef.name == name);
    found.map(Callable::Predefined)
}

impl PredefinedOp {
    pub(crate) fn name(&self) -> String {
        format!("Lustre::{}", self.name)
    }

    /// Returns the types of the operands and the type of the result; `None` for an operator that accepts several types.
    pub(crate) fn signature(&self) -> Option<(Vec<Ty>, Ty)> {
        let (takes, gives) = self.types?;
        let count = match self.op {
            Unary(_) => 1,
            Binary(_) => 2,
            StaticOp::If => 3,
        };
        Some((vec![takes.resolve_type(); count], gives.resolve_type()))
    }
}
