//! Conditions of rules: the knowledge about facts, and whether a rule may fire.

use rpi_core::{CommandId, CommandState, Fact};

use crate::expr::KnownFact;
use crate::model::{Model, ModelRule, fact_holds};

impl Model {
    /// C2 to C4: knowledge about a fact.
    pub(crate) fn know(&self, id: CommandId, fact: Fact) -> KnownFact {
        let Some(cmd) = self.commands.get(&id) else {
            return KnownFact::NEVER;
        };
        let hopeless = cmd.state == CommandState::Scheduled && !cmd.live;
        if let Fact::Export(index) = fact {
            let now = cmd.shown.filter(|_| index == 0);
            return match cmd.state {
                _ if hopeless => KnownFact::NEVER,
                CommandState::Terminated => KnownFact { now, settled: true },
                _ => KnownFact {
                    now,
                    settled: false,
                },
            };
        }
        let Some(end) = cmd.end else {
            let dead = fact == Fact::Regular && cmd.state == CommandState::Cancelling;
            return KnownFact {
                now: Some(false),
                settled: hopeless || dead,
            };
        };
        KnownFact {
            now: Some(fact_holds(fact, &end)),
            settled: true,
        }
    }

    /// S8: the commands that a rule starts have not run when it fires.
    pub(crate) fn may_come_true(&self, law: &ModelRule) -> bool {
        let know = |id: CommandId, fact: Fact| match fact {
            Fact::Export(_) if law.start.contains(&id) => KnownFact::NEVER,
            _ if law.start.contains(&id) => KnownFact {
                now: Some(false),
                settled: true,
            },
            _ => self.know(id, fact),
        };
        law.condition.may_be(true, &know)
    }

    pub(crate) fn is_true(&self, law: &ModelRule) -> bool {
        law.condition.value(&|id, fact| self.know(id, fact)) == Some(true)
    }
}
