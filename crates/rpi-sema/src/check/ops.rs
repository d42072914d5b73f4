//! Operators: the primitive for each combination of operand types, and the result type.

use super::body::Body;
use super::guess::{binary_guess, guess_by_number, unary_guess};
use super::quantity;
use super::report::Wanted;
use super::types::{FOREIGN, is_foreign};
use crate::ty::{Geometry, Ty, join};
use crate::typed::{Each, ExprId, Kind, Leaf, Unit, UnitKind};
use crate::units::{Dim, Ratio};
use rpi_diag::{Code, Finding, Span};
use rpi_image::Scalar;
use rpi_net::prim;
use rpi_prims::PrimId;
use rpi_syntax::ast::{self, Binary, ExprKind};
use rpi_syntax::ops::{BinaryOp, Grouping, UnaryOp};
use std::rc::Rc;

/// Rule that derives the result type of an operator from its operand types.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Rule {
    /// Operands of the same type; the result has this type, too.
    Same,
    /// Operands of the same type; the result is a Boolean.
    Test,
    /// Product: the dimensions are multiplied.
    Times,
    /// Quotient: the dimensions are divided.
    Over,
    /// Power with a constant exponent.
    Power,
    /// Composition of frames, `(b in a) * (c in b)`.
    Compose,
    /// Point in time plus seconds; the result is a point in time.
    Moment,
    /// Difference of two points in time; the result is in seconds.
    Seconds,
}

/// Overload of an operator: the primitive for operands of given machine types.
struct Row {
    op: BinaryOp,
    left: Scalar,
    right: Scalar,
    prim: PrimId,
    /// Whether the primitive takes the right operand first.
    swapped: bool,
    rule: Rule,
}

const fn row(
    op: BinaryOp,
    (left, right): (Scalar, Scalar),
    prim: PrimId,
    swapped: bool,
    rule: Rule,
) -> Row {
    Row {
        op,
        left,
        right,
        prim,
        swapped,
        rule,
    }
}

use BinaryOp::{Add, And, Div, Ge, Gt, Implies, IntDiv, Le, Lt, Mod, Mul, Or, Pow, Sub, Xor};
use Scalar::{Bool, Int, Pose, Real, Rotation, Time, Twist, Vector, Wrench};

/// All binary operators that map to one primitive.
#[rustfmt::skip]
const BINARY: &[Row] = &[
    row(And,     (Bool, Bool),         prim!("Core::BooleanAnd"),        false, Rule::Test),
    row(Or,      (Bool, Bool),         prim!("Core::BooleanOr"),         false, Rule::Test),
    row(Xor,     (Bool, Bool),         prim!("Rpi::BooleanXor"),         false, Rule::Test),
    row(Implies, (Bool, Bool),         prim!("Rpi::BooleanImplies"),     false, Rule::Test),
    row(Add,     (Int, Int),           prim!("Core::IntAdd"),            false, Rule::Same),
    row(Sub,     (Int, Int),           prim!("Rpi::IntSubtract"),        false, Rule::Same),
    row(Mul,     (Int, Int),           prim!("Core::IntMultiply"),       false, Rule::Same),
    row(Div,     (Int, Int),           prim!("Core::IntDivide"),         false, Rule::Same),
    row(IntDiv,  (Int, Int),           prim!("Core::IntDivide"),         false, Rule::Same),
    row(Mod,     (Int, Int),           prim!("Rpi::IntModulo"),          false, Rule::Same),
    row(Pow,     (Int, Int),           prim!("Rpi::IntPower"),           false, Rule::Same),
    row(Add,     (Real, Real),         prim!("Core::DoubleAdd"),         false, Rule::Same),
    row(Sub,     (Real, Real),         prim!("Rpi::DoubleSubtract"),     false, Rule::Same),
    row(Mul,     (Real, Real),         prim!("Core::DoubleMultiply"),    false, Rule::Times),
    row(Div,     (Real, Real),         prim!("Core::DoubleDivide"),      false, Rule::Over),
    row(Mod,     (Real, Real),         prim!("Core::DoubleModulo"),      false, Rule::Same),
    row(Pow,     (Real, Real),         prim!("Core::DoublePower"),       false, Rule::Power),
    row(Lt,      (Int, Int),           prim!("Core::IntGreater"),        true,  Rule::Test),
    row(Gt,      (Int, Int),           prim!("Core::IntGreater"),        false, Rule::Test),
    row(Le,      (Int, Int),           prim!("Rpi::IntGreaterOrEqual"),  true,  Rule::Test),
    row(Ge,      (Int, Int),           prim!("Rpi::IntGreaterOrEqual"),  false, Rule::Test),
    row(Lt,      (Real, Real),         prim!("Core::DoubleGreater"),     true,  Rule::Test),
    row(Gt,      (Real, Real),         prim!("Core::DoubleGreater"),     false, Rule::Test),
    row(Le,      (Real, Real),         prim!("Rpi::DoubleGreaterOrEqual"), true,  Rule::Test),
    row(Ge,      (Real, Real),         prim!("Rpi::DoubleGreaterOrEqual"), false, Rule::Test),
    row(Add,     (Vector, Vector),     prim!("World::VectorAdd"),        false, Rule::Same),
    row(Sub,     (Vector, Vector),     prim!("Rpi::VectorSubtract"),     false, Rule::Same),
    row(Mul,     (Vector, Real),       prim!("World::VectorScale"),      false, Rule::Times),
    row(Mul,     (Real, Vector),       prim!("World::VectorScale"),      true,  Rule::Times),
    row(Add,     (Twist, Twist),       prim!("World::TwistAdd"),         false, Rule::Same),
    row(Add,     (Wrench, Wrench),     prim!("Rpi::WrenchAdd"),          false, Rule::Same),
    row(Mul,     (Rotation, Rotation), prim!("World::RotationTransform"), false, Rule::Compose),
    row(Mul,     (Rotation, Vector),   prim!("World::VectorRotate"),     true,  Rule::Compose),
    row(Mul,     (Pose, Pose),         prim!("World::FrameTransform"),   false, Rule::Compose),
    row(Mul,     (Pose, Vector),       prim!("Rpi::FrameApply"),         false, Rule::Compose),
    row(Mul,     (Rotation, Twist),    prim!("World::TwistRotate"),      true,  Rule::Compose),
    row(Add,     (Time, Real),         prim!("Core::TimeAdd"),           false, Rule::Moment),
    row(Sub,     (Time, Time),         prim!("Core::TimeDiff"),          false, Rule::Seconds),
];

/// Ordering operators; their result is a Boolean.
pub(super) const TESTS: &[BinaryOp] = &[Lt, Le, Gt, Ge];

/// Division primitives, which are undefined for a right operand of 0.
const DIVISIONS: &[PrimId] = &[prim!("Core::IntDivide"), prim!("Rpi::IntModulo")];

/// All unary operators that map to one primitive.
#[rustfmt::skip]
const UNARY: &[(UnaryOp, Scalar, PrimId)] = &[
    (UnaryOp::Not,    Bool,   prim!("Core::BooleanNot")),
    (UnaryOp::Neg,    Int,    prim!("Rpi::IntNegate")),
    (UnaryOp::Neg,    Real,   prim!("Rpi::DoubleNegate")),
    (UnaryOp::Neg,    Vector, prim!("Rpi::VectorNegate")),
    (UnaryOp::ToInt,  Real,   prim!("Core::IntFromDouble")),
    (UnaryOp::ToReal, Int,    prim!("Core::DoubleFromInt")),
];

impl<'a> Body<'_, 'a> {
    /// Checks a unary operation `op operand`.
    pub(super) fn unary(&mut self, op: UnaryOp, operand: &'a ast::Expr, span: Span) -> ExprId {
        if let (UnaryOp::Neg, ExprKind::Number(number)) = (op, &operand.kind) {
            self.numbers.insert(span);
            return self.number(number, true, span);
        }
        match op {
            UnaryOp::Pre => self.pre(operand, span),
            UnaryOp::Last => self.last(operand, span),
            UnaryOp::Current => self.current_of(operand, span),
            _ => {
                let operand = self.expr(operand);
                self.unary_prim(op, operand, span)
            }
        }
    }

    /// Checks a unary operator on a checked operand.
    pub(super) fn unary_prim(&mut self, op: UnaryOp, operand: ExprId, span: Span) -> ExprId {
        if matches!(op, UnaryOp::ToReal | UnaryOp::ToInt) {
            self.in_seconds(operand);
        }
        let ty = self.ty_of(operand).clone();
        if ty.is_unknown() {
            return self.add(Kind::Fault, unary_guess(op), span);
        }
        if (op, &ty) == (UnaryOp::BitNot, &Ty::Bool) {
            return self.bits_of_boolean(operand, span);
        }
        if matches!(
            (op, &ty),
            (UnaryOp::ToInt, Ty::Int) | (UnaryOp::ToReal, Ty::Real(_))
        ) {
            return operand;
        }
        if op == UnaryOp::ToInt && matches!(ty, Ty::Real(_)) {
            let wanted = Wanted::By(Span::NONE, "an integer has no unit".into());
            self.expect(operand, &Ty::REAL, &wanted);
        }
        if let Ty::Machine(of) = ty
            && let Some(value) = self.machine_unary(op, operand, of, span)
        {
            return value;
        }
        if is_foreign(&ty, FOREIGN) && matches!(op, UnaryOp::Neg | UnaryOp::BitNot | UnaryOp::ToInt)
        {
            let ty = if op == UnaryOp::ToInt { Ty::Int } else { ty };
            return self.add(Kind::Outside, ty, span);
        }
        let kind = match &ty {
            Ty::Duration => Some(Int),
            ty => operand_kind(ty),
        };
        let row = UNARY.iter().find(|row| row.0 == op && Some(row.1) == kind);
        match row {
            Some((_, _, prim)) => {
                let ty = match op {
                    UnaryOp::Neg => ty,
                    _ => unary_guess(op),
                };
                self.prim_typed(*prim, &[operand], ty, span)
            }
            None => {
                let finding = Finding::new(
                    Code::RPI2006,
                    format!("`{}` cannot take `{ty}`", op.spelling()),
                )
                .at(self.span_of(operand), format!("this is `{ty}`"));
                let finding = quantity::operand_apart(finding, op, &ty);
                self.fault_with(finding, span)
            }
        }
    }

    fn pre(&mut self, operand: &'a ast::Expr, span: Span) -> ExprId {
        self.has_state(span);
        self.past += 1;
        let operand = self.expr(operand);
        self.past -= 1;
        let ty = self.ty_of(operand).clone();
        self.add(Kind::Each(Each::Pre, [operand].into()), ty, span)
    }

    /// Checks a binary operation `lhs op rhs`.
    pub(super) fn binary(&mut self, binary: &'a Binary, span: Span) -> ExprId {
        match binary.op {
            BinaryOp::Concat => self.concat(binary, span),
            BinaryOp::Append => self.append(binary, span),
            BinaryOp::Repeat => self.repeat(binary, span),
            BinaryOp::Coalesce => self.each_of_two(Each::Coalesce, binary, span),
            BinaryOp::Arrow => {
                self.has_state(span);
                self.each_of_two(Each::Arrow, binary, span)
            }
            BinaryOp::Fby => self.fby(binary, span),
            BinaryOp::In => self.is_in(&binary.lhs, &binary.rhs, span),
            op => {
                let (left, right) = (self.expr(&binary.lhs), self.expr(&binary.rhs));
                if TESTS.contains(&op) && self.is_unsampled(&binary.lhs, left) {
                    return self.fault(span);
                }
                if is_chained(binary) {
                    return self.add(Kind::Fault, Ty::Bool, span);
                }
                if let Some(meant) = self.misread(binary, [left, right], span) {
                    return meant;
                }
                self.binary_prim(op, left, right, span)
            }
        }
    }

    /// Whether the left side is an invalid sampled flow, as in `x when x > 0.0`. The comparison then reports no further
    /// error.
    fn is_unsampled(&self, lhs: &ast::Expr, left: ExprId) -> bool {
        matches!(lhs.kind, ExprKind::When(_)) && matches!(self.unit.expr(left).kind, Kind::Fault)
    }

    /// Whether an expression is the integer 0: a literal, or one operation on literals.
    fn is_zero(&mut self, id: ExprId) -> bool {
        let literal = |unit: &Unit, id: ExprId| matches!(unit.expr(id).kind, Kind::Literal(_));
        let known = match &self.unit.expr(id).kind {
            Kind::Literal(_) => true,
            Kind::Prim(call) => {
                let mut inputs = call.inputs.iter().flatten();
                inputs.all(|input| literal(&self.unit, *input))
            }
            _ => false,
        };
        let value = known.then(|| self.try_fold(id).ok()).flatten();
        value.is_some_and(|leaves| leaves.first().and_then(Leaf::as_int) == Some(0))
    }

    fn by_zero(&mut self, op: BinaryOp, divisor: ExprId) {
        let message = format!("`{}` by zero is undefined", op.spelling());
        let finding = Finding::new(Code::RPI2012, message)
            .at(self.span_of(divisor), "this is 0 in every cycle")
            .help("use a divisor other than 0");
        self.report(finding);
    }

    /// Extends the fix that writes the first integer of `x * 2 + 1` as a real to the other integers of the expression.
    fn is_real_too(&mut self, left: ExprId, right: ExprId) {
        let is_int = |body: &Self, id| body.is_number(id) && *body.ty_of(id) == Ty::Int;
        let (faulty, int) = match (is_int(self, left), is_int(self, right)) {
            (false, true) => (self.span_of(left), self.span_of(right)),
            (true, false) => (self.span_of(right), self.span_of(left)),
            _ => return,
        };
        let Some(finding) = self.made_real.and_then(|at| self.findings.get_mut(at)) else {
            return;
        };
        let place = finding.span();
        let is_inside = place.start >= faulty.start && place.end <= faulty.end;
        if let Some(fix) = finding.fixes.first_mut().filter(|_| is_inside) {
            *fix = fix.clone().insert_after(int, ".0");
        }
    }

    /// Checks a binary operator on checked operands.
    pub(super) fn binary_prim(
        &mut self,
        op: BinaryOp,
        left: ExprId,
        right: ExprId,
        span: Span,
    ) -> ExprId {
        if matches!(op, BinaryOp::Eq | BinaryOp::Ne) {
            return self.equal(op, left, right, span);
        }
        let (a, b) = (self.ty_of(left).clone(), self.ty_of(right).clone());
        if a.is_unknown() || b.is_unknown() {
            self.is_real_too(left, right);
            let guess = guess_by_number(self.guesses, op, &a, &b);
            let guess = guess.unwrap_or_else(|| binary_guess(op, &a, &b));
            // After errors on both sides, of arrays for instance, the result type cannot be guessed.
            let faulty = !self.inferring && a.is_unknown() && b.is_unknown();
            let guess = if faulty { Ty::Unknown } else { guess };
            return self.add(Kind::Fault, guess, span);
        }
        if let Some(value) = self.machine_binary(op, [left, right], span) {
            return value;
        }
        let shifts = matches!(op, BinaryOp::ShiftLeft | BinaryOp::ShiftRight) && b == Ty::Int;
        if is_foreign(&a, FOREIGN) && (a == b || shifts) {
            let ty = if TESTS.contains(&op) { Ty::Bool } else { a };
            return self.add(Kind::Outside, ty, span);
        }
        if let Some(of_times) = self.on_times(op, left, right, span) {
            return of_times;
        }
        let (a, b) = (self.ty_of(left).clone(), self.ty_of(right).clone());
        let kinds = (operand_kind(&a), operand_kind(&b));
        let fits = |row: &&Row| row.op == op && (Some(row.left), Some(row.right)) == kinds;
        let Some(row) = BINARY.iter().find(fits) else {
            return self.no_operator(op, left, right, span);
        };
        // The evaluation of a constant reports the division by zero itself.
        let is_run = self.unit.kind != UnitKind::Constant;
        if is_run && DIVISIONS.contains(&row.prim) && self.is_zero(right) {
            self.by_zero(op, right);
        }
        let ty = self.result_type(row, left, right);
        if ty.is_unknown() {
            return self.fault(span);
        }
        let operands = if row.swapped {
            [right, left]
        } else {
            [left, right]
        };
        self.prim_typed(row.prim, &operands, ty, span)
    }

    /// Adds a logical operation on checked Booleans.
    pub(super) fn logic(&mut self, prim: PrimId, operands: &[ExprId], span: Span) -> ExprId {
        self.prim_typed(prim, operands, Ty::Bool, span)
    }

    fn result_type(&mut self, row: &Row, left: ExprId, right: ExprId) -> Ty {
        let (a, b) = (self.ty_of(left).clone(), self.ty_of(right).clone());
        match row.rule {
            Rule::Same => self.joined(row.op, left, right),
            Rule::Test => {
                self.joined(row.op, left, right);
                Ty::Bool
            }
            Rule::Times => self.scaled(&a, &b, Dim::times, left),
            Rule::Over => self.scaled(&a, &b, Dim::over, left),
            Rule::Power => self.raised(&a, left, right),
            Rule::Compose => self.composed(left, right),
            Rule::Moment => {
                self.expect(right, &Ty::Real(Dim::TIME), &Wanted::Here);
                Ty::Time
            }
            Rule::Seconds => Ty::Real(Dim::TIME),
        }
    }

    fn joined(&mut self, op: BinaryOp, left: ExprId, right: ExprId) -> Ty {
        self.times_meet(left, right);
        let (a, b) = (self.ty_of(left).clone(), self.ty_of(right).clone());
        match (join(&a, &b), &a, &b) {
            (Ok(ty), ..) => {
                self.angle_has_unit(left, &ty);
                self.angle_has_unit(right, &ty);
                ty
            }
            (Err(_), Ty::Real(_), Ty::Real(_)) => {
                let sides = (self.measured(left), self.measured(right));
                self.report(quantity::apart(op.spelling(), sides.0, sides.1));
                Ty::Unknown
            }
            (Err(misfit), ..) => {
                let wanted = Wanted::By(self.span_of(left), format!("this is `{a}`"));
                self.misfit(right, &a, &misfit, &wanted);
                Ty::Unknown
            }
        }
    }

    /// Returns the type of a product or quotient; `combine` multiplies or divides the dimensions.
    fn scaled(&mut self, a: &Ty, b: &Ty, combine: fn(Dim, Dim) -> Option<Dim>, at: ExprId) -> Ty {
        let dims = (dim_of(a), dim_of(b));
        let dim = match dims {
            (Some(a), Some(b)) => combine(a, b),
            _ => None,
        };
        let spatial = [a, b].into_iter().find_map(|ty| match ty {
            Ty::Spatial(scalar, geometry) => Some((*scalar, geometry)),
            _ => None,
        });
        match (spatial, dim) {
            (Some((scalar, geometry)), dim) => {
                let geometry = Geometry {
                    dim,
                    ..(**geometry).clone()
                };
                Ty::Spatial(scalar, Rc::new(geometry))
            }
            (None, Some(dim)) => Ty::Real(dim),
            (None, None) => {
                let finding = Finding::new(Code::RPI2002, "exponent of a dimension out of range")
                    .at(self.span_of(at), "too many factors");
                self.report(finding);
                Ty::Unknown
            }
        }
    }

    fn raised(&mut self, base: &Ty, left: ExprId, right: ExprId) -> Ty {
        self.expect(
            right,
            &Ty::REAL,
            &Wanted::By(Span::NONE, "an exponent has no unit".into()),
        );
        let dim = dim_of(base).unwrap_or(Dim::ONE);
        if dim.is_plain() {
            return Ty::REAL;
        }
        let exponent = self
            .fold_quietly(right)
            .and_then(|leaves| leaves.first()?.as_real());
        let power = exponent.and_then(Ratio::of_real).and_then(|e| dim.power(e));
        power.map_or_else(
            || {
                let finding = Finding::new(
                    Code::RPI2002,
                    format!("cannot infer the dimension of a power of `{dim}`"),
                )
                .at(
                    self.span_of(right),
                    "the exponent must be a constant small fraction",
                )
                .also(self.span_of(left), format!("this is in `{dim}`"));
                self.report(finding);
                Ty::Unknown
            },
            Ty::Real,
        )
    }

    fn equal(&mut self, op: BinaryOp, left: ExprId, right: ExprId, span: Span) -> ExprId {
        let ty = self.joined(op, left, right);
        if matches!(ty, Ty::Device(_) | Ty::Text) {
            let finding = Finding::new(
                Code::RPI2006,
                format!("`{}` cannot take `{ty}`", op.spelling()),
            )
            .at(self.span_of(left), format!("this is `{ty}`"));
            return self.fault_with(finding, span);
        }
        let negated = op == BinaryOp::Ne;
        let operands = [left, right];
        self.add(Kind::Equal { operands, negated }, Ty::Bool, span)
    }

    /// Checks `a fby b`, which is `a -> pre b`.
    fn fby(&mut self, binary: &'a Binary, span: Span) -> ExprId {
        self.has_state(span);
        let left = self.expr(&binary.lhs);
        self.past += 1;
        let right = self.expr(&binary.rhs);
        self.past -= 1;
        let ty = self.common_type(left, right, "both sides must have the same type");
        let delayed = self.add(Kind::Each(Each::Pre, [right].into()), ty.clone(), span);
        self.add(Kind::Each(Each::Arrow, [left, delayed].into()), ty, span)
    }

    pub(super) fn no_operator(
        &mut self,
        op: BinaryOp,
        left: ExprId,
        right: ExprId,
        span: Span,
    ) -> ExprId {
        let (a, b) = (self.ty_of(left).clone(), self.ty_of(right).clone());
        let text = op.spelling();
        let finding = Finding::new(
            Code::RPI2006,
            format!("`{text}` cannot take `{a}` and `{b}`"),
        )
        .at(self.span_of(right), format!("this is `{b}`"))
        .also(self.span_of(left), format!("this is `{a}`"));
        let finding = self.operands_apart(finding, op, (left, &a), (right, &b));
        let is_int_number = |id| self.is_number(id) && *self.ty_of(id) == Ty::Int;
        let with_number = [left, right].into_iter().any(is_int_number);
        self.made_real = (with_number && finding.fixes.len() == 1).then_some(self.findings.len());
        self.fault_with(finding, span)
    }
}

/// Whether this is a chained comparison `a < b < c`, which the parser has reported.
fn is_chained(binary: &Binary) -> bool {
    let single = |op: BinaryOp| op.grouping() == Grouping::None;
    match &binary.lhs.kind {
        ExprKind::Binary(inner) => single(binary.op) && single(inner.op),
        _ => false,
    }
}

/// Returns the machine type for the lookup of operators; `None` for enums, results, machine integers and durations.
fn operand_kind(ty: &Ty) -> Option<Scalar> {
    match ty {
        Ty::Enum(_) | Ty::Result | Ty::Machine(_) | Ty::Duration => None,
        other => other.scalar(),
    }
}

/// Returns the dimension of a factor, dividend or divisor; `None` if its type has no single dimension.
fn dim_of(ty: &Ty) -> Option<Dim> {
    match ty {
        Ty::Real(dim) => Some(*dim),
        Ty::Spatial(_, geometry) => geometry.dim,
        Ty::Int => Some(Dim::ONE),
        _ => None,
    }
}
