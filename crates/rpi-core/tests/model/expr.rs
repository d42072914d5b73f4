//! Conditions of the model: expression trees, evaluated by the definitions C1 to C5.

use rpi_core::{CommandId, Condition, Fact};

/// A condition.
#[derive(Clone, Debug)]
pub(crate) enum Expr {
    Fact(CommandId, Fact),
    Value(bool),
    /// A fact about a command that was unloaded before the fact was settled.
    Never,
    Not(Box<Expr>),
    And(Box<Expr>, Box<Expr>),
    Or(Box<Expr>, Box<Expr>),
}

/// Knowledge about a fact: its present value, and whether the value is final.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct KnownFact {
    pub(crate) now: Option<bool>,
    pub(crate) settled: bool,
}

impl KnownFact {
    pub(crate) const NEVER: KnownFact = KnownFact {
        now: None,
        settled: true,
    };
}

type Know<'a> = &'a dyn Fn(CommandId, Fact) -> KnownFact;

impl Expr {
    pub(crate) fn condition(&self) -> Condition {
        match self {
            Expr::Fact(id, fact) => Condition::from_fact(*id, *fact),
            Expr::Value(true) => Condition::always(),
            Expr::Value(false) | Expr::Never => !Condition::always(),
            Expr::Not(a) => !a.condition(),
            Expr::And(a, b) => a.condition() & b.condition(),
            Expr::Or(a, b) => a.condition() | b.condition(),
        }
    }

    /// Value by Kleene's three-valued logic.
    pub(crate) fn value(&self, know: Know<'_>) -> Option<bool> {
        match self {
            Expr::Fact(id, fact) => know(*id, *fact).now,
            Expr::Value(v) => Some(*v),
            Expr::Never => None,
            Expr::Not(a) => a.value(know).map(|v| !v),
            Expr::And(a, b) => match (a.value(know), b.value(know)) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (Some(true), Some(true)) => Some(true),
                _ => None,
            },
            Expr::Or(a, b) => match (a.value(know), b.value(know)) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (Some(false), Some(false)) => Some(false),
                _ => None,
            },
        }
    }

    /// C5: whether the condition may take this value now or later.
    pub(crate) fn may_be(&self, wanted: bool, know: Know<'_>) -> bool {
        match self {
            Expr::Fact(id, fact) => {
                let known = know(*id, *fact);
                !known.settled || known.now == Some(wanted)
            }
            Expr::Value(v) => *v == wanted,
            Expr::Never => false,
            Expr::Not(a) => a.may_be(!wanted, know),
            Expr::And(a, b) if wanted => a.may_be(true, know) && b.may_be(true, know),
            Expr::And(a, b) => a.may_be(false, know) || b.may_be(false, know),
            Expr::Or(a, b) if wanted => a.may_be(true, know) || b.may_be(true, know),
            Expr::Or(a, b) => a.may_be(false, know) && b.may_be(false, know),
        }
    }

    /// The commands in the condition, in text order.
    pub(crate) fn mentioned_commands(&self) -> Vec<CommandId> {
        match self {
            Expr::Fact(id, _) => vec![*id],
            Expr::Value(_) | Expr::Never => Vec::new(),
            Expr::Not(a) => a.mentioned_commands(),
            Expr::And(a, b) | Expr::Or(a, b) => {
                [a.mentioned_commands(), b.mentioned_commands()].concat()
            }
        }
    }

    /// R3: whether the command must have ended before the condition can be true.
    pub(crate) fn requires(&self, command: CommandId) -> bool {
        let open = KnownFact {
            now: None,
            settled: false,
        };
        let not_ended = KnownFact {
            now: Some(false),
            settled: true,
        };
        let know = |id: CommandId, fact: Fact| match fact {
            Fact::Export(_) => open,
            _ if id == command => not_ended,
            _ => open,
        };
        !self.may_be(true, &know)
    }

    /// Replaces the facts about a removed command by their final values.
    pub(crate) fn freeze(&mut self, gone: CommandId, last: &dyn Fn(Fact) -> Option<bool>) {
        match self {
            Expr::Fact(id, fact) if *id == gone => {
                *self = last(*fact).map_or(Expr::Never, Expr::Value);
            }
            Expr::Not(a) => a.freeze(gone, last),
            Expr::And(a, b) | Expr::Or(a, b) => {
                a.freeze(gone, last);
                b.freeze(gone, last);
            }
            _ => {}
        }
    }
}
