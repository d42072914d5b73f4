//! Arguments in another order than that of the ports: one fault, not one for each of them.

use super::args::signature;
use super::body::Body;
use super::header::Header;
use super::report::listed;
use crate::ty::{Subst, fit};
use crate::typed::{ExprId, Kind};
use rpi_diag::{Code, Finding, Fix};

/// So many arguments are tried in other orders.
const MOST: usize = 5;

impl Body<'_, '_> {
    /// Whether arguments fit their ports only in another order, which is then reported.
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

    /// For each of these ports the argument of another that fits it.
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
            "{} of `{}` are given in another order",
            listed(names),
            header.name
        );
        let mut finding = Finding::new(Code::RPI2001, message);
        let mut given: Vec<(usize, ExprId)> = Vec::new();
        given.extend(misfits.iter().filter_map(|k| Some((*k, args[*k]?))));
        given.sort_by_key(|(_, arg)| self.span_of(*arg).start);
        for (at, (k, arg)) in given.iter().enumerate() {
            let text = format!("`{}`, this is `{}`", header.inputs[*k].ty, self.ty_of(*arg));
            let text = format!("`{}` is {text}", header.inputs[*k].name);
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

    /// The change of order, where all arguments are names.
    fn swapped(&self, args: &[Option<ExprId>], misfits: &[usize], order: &[ExprId]) -> Option<Fix> {
        let mut fix = Fix::maybe("give them in the order of the ports");
        for (k, arg) in misfits.iter().zip(order) {
            self.plain_flow(args[*k]?)?;
            let name = self.plain_flow(*arg)?;
            fix = fix.replace(self.span_of(args[*k]?), name);
        }
        Some(fix)
    }

    /// The name of a flow that is all that stands there.
    fn plain_flow(&self, id: ExprId) -> Option<String> {
        let Kind::Flow(flow) = &self.unit.expr(id).kind else {
            return None;
        };
        let name = self.unit.flow(*flow).name.to_string();
        let span = self.span_of(id);
        ((span.end - span.start) as usize == name.len()).then_some(name)
    }
}
