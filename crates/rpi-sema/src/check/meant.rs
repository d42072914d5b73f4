//! Suggestions for calls of names that cannot be called, such as `pow(x, 2.0)` or the name of a struct.

use super::access::names_of;
use super::body::Body;
use super::names::plain_name;
use crate::program::{Lookup, Space};
use crate::ty::{StructTy, Ty};
use crate::typed::{ExprId, Kind};
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, ExprKind};
use rpi_syntax::ops::BinaryOp;

/// Names of the power function in other languages, in lower case.
const POWERS: &[&str] = &["pow", "power", "powf", "powi", "expt"];

impl<'a> Body<'_, 'a> {
    /// Adds to the reported error of `pow(x, 2.0)` the fix that writes `x ** 2.0`.
    pub(super) fn meant_as_power(&mut self, call: &'a ast::Call, span: Span) {
        let name = call.callee.name.name.to_lowercase();
        let (true, [base, exponent]) = (POWERS.contains(&name.as_str()), &call.args[..]) else {
            return;
        };
        let Some(finding) = self.finding_at(call.callee.name.span, Code::RPI1001) else {
            return;
        };
        let (base, exponent) = (&base.value, &exponent.value);
        let [(open, close), (open_too, close_too)] = [base, exponent].map(brackets);
        let sign = format!("{close} ** {open_too}");
        let fix = Fix::sure("write `x ** y`")
            .replace(
                between(span.start, base.span.start, span),
                format!("({open}"),
            )
            .replace(between(base.span.end, exponent.span.start, span), sign)
            .replace(
                between(exponent.span.end, span.end, span),
                format!("{close_too})"),
            );
        finding.help.clear();
        finding.help.push("a power is written `x ** y`".to_owned());
        finding.fixes = vec![fix];
    }

    /// Adds the struct syntax to the reported error of `P(x, y)` for a struct `P`. Returns an error expression of the
    /// struct's type.
    pub(super) fn meant_as_struct(&mut self, call: &'a ast::Call, span: Span) -> ExprId {
        let name = &call.callee.name;
        let Lookup::Found(id) = self
            .c
            .program
            .lookup_in(Space::Type, self.module, &name.name)
        else {
            return self.fault(span);
        };
        let told = self.finding_at(name.span, Code::RPI1003);
        let Some(told) = told.map(|told| told.clone()) else {
            return self.fault(span);
        };
        let Ty::Struct(ty) = self.c.type_decl(id) else {
            return self.fault(span);
        };
        let form = names_of(&ty.fields).map(|field| format!("{field} = ..."));
        let form = form.collect::<Vec<_>>().join("; ");
        let mended = told.help(format!(
            "write a value of this type as `{} {{{form}}}`",
            name.name
        ));
        let mended = match as_fields(&ty, call, span) {
            Some(fix) => mended.fix(fix),
            None => mended,
        };
        if let Some(finding) = self.finding_at(name.span, Code::RPI1003) {
            *finding = mended;
        }
        self.add(Kind::Fault, Ty::Struct(ty), span)
    }

    /// Reports a call `map(f, a)` of an iterator whose static arguments are written among the arguments.
    pub(super) fn bare_iterator(
        &mut self,
        name: &'static str,
        call: &'a ast::Call,
        span: Span,
    ) -> ExprId {
        let first = call.args.first().and_then(|arg| plain_name(&arg.value));
        let callee = first.filter(|name| self.is_something_to_call(name));
        let rest = &call.args[usize::from(callee.is_some())..];
        let given: Vec<ExprId> = rest.iter().map(|arg| self.expr(&arg.value)).collect();
        let size = given.iter().find_map(|id| match self.ty_of(*id) {
            Ty::Array(_, n) => Some(n.to_string()),
            _ => None,
        });
        let is_known = callee.is_some() && size.is_some();
        let callee = callee.map_or("node", Name::as_str);
        let size = size.unwrap_or_else(|| "size".to_owned());
        let form = match name {
            "boolred" => "<<least; most; size>>".to_owned(),
            _ => format!("<<{callee}, {size}>>"),
        };
        let message = format!("`{name}` lacks its static arguments");
        let finding = Finding::new(Code::RPI1010, message)
            .at(call.callee.span, "static arguments expected after the name")
            .help(format!("write `{name}{form}(...)`"));
        let finding = match &call.args[..] {
            [first, second, ..] if is_known => {
                let moved = between(first.value.span.start, second.value.span.start, span);
                let fix = Fix::sure(format!("write `{name}{form}`")).replace(moved, "");
                finding.fix(fix.insert_after(call.callee.span, form))
            }
            _ => finding,
        };
        self.fault_with(finding, span)
    }

    /// Whether a name is a callable declaration and not a local flow.
    fn is_something_to_call(&self, name: &Name) -> bool {
        let found = self.c.program.lookup_in(Space::Callable, self.module, name);
        let is_callee = |id| super::unit::is_callable(self.c.program.decl(id).kind);
        self.find_local(name).is_none() && matches!(found, Lookup::Found(id) if is_callee(id))
    }

    /// Returns the last reported diagnostic with this code and this primary location.
    pub(super) fn finding_at(&mut self, span: Span, code: Code) -> Option<&mut Finding> {
        let mut findings = self.findings.iter_mut().rev();
        findings.find(|finding| finding.code == code && finding.span() == span)
    }
}

/// Returns the parentheses that an operand of `**` needs: none for a name or a number.
fn brackets(operand: &ast::Expr) -> (&'static str, &'static str) {
    match operand.kind {
        ExprKind::Name(_) | ExprKind::Number(_) => ("", ""),
        _ => ("(", ")"),
    }
}

/// Returns the span from `start` to `end` in the file of `around`.
fn between(start: u32, end: u32, around: Span) -> Span {
    Span {
        start,
        end,
        ..around
    }
}

/// Returns the fix that turns a call into a struct literal; `None` if the arguments are not as many as the fields.
fn as_fields(ty: &StructTy, call: &ast::Call, span: Span) -> Option<Fix> {
    if call.args.is_empty() || call.args.len() != ty.fields.len() {
        return None;
    }
    // `P(x = 1)` parses as a comparison: the fields may be named already, so the fix is uncertain.
    let is_by_name =
        |arg: &ast::Arg| matches!(&arg.value.kind, ExprKind::Binary(of) if of.op == BinaryOp::Eq);
    let mut fix = match call.args.iter().any(is_by_name) {
        true => Fix::maybe("write the fields"),
        false => Fix::sure("write the fields"),
    };
    let mut from = call.callee.span.end;
    for (k, (arg, field)) in call.args.iter().zip(names_of(&ty.fields)).enumerate() {
        let name = arg.name.as_ref().map_or(field, |name| name.name.as_str());
        let opening = if k == 0 { " {" } else { "; " };
        let text = format!("{opening}{name} = ");
        fix = fix.replace(between(from, arg.value.span.start, span), text);
        from = arg.value.span.end;
    }
    Some(fix.replace(between(from, span.end, span), "}"))
}
