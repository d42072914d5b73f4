//! The values of the running commands in one cycle.

use rpi_core::{CommandId, Instance};

use rpi_runtime::run::fault_text;

use crate::flow_table::FlowTable;

/// Place in a run: a tick, and what the commands computed in it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Stop {
    /// Number of the tick, counted from 0.
    pub tick: u64,
    /// Commands with a cycle in this tick, in the order of their evaluation.
    pub commands: Vec<RunningCommand>,
}

/// A command in a cycle, with the value of each of its flows.
#[derive(Clone, PartialEq, Debug)]
pub struct RunningCommand {
    /// Id of the command: another one each time it is loaded.
    pub id: CommandId,
    /// Index of its table of flows.
    pub table: usize,
    /// Number of the cycle of the command, counted from 0.
    pub cycle: u64,
    /// For each flow of the table, its value as memory words; `None` if it is absent.
    pub values: Vec<Option<Box<[u64]>>>,
    /// For each fragment of the table, whether it is active.
    pub active: Vec<bool>,
    /// The fault that ends the command in this cycle, if there is one, as text.
    pub fault: Option<&'static str>,
}

impl RunningCommand {
    /// Copies the values of a command after the evaluation of its cycle, before its delays are stored.
    #[must_use]
    pub fn new(
        id: CommandId,
        instance: &Instance,
        (index, table): (usize, &FlowTable),
    ) -> RunningCommand {
        let value = |flow: &crate::Flow| {
            let is_active = instance.is_active(flow.image_fragment);
            let value = instance.value(flow.signal).filter(|_| is_active);
            value.map(Box::from)
        };
        let fragments = table.fragments.iter();
        let is_active = fragments.map(|fragment| {
            let index = fragment.image_fragment;
            index.is_some_and(|index| instance.is_active(index))
        });
        RunningCommand {
            id,
            table: index,
            cycle: instance.cycle(),
            values: table.flows.iter().map(value).collect(),
            active: is_active.collect(),
            fault: instance.fault().map(|fault| fault_text(fault.code)),
        }
    }

    /// Returns the value of a flow as a literal of the language, or `absent`.
    #[must_use]
    pub fn text(&self, table: &FlowTable, flow: usize) -> String {
        match self.values.get(flow) {
            Some(Some(words)) => rpi_literal::write(words, table.flows[flow].ty),
            _ => "absent".to_owned(),
        }
    }

    /// Returns whether a flow is present and true.
    #[must_use]
    pub fn is_true(&self, flow: usize) -> bool {
        let value = self.values.get(flow).and_then(Option::as_ref);
        value.is_some_and(|words| words.first() == Some(&1))
    }
}
