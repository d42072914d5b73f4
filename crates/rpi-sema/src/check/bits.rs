//! `x[7:0]` of Kind 2: bits of a machine integer. They are checked and not run, as machine integers are.

use super::body::Body;
use super::types::is_foreign;
use crate::ty::Ty;
use crate::typed::ExprId;
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::ast::{Bits, Expr};

impl<'a> Body<'_, 'a> {
    pub(super) fn bits(&mut self, of: &'a Bits, span: Span) -> ExprId {
        let base = self.expr(&of.base);
        let bounds = [&of.high, &of.low].map(|bound| self.integer(bound));
        let ty = self.ty_of(base).clone();
        let known = ty.is_unknown() || bounds.contains(&None);
        let [Some(high), Some(low)] = bounds else {
            return self.fault(span);
        };
        // Elsewhere the grammar has told that there are none.
        if known || self.is_rpi() {
            return self.fault(span);
        }
        let Some(width) = width(&ty) else {
            let finding = Finding::new(Code::RPI2006, "only a machine integer has bits")
                .at(of.base.span, format!("this is `{ty}`"));
            return self.fault_with(finding, span);
        };
        for (bit, at) in [(high, &of.high), (low, &of.low)] {
            if !(0..width).contains(&bit) {
                return self.fault_with(no_bit(bit, width, at), span);
            }
        }
        if low > high {
            let finding = Finding::new(Code::RPI2009, "these bits end before they begin")
                .at(span, format!("from {high} down to {low}"))
                .help("the highest bit comes first: `x[7:0]`");
            return self.fault_with(finding, span);
        }
        self.fault(span)
    }
}

fn no_bit(bit: i64, width: i64, at: &Expr) -> Finding {
    let bits = rpi_diag::counted(usize::try_from(width).unwrap_or_default(), "bit");
    Finding::new(Code::RPI2009, format!("there is no bit {bit}"))
        .at(at.span, format!("the integer has {bits}, counted from 0"))
}

/// How many bits the values of a type have: `uint<32>`, `int8`.
fn width(ty: &Ty) -> Option<i64> {
    let Ty::Struct(of) = ty else {
        return None;
    };
    let is_machine = is_foreign(ty, &["int", "uint", "sint"]);
    let digits: String = of.name.chars().filter(char::is_ascii_digit).collect();
    digits.parse().ok().filter(|_| is_machine)
}
