//! Encoding of rules as plain numbers, for recordings and transmission.
//!
//! ```text
//! rule      = condition, stop, cancel, start, handed over (each its length, then its words), kept (0 or 1)
//! handed    = predecessor, export, successor, input
//! condition = words of three numbers: opcode, command, argument
//! set       = command ids
//! ```

use crate::condition::{Condition, Word};
use crate::ids::CommandId;
use crate::rule::Rule;

use alloc::vec::Vec;

impl Rule {
    /// Encodes the rule as numbers, for recordings and transmission; [`Rule::from_words`] decodes them.
    #[must_use]
    pub fn to_words(&self) -> Vec<u64> {
        let condition: Vec<u64> = self
            .condition
            .words()
            .flat_map(|word| word.to_numbers())
            .collect();
        let mut words = Vec::new();
        push_part(&mut words, condition.into_iter());
        for set in [&self.stop, &self.cancel, &self.start] {
            push_part(&mut words, set.iter().map(|c| c.to_number()));
        }
        let handed = self.transfers.iter().flat_map(|handed| {
            let (export, input) = (u64::from(handed.export), u64::from(handed.input));
            [
                handed.from.to_number(),
                export,
                handed.to.to_number(),
                input,
            ]
        });
        let handed: Vec<u64> = handed.collect();
        push_part(&mut words, handed.into_iter());
        words.push(u64::from(self.keeps_orphans));
        words
    }

    /// Decodes a rule from the numbers of [`Rule::to_words`]; `None` if the numbers are malformed.
    #[must_use]
    pub fn from_words(words: &[u64]) -> Option<Rule> {
        let (condition, rest) = split_part(words)?;
        let (stop, rest) = split_part(rest)?;
        let (cancel, rest) = split_part(rest)?;
        let (start, rest) = split_part(rest)?;
        let (handed, rest) = split_part(rest)?;
        let (&[kept @ (0 | 1)], (handed, [])) = (rest, handed.as_chunks()) else {
            return None;
        };
        let condition = condition.chunks(3).map(Word::from_numbers);
        let mut rule = Rule::when(Condition::from_words(condition.collect::<Option<_>>()?)?);
        rule = command_ids(stop).fold(rule, Rule::stop);
        rule = command_ids(cancel).fold(rule, Rule::cancel);
        rule = command_ids(start).fold(rule, Rule::start);
        for [from, export, to, input] in handed {
            let [from, to] = [*from, *to].map(CommandId::from_number);
            let [export, input] = [*export, *input].map(u32::try_from);
            rule = rule.transfer((from, export.ok()?), (to, input.ok()?));
        }
        Some(if kept == 1 { rule.keep_orphans() } else { rule })
    }
}

fn push_part(words: &mut Vec<u64>, part: impl ExactSizeIterator<Item = u64>) {
    words.push(part.len() as u64);
    words.extend(part);
}

/// Splits off the first part of an encoding, whose length stands before it. Returns the part and the rest; `None` if
/// the encoding is too short.
fn split_part(words: &[u64]) -> Option<(&[u64], &[u64])> {
    let (len, rest) = words.split_first()?;
    rest.split_at_checked(usize::try_from(*len).ok()?)
}

fn command_ids(words: &[u64]) -> impl Iterator<Item = CommandId> + '_ {
    words.iter().map(|number| CommandId::from_number(*number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::condition::Fact;

    fn rule() -> Rule {
        let command = |place: u64| CommandId::from_number(7 << 32 | place);
        let facts = [
            Fact::Export(3),
            Fact::Ended,
            Fact::Regular,
            Fact::Failed,
            Fact::Result(2),
            Fact::Error(-5),
        ];
        let all = facts.map(|fact| Condition::from_fact(command(1), fact));
        let all = all.into_iter().reduce(|a, b| a & !b);
        let condition = all.map_or_else(Condition::always, |all| all | Condition::always());
        let rule = Rule::when(condition).stop(command(4)).stop(command(3));
        let rule = rule.cancel(command(5)).start(command(6)).keep_orphans();
        rule.transfer((command(4), 2), (command(6), 1))
    }

    #[test]
    fn a_rule_comes_back_from_its_numbers() {
        assert_eq!(Rule::from_words(&rule().to_words()), Some(rule()));
    }

    /// Decoding arbitrary numbers yields `None` or a rule whose condition can be evaluated.
    #[test]
    fn what_is_no_rule_is_refused() {
        let words = rule().to_words();
        for end in 0..words.len() {
            assert_eq!(Rule::from_words(&words[..end]), None, "{end}");
        }
        for at in 0..words.len() {
            for value in [0, 1, 2, 9, 10, 11, u64::MAX] {
                let mut words = words.clone();
                words[at] = value;
                if let Some(rule) = Rule::from_words(&words) {
                    let _ =
                        rule.condition.fits_stack() && rule.condition.required_ends().is_empty();
                }
            }
        }
    }
}
