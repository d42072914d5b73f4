//! Steps of random histories.

use proptest::prelude::*;
use rpi_core::{Continuity, Fact};

use crate::cell::KINDS;

/// A step of a history. Numbers select among the existing commands and rules.
#[derive(Clone, Debug)]
pub(crate) enum Step {
    Load(usize, Continuity),
    Start(usize),
    Schedule(RuleDraft),
    Withdraw(usize),
    Unschedule(usize),
    Cancel(usize),
    Abort(usize),
    Unload(usize),
    Behave {
        command: usize,
        end: i64,
        flag: bool,
        speed: u8,
    },
    Device {
        axis: usize,
        failed: bool,
    },
    ClientLost(usize),
    EmergencyStop,
    Ticks(u8),
}

/// A rule to be added.
#[derive(Clone, Debug)]
pub(crate) struct RuleDraft {
    pub(crate) condition: Shape,
    pub(crate) stop: Vec<usize>,
    pub(crate) cancel: Vec<usize>,
    pub(crate) start: Vec<usize>,
    pub(crate) kept: bool,
}

#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Fact(usize, Fact),
    Not(Box<Shape>),
    And(Box<Shape>, Box<Shape>),
    Or(Box<Shape>, Box<Shape>),
}

fn fact() -> impl Strategy<Value = Fact> {
    prop_oneof![
        6 => Just(Fact::Regular),
        2 => Just(Fact::Ended),
        2 => Just(Fact::Failed),
        3 => (0u32..3).prop_map(Fact::Result),
        1 => (-1i64..2).prop_map(Fact::Error),
        3 => (0u32..2).prop_map(Fact::Export),
    ]
}

fn shape() -> impl Strategy<Value = Shape> {
    let leaf = (0usize..6, fact()).prop_map(|(k, fact)| Shape::Fact(k, fact));
    leaf.prop_recursive(2, 4, 2, |inner| {
        let pair = (inner.clone(), inner.clone());
        prop_oneof![
            inner.prop_map(|a| Shape::Not(Box::new(a))),
            pair.clone()
                .prop_map(|(a, b)| Shape::And(Box::new(a), Box::new(b))),
            pair.prop_map(|(a, b)| Shape::Or(Box::new(a), Box::new(b))),
        ]
    })
}

fn draft() -> impl Strategy<Value = RuleDraft> {
    let few = |most| prop::collection::vec(0usize..6, 0..most);
    let start = prop::collection::vec(0usize..6, 1..3);
    (
        shape(),
        few(2),
        few(2),
        prop_oneof![8 => start, 1 => few(1)],
        any::<bool>(),
    )
        .prop_map(|(condition, stop, cancel, start, kept)| RuleDraft {
            condition,
            stop,
            cancel,
            start,
            kept,
        })
}

fn guard() -> impl Strategy<Value = Continuity> {
    prop_oneof![
        4 => Just(Continuity::Reject),
        1 => Just(Continuity::AbortAll),
        4 => Just(Continuity::Allow),
    ]
}

pub(crate) fn step() -> impl Strategy<Value = Step> {
    let one = 0usize..6;
    prop_oneof![
        8 => (0..KINDS.len(), guard()).prop_map(|(kind, guard)| Step::Load(kind, guard)),
        6 => one.clone().prop_map(Step::Start),
        12 => draft().prop_map(Step::Schedule),
        1 => (0usize..4).prop_map(Step::Withdraw),
        1 => one.clone().prop_map(Step::Unschedule),
        2 => one.clone().prop_map(Step::Cancel),
        1 => one.clone().prop_map(Step::Abort),
        2 => one.clone().prop_map(Step::Unload),
        10 => (one.clone(), 0i64..5, any::<bool>(), 0u8..3)
            .prop_map(|(command, end, flag, speed)| Step::Behave { command, end, flag, speed }),
        1 => (0usize..4, prop::bool::weighted(0.3)).prop_map(|(axis, failed)| Step::Device { axis, failed }),
        1 => (0usize..2).prop_map(Step::ClientLost),
        1 => prop::bool::weighted(0.2).prop_map(|stop| if stop { Step::EmergencyStop } else { Step::Ticks(1) }),
        14 => (1u8..4).prop_map(Step::Ticks),
    ]
}
