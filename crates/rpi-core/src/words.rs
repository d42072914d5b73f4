//! Encoding of rules as plain numbers, for recordings and transmission.
//!
//! ```text
//! rule      = condition, stop, cancel, start, handed over (each its length, then its words), kept (0 or 1)
//! handed    = predecessor, export, successor, input
//! condition = words of three numbers: opcode, command, argument
//! set       = command ids
//! ```

use crate::condition::{Condition, Word};
use crate::id::CommandId;
use crate::rule::Rule;

use alloc::vec::Vec;

impl Rule {
    /// Encodes the rule; see [`Rule::from_words`].
    #[must_use]
    pub fn to_words(&self) -> Vec<u64> {
        let condition: Vec<u64> = self.condition.words().flat_map(Word::numbers).collect();
        let mut words = Vec::new();
        put(&mut words, condition.into_iter());
        for set in [&self.stop, &self.cancel, &self.start] {
            put(&mut words, set.iter().map(|c| c.number()));
        }
        let handed = self.handed.iter().flat_map(|handed| {
            let (export, input) = (u64::from(handed.export), u64::from(handed.input));
            [handed.from.number(), export, handed.to.number(), input]
        });
        let handed: Vec<u64> = handed.collect();
        put(&mut words, handed.into_iter());
        words.push(u64::from(self.kept));
        words
    }

    /// Decodes a rule; `None` if the numbers are malformed.
    #[must_use]
    pub fn from_words(words: &[u64]) -> Option<Rule> {
        let (condition, rest) = take(words)?;
        let (stop, rest) = take(rest)?;
        let (cancel, rest) = take(rest)?;
        let (start, rest) = take(rest)?;
        let (handed, rest) = take(rest)?;
        let (&[kept @ (0 | 1)], (handed, [])) = (rest, handed.as_chunks()) else {
            return None;
        };
        let condition = condition.chunks(3).map(Word::of_numbers);
        let mut rule = Rule::when(Condition::of_words(condition.collect::<Option<_>>()?)?);
        rule = named(stop).fold(rule, Rule::stop);
        rule = named(cancel).fold(rule, Rule::cancel);
        rule = named(start).fold(rule, Rule::start);
        for [from, export, to, input] in handed {
            let [from, to] = [*from, *to].map(CommandId::from_number);
            let [export, input] = [*export, *input].map(u32::try_from);
            rule = rule.hand((from, export.ok()?), (to, input.ok()?));
        }
        Some(if kept == 1 { rule.keep() } else { rule })
    }
}

fn put(words: &mut Vec<u64>, part: impl ExactSizeIterator<Item = u64>) {
    words.push(part.len() as u64);
    words.extend(part);
}

/// Splits off a part with a length prefix. Returns the part and the rest.
fn take(words: &[u64]) -> Option<(&[u64], &[u64])> {
    let (len, rest) = words.split_first()?;
    rest.split_at_checked(usize::try_from(*len).ok()?)
}

fn named(words: &[u64]) -> impl Iterator<Item = CommandId> + '_ {
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
        let all = facts.map(|fact| Condition::of(command(1), fact));
        let all = all.into_iter().reduce(|a, b| a & !b);
        let condition = all.map_or_else(Condition::always, |all| all | Condition::always());
        let rule = Rule::when(condition).stop(command(4)).stop(command(3));
        let rule = rule.cancel(command(5)).start(command(6)).keep();
        rule.hand((command(4), 2), (command(6), 1))
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
                    let _ = rule.condition.fits() && rule.condition.requires().is_empty();
                }
            }
        }
    }
}
