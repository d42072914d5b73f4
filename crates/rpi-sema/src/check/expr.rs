//! Expressions: dispatch on their kind, literals, and simple forms.

use super::body::Body;
use super::quantity::plain_angle;
use super::report::Wanted;
use crate::ty::{Ty, join};
use crate::typed::{Each, ExprId, Kind, Leaf};
use crate::units::Base;
use rpi_diag::{Applicability, Code, Finding, Span};
use rpi_net::prim;
use rpi_syntax::ast::{self, Among, ExprKind, Number, Quantity};

impl<'a> Body<'_, 'a> {
    /// Checks an expression and returns its entry in the table of typed expressions.
    pub(super) fn expr(&mut self, expr: &'a ast::Expr) -> ExprId {
        self.c.nesting += 1;
        let id = self.expr_of_kind(expr);
        self.c.nesting -= 1;
        id
    }

    fn expr_of_kind(&mut self, expr: &'a ast::Expr) -> ExprId {
        let span = expr.span;
        match &expr.kind {
            ExprKind::Bool(value) => self.add(Kind::Literal(Leaf::bool(*value)), Ty::Bool, span),
            ExprKind::Number(number) => {
                self.numbers.insert(span);
                self.number(number, false, span)
            }
            ExprKind::Quantity(quantity) => self.quantity(quantity, span),
            ExprKind::Str(text) => {
                self.add(Kind::Literal(Leaf::Str(text.to_string())), Ty::Text, span)
            }
            ExprKind::Name(name) => self.name(name, span),
            ExprKind::Field(field) => self.field(field, span),
            ExprKind::Index(index) => self.index(index, span),
            ExprKind::Slice(slice) => self.slice(slice, span),
            ExprKind::Bits(of) => self.bits(of, span),
            ExprKind::Unary(op, operand) => self.unary(*op, operand, span),
            ExprKind::Binary(binary) => self.binary(binary, span),
            ExprKind::When(when) => self.when(when, span),
            ExprKind::If(choice) => self.choice(choice, span),
            ExprKind::Call(call) => self.call(call, span),
            ExprKind::Among(among, operands) => self.among(*among, operands, span),
            ExprKind::Merge(merge) => self.merge(merge, span),
            ExprKind::Paren(inner) => self.expr(inner),
            ExprKind::Tuple(elements) => self.tuple(elements, span),
            ExprKind::Array(elements) => self.array(elements, span),
            ExprKind::Struct(value) => self.structure(value, span),
            ExprKind::Update(update) => self.update(update, span),
            ExprKind::Quantified(of) => self.quantified(of, span),
            ExprKind::Ascribed(of) => self.ascribed(of),
            ExprKind::IsA(of) => self.is_a(of, span),
            ExprKind::Match(of) => self.match_of(of, span),
            ExprKind::EmptySet(types) => self.empty_set(types, span),
        }
    }

    /// Checks a number literal. `negative` is true after a minus sign, which makes -2^63 a valid integer.
    pub(super) fn number(&mut self, number: &Number, negative: bool, span: Span) -> ExprId {
        if !number.is_int() {
            let value = if negative {
                -number.real()
            } else {
                number.real()
            };
            return self.add(Kind::Literal(Leaf::real(value)), Ty::REAL, span);
        }
        let Some(value) = number.int() else {
            // The parser has reported it, except after a sign that may be the end of `uint@<64>`.
            if number.bits().is_some() && !self.is_rpi() {
                return self.fault_with(too_large(span), span);
            }
            return self.fault(span);
        };
        match signed(value, negative) {
            Some(value) => self.add(Kind::Literal(Leaf::int(value)), Ty::Int, span),
            None => self.fault_with(too_large(span), span),
        }
    }

    /// Checks a number with a unit.
    fn quantity(&mut self, quantity: &Quantity, span: Span) -> ExprId {
        match self.measure(&quantity.unit) {
            Ok(None) => self.fault(span),
            Ok(Some(measure)) => {
                let value = measure.factor.apply(quantity.number.real());
                self.add(
                    Kind::Literal(Leaf::real(value)),
                    Ty::Real(measure.dim),
                    span,
                )
            }
            Err(finding) => self.fault_with(*finding, span),
        }
    }

    /// Reports a number without a unit where an angle is expected. SI treats the radian as dimensionless, so that unit
    /// checking alone would accept it.
    pub(super) fn angle_has_unit(&mut self, id: ExprId, expected: &Ty) -> bool {
        let expr = self.unit.expr(id);
        let (Kind::Literal(value), Ty::Real(found), Ty::Real(wanted)) =
            (&expr.kind, &expr.ty, expected)
        else {
            return true;
        };
        let angle =
            !wanted.exponent(Base::Angle).is_zero() && found.exponent(Base::Angle).is_zero();
        if !angle || value.as_real() == Some(0.0) {
            return true;
        }
        let finding = plain_angle(*wanted, self.measured(id));
        self.report(finding);
        false
    }

    /// Checks `if c then x else y`.
    fn choice(&mut self, choice: &'a ast::If, span: Span) -> ExprId {
        if choice.is_static {
            return self.static_choice(choice, span);
        }
        let before = self.statics_read;
        let condition = self.condition(&choice.condition, "the expression after `if`");
        if self.statics_read > before {
            self.unit.chosen.push(condition);
        }
        if let Some(taken) = self.decided(&choice.condition, condition) {
            return self.expr(if taken { &choice.yes } else { &choice.no });
        }
        let guarded = self.guarded;
        self.guarded |= self.reads_bound(&choice.condition);
        let before = self.findings.len();
        let yes = self.expr(&choice.yes);
        let between = self.findings.len();
        let no = self.expr(&choice.no);
        self.guarded = guarded;
        self.forgive_untaken(condition, [before, between]);
        let ty = self.common_type(yes, no, "both branches of an `if` must have the same type");
        self.add(Kind::Each(Each::If, [condition, yes, no].into()), ty, span)
    }

    /// Removes errors about a division by zero in a branch that a constant condition never takes: `if n = 0 then 0 else
    /// x div n`.
    fn forgive_untaken(&mut self, condition: ExprId, [before, between]: [usize; 2]) {
        let is_of_zero = |finding: &Finding| finding.code == Code::RPI2012;
        if !self.findings[before..].iter().any(is_of_zero) {
            return;
        }
        let taken = self.fold_quietly(condition);
        let Some(taken) = taken.and_then(|leaves| leaves.first().and_then(Leaf::as_bool)) else {
            return;
        };
        let untaken = if taken {
            between..self.findings.len()
        } else {
            before..between
        };
        let mut at = 0..self.findings.len();
        self.findings.retain(|finding| {
            at.next().is_none_or(|k| !untaken.contains(&k)) || !is_of_zero(finding)
        });
        self.made_real = self.made_real.filter(|at| *at < before);
    }

    /// Checks `with c then x else y`: only the branch that is taken is checked.
    fn static_choice(&mut self, choice: &'a ast::If, span: Span) -> ExprId {
        let Some(taken) = self.constant_of(&choice.condition, &Ty::Bool) else {
            return self.fault(span);
        };
        match taken.first().and_then(Leaf::as_bool) {
            Some(true) => self.expr(&choice.yes),
            _ => self.expr(&choice.no),
        }
    }

    /// Returns the common type of two expressions; reports a mismatch at the second one, or at a number literal.
    pub(super) fn common_type(&mut self, a: ExprId, b: ExprId, why: &str) -> Ty {
        self.times_meet(a, b);
        match join(self.ty_of(a), self.ty_of(b)) {
            Ok(ty) => ty,
            Err(misfit) => {
                // A number literal is the easiest to change, and often only lacks its unit or decimal point.
                let points = (self.ty_of(a) == &Ty::Int, self.ty_of(b) == &Ty::Int);
                let lacks_point = self.is_number(b) && points == (true, false);
                let (model, odd, misfit) =
                    match self.is_number(a) && (!self.is_number(b) || lacks_point) {
                        true => (b, a, misfit.turned()),
                        false => (a, b, misfit),
                    };
                let expected = self.ty_of(model).clone();
                let wanted =
                    Wanted::By(self.span_of(model), format!("this is `{expected}`; {why}"));
                self.misfit(odd, &expected, &misfit, &wanted);
                let both = self.is_number(a) && self.is_number(b);
                if both && let (Ty::Real(_), Ty::Int) = (&expected, self.ty_of(odd)) {
                    self.either_number();
                    return Ty::Unknown;
                }
                // Two arrays of different size: either size may be the intended one.
                match (&expected, self.ty_of(odd)) {
                    (Ty::Array(..), Ty::Array(..)) => Ty::Unknown,
                    _ => expected,
                }
            }
        }
    }

    /// Adds to the last diagnostic that either `1` or `1.0` may be the wrong literal.
    fn either_number(&mut self) {
        if let Some(finding) = self.findings.last_mut() {
            for fix in &mut finding.fixes {
                fix.applicability = Applicability::Maybe;
            }
            let other = "to use integers, write the other number without a decimal point";
            finding.help.push(other.to_owned());
        }
    }

    /// Checks `#(a, b, c)`, at most one operand is true, and `nor(a, b, c)`, none is.
    fn among(&mut self, among: Among, operands: &'a [ast::Expr], span: Span) -> ExprId {
        let operands: Vec<ExprId> = operands
            .iter()
            .flat_map(|operand| self.boolean_operands(operand))
            .collect();
        match among {
            Among::Nor => self.none_of(&operands, span),
            Among::AtMostOne => self.at_most_one(&operands, span),
        }
    }

    /// Checks a Boolean operand or an array of Booleans; returns the Booleans.
    pub(super) fn boolean_operands(&mut self, operand: &'a ast::Expr) -> Vec<ExprId> {
        let id = self.expr(operand);
        if let Ty::Array(element, n) = self.ty_of(id).clone() {
            let parts = (0..n).map(|k| {
                self.add(
                    Kind::Part { base: id, at: k },
                    (*element).clone(),
                    operand.span,
                )
            });
            let parts: Vec<ExprId> = parts.collect();
            for part in &parts {
                self.expect(*part, &Ty::Bool, &Wanted::Here);
            }
            return parts;
        }
        self.expect(id, &Ty::Bool, &Wanted::Here);
        vec![id]
    }

    /// Adds an expression that is true if no operand is true.
    fn none_of(&mut self, operands: &[ExprId], span: Span) -> ExprId {
        let any = self.any_of(operands, span);
        self.logic(prim!("Core::BooleanNot"), &[any], span)
    }

    /// Adds the disjunction of the operands.
    fn any_of(&mut self, operands: &[ExprId], span: Span) -> ExprId {
        let first = self.add(Kind::Literal(Leaf::bool(false)), Ty::Bool, span);
        let or =
            |any: ExprId, next: &ExprId| self.logic(prim!("Core::BooleanOr"), &[any, *next], span);
        operands.iter().fold(first, or)
    }

    /// Adds an expression that is true if at most one operand is true. Its size is linear in the number of operands.
    pub(super) fn at_most_one(&mut self, operands: &[ExprId], span: Span) -> ExprId {
        let [first, rest @ ..] = operands else {
            return self.add(Kind::Literal(Leaf::bool(true)), Ty::Bool, span);
        };
        let (mut any, mut two) = (*first, None);
        for next in rest {
            let both = self.logic(prim!("Core::BooleanAnd"), &[any, *next], span);
            two = Some(match two {
                Some(two) => self.logic(prim!("Core::BooleanOr"), &[two, both], span),
                None => both,
            });
            any = self.logic(prim!("Core::BooleanOr"), &[any, *next], span);
        }
        match two {
            Some(two) => self.logic(prim!("Core::BooleanNot"), &[two], span),
            None => self.add(Kind::Literal(Leaf::bool(true)), Ty::Bool, span),
        }
    }

    /// Checks a tuple.
    fn tuple(&mut self, elements: &'a [ast::Expr], span: Span) -> ExprId {
        let elements: Vec<ExprId> = elements.iter().map(|e| self.expr(e)).collect();
        let ty = Ty::tuple(elements.iter().map(|id| self.ty_of(*id).clone()));
        self.add(Kind::Build(elements.into()), ty, span)
    }
}

/// Returns the diagnostic for an integer literal that exceeds 64 bits.
fn too_large(span: Span) -> Finding {
    Finding::new(Code::RPI2010, "the integer does not fit in 64 bits")
        .at(span, "the range is -2^63 to 2^63 - 1")
}

/// Returns a literal with its sign; `None` on overflow.
fn signed(value: u64, negative: bool) -> Option<i64> {
    match negative {
        true => 0i64.checked_sub_unsigned(value),
        false => i64::try_from(value).ok(),
    }
}
