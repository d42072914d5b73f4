//! Where a run stops.

use std::collections::BTreeMap;

use rpi_core::{CommandId, Instance};

use crate::flow_table::FlowTable;

/// Event at which a run stops.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Trigger {
    /// A fragment becomes active, or a command has its first cycle: index of the fragment in the table.
    Activated(usize),
    /// A Boolean flow becomes true: index of the flow.
    BecomesTrue(usize),
    /// A flow becomes present, for instance because its fragment becomes active: index of the flow.
    Appears(usize),
    /// The value of a flow changes, appears or disappears: index of the flow.
    Changes(usize),
}

/// Place at which runs of a command stop.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Breakpoint {
    /// Number by which the user knows it.
    pub id: u32,
    /// Index of the table of the command.
    pub table: usize,
    /// Event at which it stops.
    pub trigger: Trigger,
    /// Line of the program on which it was set, from 1; `None` if it was set on a flow.
    pub line: Option<u32>,
}

/// A breakpoint that a command has reached.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Hit {
    /// Index of the breakpoint in the list of the search; `None` for a fault of the command.
    pub breakpoint: Option<usize>,
    /// Command that has reached it.
    pub command: CommandId,
}

/// What a trigger depends on in the latest cycle of a command.
#[derive(Clone, PartialEq, Eq, Debug)]
enum Observed {
    Active(bool),
    Value(Option<Box<[u64]>>),
}

/// Watches commands for breakpoints, cycle by cycle.
pub(crate) struct BreakpointWatch<'b> {
    breakpoints: &'b [Breakpoint],
    /// For each command and index of a breakpoint, what was observed in its latest cycle.
    before: BTreeMap<(u64, usize), Observed>,
}

impl<'b> BreakpointWatch<'b> {
    pub(crate) fn new(breakpoints: &'b [Breakpoint]) -> BreakpointWatch<'b> {
        BreakpointWatch {
            breakpoints,
            before: BTreeMap::new(),
        }
    }

    /// Takes a cycle of a command with this table, and adds the breakpoints that it reaches, and a fault, to `hits`.
    pub(crate) fn observe(
        &mut self,
        (id, instance): (CommandId, &Instance),
        (index, table): (usize, &FlowTable),
        hits: &mut Vec<Hit>,
    ) {
        if instance.fault().is_some() {
            hits.push(Hit {
                breakpoint: None,
                command: id,
            });
        }
        for (k, breakpoint) in self.breakpoints.iter().enumerate() {
            if breakpoint.table != index {
                continue;
            }
            let now = observed(&breakpoint.trigger, instance, table);
            let before = self.before.insert((id.to_number(), k), now.clone());
            // What was before is unknown in the first cycle that is observed, unless it is the first one of the command.
            let is_known = before.is_some() || instance.cycle() == 0;
            if is_known && is_reached(&breakpoint.trigger, before.as_ref(), &now) {
                hits.push(Hit {
                    breakpoint: Some(k),
                    command: id,
                });
            }
        }
    }
}

fn observed(trigger: &Trigger, instance: &Instance, table: &FlowTable) -> Observed {
    match trigger {
        Trigger::Activated(fragment) => {
            let index = table.fragments[*fragment].image_fragment;
            Observed::Active(index.is_some_and(|index| instance.is_active(index)))
        }
        Trigger::BecomesTrue(flow) | Trigger::Appears(flow) | Trigger::Changes(flow) => {
            let flow = &table.flows[*flow];
            let is_active = instance.is_active(flow.image_fragment);
            let value = instance.value(flow.signal).filter(|_| is_active);
            Observed::Value(value.map(Box::from))
        }
    }
}

fn is_reached(trigger: &Trigger, before: Option<&Observed>, now: &Observed) -> bool {
    let holds = |value: &Observed| match (value, trigger) {
        (Observed::Active(active), _) => *active,
        (Observed::Value(value), Trigger::Appears(_)) => value.is_some(),
        (Observed::Value(value), _) => value
            .as_ref()
            .is_some_and(|words| words.first() == Some(&1)),
    };
    match trigger {
        Trigger::Changes(_) => before.is_some_and(|before| before != now),
        _ => holds(now) && !before.is_some_and(holds),
    }
}
