//! Operators called like nodes, `map<<+, n>>` and `Lustre::iplus(a, b)`, and calls of node parameters inside a generic
//! declaration.

use super::args::Given;
use super::body::Body;
use super::callable::Callable;
use super::header::Header;
use super::predef::Predef;
use crate::ty::{Subst, Ty};
use crate::typed::{self, ExprId, Kind};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::ast::StaticOp;
use rpi_syntax::ops::{BinaryOp, UnaryOp};
use std::rc::Rc;

impl<'a> Body<'_, 'a> {
    /// Calls an operator by its name.
    pub(super) fn apply_predef(
        &mut self,
        predef: &Predef,
        given: Vec<Given<'a>>,
        span: Span,
    ) -> ExprId {
        let given = self.spread_tuples(given);
        let (takes, gives) = predef.signature().unwrap_or((Vec::new(), Ty::Unknown));
        let mut sound = true;
        for (arg, ty) in given.iter().zip(&takes) {
            sound &= self.expect(arg.value, ty, &super::report::Wanted::Here);
        }
        match sound {
            true => self.apply_op(predef.op, &given, span),
            false => self.add(Kind::Fault, gives, span),
        }
    }

    /// Calls an operator with operands that have been checked.
    pub(super) fn apply_op(&mut self, op: StaticOp, given: &[Given<'a>], span: Span) -> ExprId {
        let given = self.spread_tuples(given.to_vec());
        let values: Vec<ExprId> = given.iter().map(|arg| arg.value).collect();
        match (op, &values[..]) {
            (StaticOp::Binary(op), [a, b]) => self.binary_applied(op, *a, *b, span),
            (StaticOp::Unary(UnaryOp::Pre), [a]) => {
                self.has_state(span);
                let ty = self.ty_of(*a).clone();
                self.add(Kind::Each(typed::Each::Pre, [*a].into()), ty, span)
            }
            (StaticOp::Unary(op), [a]) => self.unary_prim(op, *a, span),
            (StaticOp::If, [c, a, b]) => {
                self.expect(*c, &Ty::Bool, &super::report::Wanted::Here);
                let ty =
                    self.common_type(*a, *b, "both branches of an `if` must have the same type");
                self.add(Kind::Each(typed::Each::If, [*c, *a, *b].into()), ty, span)
            }
            _ => {
                let name = Callable::Op(op).spelling();
                let finding = Finding::new(
                    Code::RPI1010,
                    format!(
                        "`{name}` does not take {}",
                        rpi_diag::counted(values.len(), "operand")
                    ),
                )
                .at(span, "wrong number of operands");
                self.fault_with(finding, span)
            }
        }
    }

    /// Checks a call of a node parameter without a value: only the types of the arguments can be checked.
    pub(super) fn apply_open(
        &mut self,
        header: &Rc<Header>,
        given: Vec<Given<'a>>,
        span: Span,
    ) -> ExprId {
        if let Some(mut args) = self.match_ports(header, &given, span) {
            self.fit_args(header, &mut args, &mut Subst::default());
        }
        self.add(Kind::Fault, header.result_type(), span)
    }

    fn binary_applied(&mut self, op: BinaryOp, a: ExprId, b: ExprId, span: Span) -> ExprId {
        let each = match op {
            BinaryOp::Arrow => typed::Each::Arrow,
            BinaryOp::Coalesce => typed::Each::Coalesce,
            BinaryOp::Fby => {
                self.has_state(span);
                let ty = self.ty_of(b).clone();
                let before = self.add(Kind::Each(typed::Each::Pre, [b].into()), ty, span);
                return self.binary_applied(BinaryOp::Arrow, a, before, span);
            }
            _ => return self.binary_prim(op, a, b, span),
        };
        let ty = self.common_type(a, b, "both sides must have the same type");
        self.add(Kind::Each(each, [a, b].into()), ty, span)
    }
}
