//! Conditions of rules: three-valued expressions over facts about commands.
//!
//! A fact is true, false or unknown. `and`, `or` and `not` follow Kleene's strong three-valued logic, so `false and
//! unknown` is false. An evaluation yields the present truth value and the values that are still possible. A rule whose
//! condition can no longer become true is dropped.

use crate::ids::CommandId;

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use core::ops;

/// An atomic proposition about a command.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Fact {
    /// The exported Boolean flow with this index is true in the latest cycle. Unknown before the first cycle and while
    /// the flow is absent. After the end of the command, the value of its last cycle counts.
    Export(u32),
    /// The command has ended, for any cause.
    Ended,
    /// The command has ended by a result or by `terminate`, without an error and without a cancel.
    Regular,
    /// The command has ended with an error, a fault or an abort.
    Failed,
    /// The command has ended by its named result with this index.
    Result(u32),
    /// The command has ended with this error number.
    Error(i64),
}

/// Knowledge about a fact or a condition: its present truth value and its possible later values, as a bit set.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Truth(u8);

impl Truth {
    /// The value of the condition is not known and cannot become known any more, for example because the command that
    /// it names was unloaded.
    pub(crate) const UNKNOWN_FOREVER: Truth = Truth(0);
    /// Bit of the set: the fact or condition is true now.
    const TRUE: u8 = 1;
    /// Bit of the set: the fact or condition is false now.
    const FALSE: u8 = 2;
    /// Bit of the set: the fact or condition may be true in a later tick.
    const MAY_BE_TRUE: u8 = 4;
    /// Bit of the set: the fact or condition may be false in a later tick.
    const MAY_BE_FALSE: u8 = 8;
    /// The present value is not known; later it may be true or false.
    pub(crate) const UNKNOWN: Truth = Truth(Self::MAY_BE_TRUE | Self::MAY_BE_FALSE);

    /// Returns the knowledge of a value that is known and cannot change any more.
    pub(crate) const fn fixed(value: bool) -> Truth {
        Truth(if value {
            Self::TRUE | Self::MAY_BE_TRUE
        } else {
            Self::FALSE | Self::MAY_BE_FALSE
        })
    }

    /// Returns the knowledge of a value that is known now but may still change.
    pub(crate) const fn changeable(value: bool) -> Truth {
        Truth(Self::UNKNOWN.0 | if value { Self::TRUE } else { Self::FALSE })
    }

    pub(crate) const fn is_true(self) -> bool {
        self.0 & Self::TRUE != 0
    }

    pub(crate) const fn may_be_true(self) -> bool {
        self.0 & Self::MAY_BE_TRUE != 0
    }

    /// Replaces a present value that may still change by [`Truth::UNKNOWN`]; a value that cannot change stays.
    pub(crate) const fn fixed_part(self) -> Truth {
        match self.0 & Self::UNKNOWN.0 == Self::UNKNOWN.0 {
            true => Self::UNKNOWN,
            false => self,
        }
    }

    const fn not(self) -> Truth {
        // Each bit for false is one position above its bit for true, so negation swaps neighbours.
        let odd = self.0 & (Self::TRUE | Self::MAY_BE_TRUE);
        let even = self.0 & (Self::FALSE | Self::MAY_BE_FALSE);
        Truth(odd << 1 | even >> 1)
    }

    const fn and(self, other: Truth) -> Truth {
        let all = (self.0 & other.0) & (Self::TRUE | Self::MAY_BE_TRUE);
        let any = (self.0 | other.0) & (Self::FALSE | Self::MAY_BE_FALSE);
        Truth(all | any)
    }

    const fn or(self, other: Truth) -> Truth {
        self.not().and(other.not()).not()
    }
}

/// One word of a condition in postfix notation: an operand, or an operator after its operands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Word {
    Fact(CommandId, Fact),
    Constant(bool),
    Unknown,
    Not,
    And,
    Or,
}

impl Word {
    /// Encodes the word as three numbers: opcode, command id, argument.
    pub(crate) fn to_numbers(self) -> [u64; 3] {
        let of =
            |what: u64, command: CommandId, argument: u64| [what, command.to_number(), argument];
        match self {
            Word::Fact(command, Fact::Export(k)) => of(1, command, u64::from(k)),
            Word::Fact(command, Fact::Ended) => of(2, command, 0),
            Word::Fact(command, Fact::Regular) => of(3, command, 0),
            Word::Fact(command, Fact::Failed) => of(4, command, 0),
            Word::Fact(command, Fact::Result(k)) => of(5, command, u64::from(k)),
            Word::Fact(command, Fact::Error(number)) => of(6, command, number.cast_unsigned()),
            Word::Constant(value) => [7, 0, u64::from(value)],
            Word::Unknown => [8, 0, 0],
            Word::Not => [9, 0, 0],
            Word::And => [10, 0, 0],
            Word::Or => [11, 0, 0],
        }
    }

    /// Decodes a word from the three numbers of [`Word::to_numbers`]; `None` if they encode no word.
    pub(crate) fn from_numbers(numbers: &[u64]) -> Option<Word> {
        let &[what, command, argument] = numbers else {
            return None;
        };
        let fact = |fact: Fact| Word::Fact(CommandId::from_number(command), fact);
        let index = || u32::try_from(argument).ok();
        Some(match what {
            1 => fact(Fact::Export(index()?)),
            2 => fact(Fact::Ended),
            3 => fact(Fact::Regular),
            4 => fact(Fact::Failed),
            5 => fact(Fact::Result(index()?)),
            6 => fact(Fact::Error(argument.cast_signed())),
            7 => Word::Constant(argument != 0),
            8 => Word::Unknown,
            9 => Word::Not,
            10 => Word::And,
            11 => Word::Or,
            _ => return None,
        })
    }

    /// Number of operands that the word pops from the evaluation stack. Each word pushes one value.
    const fn operand_count(&self) -> usize {
        match self {
            Word::Fact(..) | Word::Constant(_) | Word::Unknown => 0,
            Word::Not => 1,
            Word::And | Word::Or => 2,
        }
    }
}

/// Maximum number of values on the stack while a condition is evaluated. Conditions that need more are rejected when
/// they are made.
const MAX_STACK_DEPTH: usize = 32;

/// Condition of a rule: a Boolean expression over facts about commands.
///
/// Built outside the cycle from [`Condition::from_fact`] and [`Condition::always`] with the operators `&`, `|` and `!`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Condition(Box<[Word]>);

impl Condition {
    /// Makes the condition that is true while a fact about a command is true.
    #[must_use]
    pub fn from_fact(command: CommandId, fact: Fact) -> Condition {
        Condition(vec![Word::Fact(command, fact)].into())
    }

    /// Makes the condition that is always true.
    #[must_use]
    pub fn always() -> Condition {
        Condition(vec![Word::Constant(true)].into())
    }

    /// Returns the commands of all facts in the condition, with duplicates.
    pub fn mentioned_commands(&self) -> impl Iterator<Item = CommandId> + '_ {
        self.0.iter().filter_map(|word| match word {
            Word::Fact(command, _) => Some(*command),
            _ => None,
        })
    }

    /// Returns the words of the condition in postfix order (operands before their operator).
    pub(crate) fn words(&self) -> impl Iterator<Item = &Word> + '_ {
        self.0.iter()
    }

    /// Builds a condition from words in postfix order; `None` if an operand is missing or more than one value is left.
    pub(crate) fn from_words(words: Vec<Word>) -> Option<Condition> {
        let left = words.iter().try_fold(0usize, |depth, word| {
            Some(depth.checked_sub(word.operand_count())? + 1)
        })?;
        (left == 1).then(|| Condition(words.into()))
    }

    /// True if evaluating the condition needs no more stack than the fixed maximum depth.
    pub(crate) fn fits_stack(&self) -> bool {
        let mut depth = 0usize;
        self.0.iter().all(|word| {
            depth = match word {
                Word::Not => depth,
                Word::And | Word::Or => depth.saturating_sub(1),
                _ => depth + 1,
            };
            depth <= MAX_STACK_DEPTH
        })
    }

    /// Evaluates the condition. `know` returns, for a fact about a command, its present and possible later values.
    pub(crate) fn evaluate(&self, know: impl Fn(CommandId, Fact) -> Truth) -> Truth {
        let mut stack = [Truth::UNKNOWN_FOREVER; MAX_STACK_DEPTH];
        let mut top = 0;
        for word in &self.0 {
            let (drop, truth) = match *word {
                Word::Fact(command, fact) => (0, know(command, fact)),
                Word::Constant(value) => (0, Truth::fixed(value)),
                Word::Unknown => (0, Truth::UNKNOWN_FOREVER),
                Word::Not => (1, stack[top - 1].not()),
                Word::And => (2, stack[top - 2].and(stack[top - 1])),
                Word::Or => (2, stack[top - 2].or(stack[top - 1])),
            };
            top -= drop;
            stack[top] = truth;
            top += 1;
        }
        stack[0]
    }

    /// True if the condition cannot become true before this command has ended.
    fn requires_end_of(&self, command: CommandId) -> bool {
        let know = |of: CommandId, fact: Fact| match fact {
            Fact::Export(_) => Truth::UNKNOWN,
            _ if of == command => Truth::fixed(false),
            _ => Truth::UNKNOWN,
        };
        !self.evaluate(know).may_be_true()
    }

    /// True if the condition cannot become true before the first cycle of this command.
    pub(crate) fn requires_start_of(&self, command: CommandId) -> bool {
        let know = |of: CommandId, fact: Fact| match fact {
            _ if of != command => Truth::UNKNOWN,
            Fact::Export(_) => Truth::UNKNOWN_FOREVER,
            _ => Truth::fixed(false),
        };
        self.fits_stack() && !self.evaluate(know).may_be_true()
    }

    /// Returns the commands that must have ended before the condition can be true, in ascending order of their ids.
    pub(crate) fn required_ends(&self) -> Vec<CommandId> {
        if !self.fits_stack() {
            return Vec::new();
        }
        let mut all: Vec<CommandId> = self.mentioned_commands().collect();
        all.sort_unstable();
        all.dedup();
        all.retain(|command| self.requires_end_of(*command));
        all
    }

    /// Replaces the facts about the command `gone`, which is removed from the table, by their final values. `know`
    /// returns the final value of a fact; `None` if the value was never known.
    pub(crate) fn freeze(&mut self, gone: CommandId, know: impl Fn(Fact) -> Option<bool>) {
        for word in &mut self.0 {
            if let Word::Fact(command, fact) = *word
                && command == gone
            {
                *word = know(fact).map_or(Word::Unknown, Word::Constant);
            }
        }
    }

    fn join(self, other: Condition, word: Word) -> Condition {
        let words = self.0.into_iter().chain(other.0).chain([word]);
        Condition(words.collect())
    }
}

impl ops::BitAnd for Condition {
    type Output = Condition;
    fn bitand(self, other: Condition) -> Condition {
        self.join(other, Word::And)
    }
}

impl ops::BitOr for Condition {
    type Output = Condition;
    fn bitor(self, other: Condition) -> Condition {
        self.join(other, Word::Or)
    }
}

impl ops::Not for Condition {
    type Output = Condition;
    fn not(self) -> Condition {
        Condition(self.0.into_iter().chain([Word::Not]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Truth; 6] = [
        Truth::UNKNOWN_FOREVER,
        Truth::UNKNOWN,
        Truth::fixed(true),
        Truth::fixed(false),
        Truth::changeable(true),
        Truth::changeable(false),
    ];

    /// Present value and all possible later values of one `Truth`.
    fn futures(t: Truth) -> (Option<bool>, Vec<Option<bool>>) {
        let now = (t.0 & 3 != 0).then(|| t.is_true());
        let mut later = vec![now];
        later.extend((t.0 & 4 != 0).then_some(Some(true)));
        later.extend((t.0 & 8 != 0).then_some(Some(false)));
        (now, later)
    }

    fn kleene(a: Option<bool>, b: Option<bool>) -> Option<bool> {
        match (a, b) {
            (Some(false), _) | (_, Some(false)) => Some(false),
            (Some(true), Some(true)) => Some(true),
            _ => None,
        }
    }

    #[test]
    fn and_is_kleenes_now_and_in_every_future() {
        for a in ALL {
            for b in ALL {
                let ((now_a, later_a), (now_b, later_b)) = (futures(a), futures(b));
                let got = a.and(b);
                assert_eq!(got.is_true(), kleene(now_a, now_b) == Some(true));
                let may = later_a
                    .iter()
                    .any(|x| later_b.iter().any(|y| kleene(*x, *y) == Some(true)));
                assert_eq!(got.may_be_true(), may, "{a:?} and {b:?}");
                assert_eq!(a.or(b), a.not().and(b.not()).not());
            }
            assert_eq!(a.not().not(), a);
        }
    }

    #[test]
    fn what_must_have_ended_is_found_through_the_operators() {
        let command = |place| CommandId {
            slot: place,
            serial: 1,
        };
        let ended = |place| Condition::from_fact(command(place), Fact::Ended);
        let flag = Condition::from_fact(command(9), Fact::Export(0));
        assert_eq!((ended(1) & flag.clone()).required_ends(), [command(1)]);
        assert_eq!((ended(1) | ended(2)).required_ends(), []);
        let both = (ended(1) & ended(2)) | (ended(2) & flag.clone());
        assert_eq!(both.required_ends(), [command(2)]);
        assert_eq!((!flag).required_ends(), []);
    }

    #[test]
    fn what_must_have_begun_is_found_by_its_exports_too() {
        let command = |place| CommandId {
            slot: place,
            serial: 1,
        };
        let flag = Condition::from_fact(command(1), Fact::Export(0));
        for begun in [flag.clone(), !flag.clone()] {
            assert!(begun.requires_start_of(command(1)));
            assert!(!begun.requires_start_of(command(2)));
        }
        let ended = Condition::from_fact(command(2), Fact::Ended);
        assert!(ended.requires_start_of(command(2)));
        assert!(!(flag | ended.clone()).requires_start_of(command(2)));
        assert!(!(!ended).requires_start_of(command(2)));
    }

    #[test]
    fn too_deep_conditions_are_refused() {
        let fact = || Condition::from_fact(CommandId { slot: 0, serial: 1 }, Fact::Ended);
        let deep = |n| (0..n).fold(fact(), |c, _| fact() & c);
        assert!(deep(MAX_STACK_DEPTH - 1).fits_stack() && !deep(MAX_STACK_DEPTH).fits_stack());
        let wide = (0..1000).fold(fact(), |c, _| c & fact());
        assert!(wide.fits_stack());
    }
}
