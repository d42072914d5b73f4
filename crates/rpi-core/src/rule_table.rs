//! The table of rules: those that may still fire, and the fired and dropped ones that wait to be freed.

use crate::command_set::CommandSet;
use crate::command_table::Entry;
use crate::ids::{CommandId, RuleId};
use crate::notice::{Notice, NoticeLog, RuleOutcome};
use crate::rule::Rule;

use alloc::boxed::Box;
use alloc::vec::Vec;

/// A rule that may still fire, as the table stores it.
#[derive(Clone)]
pub(crate) struct PendingRule {
    pub(crate) id: RuleId,
    pub(crate) rule: Box<Rule>,
    /// The commands in the condition of the rule and the commands that it stops.
    pub(crate) mentioned: CommandSet,
    /// True if the condition is true in the decision of this tick, so that the rule fires.
    pub(crate) is_firing: bool,
    /// True if the rule may still fire.
    pub(crate) may_fire: bool,
}

/// The rules of a core. The table has a fixed size and does not allocate after its creation.
#[derive(Clone)]
pub(crate) struct RuleTable {
    /// Rules that have not fired, in the order in which they were added.
    pub(crate) pending: Vec<PendingRule>,
    /// Fired and dropped rules that wait to be freed outside the cycle.
    finished: Vec<(RuleId, Box<Rule>)>,
    capacity: usize,
    /// Number of the latest id that the table gave to a rule; the next rule gets the following one.
    last_id: u64,
}

impl RuleTable {
    pub(crate) fn with_capacity(capacity: usize) -> Self {
        RuleTable {
            pending: Vec::with_capacity(capacity),
            finished: Vec::with_capacity(capacity),
            capacity,
            last_id: 0,
        }
    }

    /// Returns a new rule id, which no rule has had before.
    pub(crate) fn new_id(&mut self) -> RuleId {
        self.last_id += 1;
        RuleId(self.last_id)
    }

    /// True if no rule can be added before a fired or dropped rule is taken out.
    pub(crate) fn is_full(&self) -> bool {
        self.pending.len() + self.finished.len() >= self.capacity
    }

    /// Adds a rule after all other pending rules.
    pub(crate) fn add(&mut self, id: RuleId, rule: Box<Rule>) {
        self.pending.push(PendingRule {
            id,
            mentioned: rule.mentioned_commands().collect(),
            rule,
            is_firing: false,
            may_fire: true,
        });
    }

    /// Returns the index of a rule in the list of pending rules; `None` if the rule is not pending.
    pub(crate) fn position(&self, id: RuleId) -> Option<usize> {
        self.pending.iter().position(|p| p.id == id)
    }

    /// Stores a rule that has fired or was dropped, until it is freed outside the cycle.
    pub(crate) fn finish(&mut self, id: RuleId, rule: Box<Rule>) {
        // `finished` has enough capacity: both lists together never exceed the capacity of one.
        self.finished.push((id, rule));
    }

    /// Removes and returns a fired or dropped rule, to be freed outside the cycle; `None` if there is none.
    pub(crate) fn take_finished(&mut self) -> Option<(RuleId, Box<Rule>)> {
        self.finished.pop()
    }

    /// Removes the pending rule with index `at` and reports its outcome to `notices`.
    pub(crate) fn drop_rule(&mut self, at: usize, outcome: RuleOutcome, notices: &mut NoticeLog) {
        let PendingRule { id, rule, .. } = self.pending.remove(at);
        notices.push(Notice::Rule { rule: id, outcome });
        self.finish(id, rule);
    }

    /// Removes all rules that can no longer fire, in one pass, and reports them to `notices`.
    pub(crate) fn drop_unfirable(&mut self, notices: &mut NoticeLog) {
        for PendingRule { id, rule, .. } in self.pending.extract_if(.., |p| !p.may_fire) {
            let outcome = RuleOutcome::Dropped;
            notices.push(Notice::Rule { rule: id, outcome });
            // Not `finish`, because `pending` is borrowed; there is enough capacity as there.
            self.finished.push((id, rule));
        }
    }

    /// Replaces, in the conditions of all rules, the facts about the removed command `gone` by their final values in
    /// `entry`.
    pub(crate) fn freeze_facts(&mut self, gone: CommandId, entry: &Entry) {
        let own: CommandSet = [gone].into_iter().collect();
        let pending = self.pending.iter_mut();
        for pending in pending.filter(|p| p.mentioned.intersects(&own)) {
            let condition = &mut pending.rule.condition;
            condition.freeze(gone, |fact| entry.final_value(fact));
        }
    }
}
