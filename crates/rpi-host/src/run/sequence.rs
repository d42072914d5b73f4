//! Which command follows which: one after the other, and repetitions.

/// A part of a sequence.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Item {
    /// The command of this index.
    Run(usize),
    /// All of these, so many times; without a number for ever.
    Repeat {
        /// How many times.
        times: Option<u64>,
        /// What is repeated.
        body: Vec<Item>,
    },
}

/// Commands in the order in which they run.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Sequence(pub Vec<Item>);

impl Sequence {
    /// One command, once.
    #[must_use]
    pub fn once(command: usize) -> Sequence {
        Sequence(vec![Item::Run(command)])
    }

    /// The commands in order; may never end.
    pub fn walk(&self) -> impl Iterator<Item = usize> + Send + '_ {
        Walk {
            open: vec![Level {
                items: &self.0,
                at: 0,
                left: Some(1),
            }],
        }
    }
}

struct Walk<'a> {
    open: Vec<Level<'a>>,
}

struct Level<'a> {
    items: &'a [Item],
    at: usize,
    /// How many more times, this time included.
    left: Option<u64>,
}

impl Iterator for Walk<'_> {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        loop {
            let level = self.open.last_mut()?;
            match level.items.get(level.at) {
                None => self.again_or_out(),
                Some(Item::Run(command)) => {
                    level.at += 1;
                    return Some(*command);
                }
                Some(Item::Repeat { times, body }) => {
                    level.at += 1;
                    self.enter(*times, body);
                }
            }
        }
    }
}

impl<'a> Walk<'a> {
    /// Goes into a repetition that runs anything.
    fn enter(&mut self, times: Option<u64>, body: &'a [Item]) {
        if times != Some(0) && body.iter().any(runs) {
            self.open.push(Level {
                items: body,
                at: 0,
                left: times,
            });
        }
    }

    fn again_or_out(&mut self) {
        let Some(level) = self.open.last_mut() else {
            return;
        };
        level.left = level.left.map(|left| left - 1);
        level.at = 0;
        if level.left == Some(0) {
            self.open.pop();
        }
    }
}

/// True if a command comes out of it; what never gives one must not be repeated for ever.
fn runs(item: &Item) -> bool {
    match item {
        Item::Run(_) => true,
        Item::Repeat { times, body } => *times != Some(0) && body.iter().any(runs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn repeat(times: Option<u64>, body: Vec<Item>) -> Item {
        Item::Repeat { times, body }
    }

    fn walked(items: Vec<Item>, most: usize) -> Vec<usize> {
        Sequence(items).walk().take(most).collect()
    }

    #[test]
    fn repetitions_nest() {
        let inner = repeat(Some(2), vec![Item::Run(1)]);
        let items = vec![Item::Run(0), repeat(Some(2), vec![inner, Item::Run(2)])];
        assert_eq!(walked(items, 99), [0, 1, 1, 2, 1, 1, 2]);
    }

    #[test]
    fn a_repetition_without_a_number_goes_on() {
        let items = vec![repeat(None, vec![Item::Run(0), Item::Run(1)])];
        assert_eq!(walked(items, 5), [0, 1, 0, 1, 0]);
    }

    #[test]
    fn nothing_repeated_is_nothing() {
        let nothing = repeat(None, vec![repeat(Some(0), vec![Item::Run(3)])]);
        assert_eq!(
            walked(vec![nothing, repeat(None, vec![]), Item::Run(1)], 9),
            [1]
        );
        assert_eq!(Sequence::once(7).walk().collect::<Vec<_>>(), [7]);
    }
}
