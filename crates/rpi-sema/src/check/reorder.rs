//! Arguments in another order than the ports: reported as one error, not as one for each argument.

use super::args::signature;
use super::body::Body;
use super::header::Header;
use super::report::listed;
use crate::ty::{Subst, fit};
use crate::typed::{ExprId, Kind};
use rpi_diag::{Code, Finding, Fix};

/// Maximum number of mismatched arguments for which other orders are tried.
const MOST: usize = 5;

impl Body<'_, '_> {
    /// Whether arguments match their ports only in another order; reports it if so.
    pub(super) fn reordered(
        &mut self,
        header: &Header,
        args: &[Option<ExprId>],
        subst: &Subst,
    ) -> bool {
        let mut trial = subst.clone();
        let mut misfits = Vec::new();
        for (k, (port, arg)) in header.inputs.iter().zip(args).enumerate() {
            let Some(arg) = arg else { continue };
            let found = self.ty_of(*arg).clone();
            if fit(&port.ty, &found, &mut trial).is_err() {
                misfits.push(k);
            }
        }
        if !(2..=MOST).contains(&misfits.len()) {
            return false;
        }
        let Some(order) = self.other_order(header, args, &misfits, &trial) else {
            return false;
        };
        let finding = self.in_other_order(header, args, &misfits, &order);
        self.report(finding);
        true
    }

    /// Returns for each of these ports the argument of another port that matches it.
    fn other_order(
        &self,
        header: &Header,
        args: &[Option<ExprId>],
        misfits: &[usize],
        subst: &Subst,
    ) -> Option<Vec<ExprId>> {
        let mut order: Vec<ExprId> = Vec::new();
        let mut left: Vec<ExprId> = misfits.iter().filter_map(|k| args[*k]).collect();
        let mut trial = subst.clone();
        for k in misfits {
            let port = &header.inputs[*k];
            let fits = |arg: &ExprId| {
                let mut trial = trial.clone();
                fit(&port.ty, self.ty_of(*arg), &mut trial).is_ok()
            };
            // Greedy: an order that is not found this way leaves one error for each argument.
            let at = left.iter().position(fits)?;
            let arg = left.remove(at);
            fit(&port.ty, &self.ty_of(arg).clone(), &mut trial).ok()?;
            order.push(arg);
        }
        Some(order)
    }

    fn in_other_order(
        &self,
        header: &Header,
        args: &[Option<ExprId>],
        misfits: &[usize],
        order: &[ExprId],
    ) -> Finding {
        let names = misfits.iter().map(|k| header.inputs[*k].name.as_str());
        let message = format!(
            "arguments for {} of `{}` are in the wrong order",
            listed(names),
            header.name
        );
        let mut finding = Finding::new(Code::RPI2001, message);
        let mut given: Vec<(usize, ExprId)> = Vec::new();
        given.extend(misfits.iter().filter_map(|k| Some((*k, args[*k]?))));
        given.sort_by_key(|(_, arg)| self.span_of(*arg).start);
        for (at, (k, arg)) in given.iter().enumerate() {
            let text = format!("`{}`, found `{}`", header.inputs[*k].ty, self.ty_of(*arg));
            let text = format!("`{}` expects {text}", header.inputs[*k].name);
            finding = match at {
                0 => finding.at(self.span_of(*arg), text),
                _ => finding.also(self.span_of(*arg), text),
            };
        }
        let finding = finding.help(format!("it is declared as `{}`", signature(header)));
        match self.swapped(args, misfits, order) {
            Some(fix) => finding.fix(fix),
            None => finding,
        }
    }

    /// Returns the fix that reorders the arguments, if all of them are plain names.
    fn swapped(&self, args: &[Option<ExprId>], misfits: &[usize], order: &[ExprId]) -> Option<Fix> {
        let mut fix = Fix::maybe("pass the arguments in the order of the ports");
        for (k, arg) in misfits.iter().zip(order) {
            self.plain_flow(args[*k]?)?;
            let name = self.plain_flow(*arg)?;
            fix = fix.replace(self.span_of(args[*k]?), name);
        }
        Some(fix)
    }

    /// Returns the name of a flow if the expression is only that name.
    fn plain_flow(&self, id: ExprId) -> Option<String> {
        let Kind::Flow(flow) = &self.unit.expr(id).kind else {
            return None;
        };
        let name = self.unit.flow(*flow).name.to_string();
        let span = self.span_of(id);
        ((span.end - span.start) as usize == name.len()).then_some(name)
    }
}
