//! Suppression of warnings about unused outputs of called units: a caller need not use every output.

use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use rpi_diag::suppression::{Cause, suppress};
use rpi_diag::{Diagnostic, Span};
use rpi_sema::typed::{Equation, FlowRole, TargetPlace, Unit, UnitId};

/// Source locations of the expressions that define the out-ports of all units of a program. They are collected on first
/// use.
#[derive(Default)]
pub(crate) struct OutPorts(OnceCell<BTreeMap<Span, Owner>>);

/// Units that have an out-port that is defined at one location.
#[derive(Clone, Copy)]
enum Owner {
    One(UnitId),
    /// Instances of a declaration.
    Several,
}

impl OutPorts {
    /// Removes diagnostics about unused text in the net of `root` where the text defines an out-port of another unit, which
    /// is called there: another caller may use the out-port.
    pub(crate) fn suppress_unused(
        &self,
        units: &[Rc<Unit>],
        root: UnitId,
        found: &mut Vec<Diagnostic>,
    ) {
        let unused = found.iter().filter(|one| one.code.is_unnecessary());
        let mut unused = unused.map(Diagnostic::span).peekable();
        if unused.peek().is_none() {
            return;
        }
        let owners = self.0.get_or_init(|| owners(units));
        let of_others = unused.filter(|span| match owners.get(span) {
            Some(Owner::One(unit)) => *unit != root,
            Some(Owner::Several) => true,
            None => false,
        });
        let places: BTreeSet<Span> = of_others.collect();
        suppress(found, Cause::UsedElsewhere(&places));
    }
}

fn owners(units: &[Rc<Unit>]) -> BTreeMap<Span, Owner> {
    let mut owners = BTreeMap::new();
    for (id, unit) in (0..).map(UnitId).zip(units) {
        for span in out_ports(unit) {
            let owner = owners.entry(span).or_insert(Owner::One(id));
            if !matches!(owner, Owner::One(known) if *known == id) {
                *owner = Owner::Several;
            }
        }
    }
    owners
}

/// Returns the source locations of the expressions that define the out-ports of a unit.
fn out_ports(unit: &Unit) -> impl Iterator<Item = Span> + '_ {
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let gives = |equation: &&Equation| {
        equation.targets.iter().any(|target| match &target.place {
            TargetPlace::Flow { flow, .. } => unit.flow(*flow).role == FlowRole::Output,
            _ => false,
        })
    };
    let given = equations.filter(gives);
    given.map(|equation| unit.expr(equation.value).span)
}
