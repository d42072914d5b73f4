//! A core with three commands and two actuators, and its observable state.

use std::hash::{Hash, Hasher};
use std::sync::{Arc, OnceLock};

use rpi_core::{
    AbortReason, Cause, CommandId, CommandState, Continuity, Core, Notice, Rule, RuleOutcome,
};
use rpi_image::Image;

use crate::cell::{self, Axes, TICK_NS, end};

/// Resources of the three commands: one axis, the same axis, both axes.
const KINDS: [usize; 3] = [1, 1, 3];
const COMMANDS: usize = KINDS.len();

/// A transition of the model.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Action {
    Start(usize),
    /// Schedules one command after another: by result `done`, by `early`, or by any result.
    Follow {
        next: usize,
        after: usize,
        by: Option<u32>,
    },
    /// Starts one command when another has failed.
    Rescue {
        next: usize,
        after: usize,
    },
    Cancel(usize),
    Abort(usize),
    Unload(usize),
    /// A tick in which the running commands have these inputs: `end`, and whether they move.
    Tick {
        end: i64,
        moves: bool,
    },
}

impl Action {
    pub(crate) fn all() -> impl Iterator<Item = Action> {
        let one = (0..COMMANDS).flat_map(|k| {
            [
                Action::Start(k),
                Action::Cancel(k),
                Action::Abort(k),
                Action::Unload(k),
            ]
        });
        let two = (0..COMMANDS * COMMANDS).flat_map(|k| {
            let (next, after) = (k / COMMANDS, k % COMMANDS);
            let follow = |by| Action::Follow { next, after, by };
            [
                follow(None),
                follow(Some(0)),
                follow(Some(1)),
                Action::Rescue { next, after },
            ]
        });
        let ends = [0, end::FINISH, end::YIELD, end::FAIL, end::FAULT];
        let ticks = ends
            .into_iter()
            .flat_map(|end| [false, true].map(|moves| Action::Tick { end, moves }));
        one.chain(two).chain(ticks)
    }
}

/// The core under test.
pub(crate) struct CoreUnderTest {
    core: Core,
    bank: Axes,
    ids: [CommandId; COMMANDS],
    rules: usize,
    seen: StepEvents,
}

/// Events of the latest transition.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
struct StepEvents {
    takeover: bool,
    braking: bool,
    loser: bool,
}

fn images() -> &'static [Arc<Image>] {
    static IMAGES: OnceLock<Vec<Arc<Image>>> = OnceLock::new();
    IMAGES.get_or_init(|| KINDS.map(cell::image).to_vec())
}

impl CoreUnderTest {
    pub(crate) fn new() -> CoreUnderTest {
        let (mut core, mut bank) = (Core::with_capacity(COMMANDS, TICK_NS), Axes::new());
        let ids = [0, 1, 2].map(|k| {
            let command = cell::load(&images()[k], Continuity::Reject, &mut bank);
            core.insert(command)
                .map_err(|e| e.1)
                .expect("there is room")
        });
        CoreUnderTest {
            core,
            bank,
            ids,
            rules: 0,
            seen: StepEvents::default(),
        }
    }

    fn state(&self, k: usize) -> Option<CommandState> {
        self.core.command(self.ids[k]).map(rpi_core::Command::state)
    }

    pub(crate) fn carry_out(&mut self, action: Action) {
        let (core, bank, ids) = (&mut self.core, &mut self.bank, &self.ids);
        match action {
            Action::Start(k) => drop(core.start(ids[k], bank)),
            Action::Cancel(k) => drop(core.cancel(ids[k])),
            Action::Abort(k) => drop(core.abort(ids[k], AbortReason::Request, bank)),
            Action::Unload(k) => drop(core.remove(ids[k])),
            Action::Follow { next, after, by } => {
                let rule = match by {
                    None => Rule::follow(ids[after]),
                    Some(result) => Rule::follow_by(ids[after], &[result]),
                };
                self.make(rule.start(ids[next]));
            }
            Action::Rescue { next, after } => {
                let failed = rpi_core::Condition::from_fact(ids[after], rpi_core::Fact::Failed);
                self.make(Rule::when(failed).start(ids[next]).keep_orphans());
            }
            Action::Tick { end, moves } => self.tick(end, moves),
        }
        self.record_events();
    }

    fn make(&mut self, rule: Rule) {
        let made = self.core.schedule(Box::new(rule), &mut self.bank);
        self.rules += usize::from(made.is_ok());
    }

    fn tick(&mut self, end: i64, moves: bool) {
        for id in self.ids {
            if let Some(command) = self.core.command_mut(id).filter(|c| c.state().is_running()) {
                cell::set(command, cell::END, end.cast_unsigned());
                cell::set(command, cell::SPEED, f64::from(u8::from(moves)).to_bits());
            }
        }
        self.core.tick(&mut self.bank, 0, &mut ());
    }

    fn record_events(&mut self) {
        let (mut seen, mut yielded, mut started) = (StepEvents::default(), false, false);
        while let Some(notice) = self.core.next_notice() {
            match notice {
                Notice::Ended { ending, .. } => {
                    yielded |= ending.cause == Cause::Result(1) && !ending.left_moving
                }
                Notice::Started { .. } => started = true,
                Notice::Braked { .. } => seen.braking = true,
                Notice::Rule {
                    outcome: RuleOutcome::Dropped,
                    ..
                } => seen.loser = true,
                _ => {}
            }
        }
        seen.takeover = yielded && started && self.bank.moving.contains(&true);
        seen.loser &= started;
        self.seen = seen;
        while self.core.take_orphan().is_some() {}
        while self.core.take_finished_rule().is_some() {}
    }

    /// Executes an action and checks its effects. Returns the violated property.
    pub(crate) fn check(&mut self, action: Action) -> Option<&'static str> {
        let before = [0, 1, 2].map(|k| self.state(k));
        let first = self
            .core
            .rules()
            .next()
            .map(|(id, rule)| (id, rule.starts().to_vec()));
        let now = self.core.now();
        self.carry_out(action);
        match action {
            Action::Cancel(k) => {
                let runs = before[k].is_some_and(CommandState::is_running);
                let cancelling = self.state(k) == Some(CommandState::Cancelling);
                (runs != cancelling).then_some("a cancel was lost")
            }
            Action::Abort(k) => {
                let runs = before[k].is_some_and(CommandState::is_running);
                (runs && self.state(k) != Some(CommandState::Terminated))
                    .then_some("an abort was lost")
            }
            Action::Unload(k) => {
                let may = before[k].is_some_and(|s| !s.is_running());
                (may && self.state(k).is_some()).then_some("an unload was lost")
            }
            Action::Tick {
                end: end::FINISH, ..
            } => self.check_switch(before, first, now),
            _ => None,
        }
    }

    /// Checks a tick in which all running commands finish: the first rule was waiting for that, or can no longer fire.
    fn check_switch(
        &self,
        before: [Option<CommandState>; COMMANDS],
        first: Option<(rpi_core::RuleId, Vec<CommandId>)>,
        now: u64,
    ) -> Option<&'static str> {
        let ran = |k: &usize| before[*k].is_some_and(CommandState::is_running);
        let over = (0..COMMANDS)
            .filter(ran)
            .all(|k| self.state(k) == Some(CommandState::Terminated));
        if !over {
            return Some("a finish was lost");
        }
        let (rule, starts) = first.filter(|_| (0..COMMANDS).any(|k| ran(&k)))?;
        let pending = self.core.rules().any(|r| r.0 == rule);
        let command = self.core.command(*starts.first()?);
        let runs = command.filter(|c| c.state().is_running());
        let begins = runs.is_some_and(|c| c.instance().cycle() == 0) && self.core.now() == now + 1;
        // The rule has fired, waits for another command, or was dropped together with the commands that it starts.
        let given_up = command
            .is_none_or(|c| matches!(c.state(), CommandState::Ready | CommandState::Scheduled));
        (!(begins || pending || given_up)).then_some("a switch was lost")
    }

    pub(crate) fn snapshot(&self, path: Vec<Action>, wrong: Option<&'static str>) -> Snapshot {
        let look = |k: usize| {
            let command = self.core.command(self.ids[k])?;
            let ending = command.ending();
            Some(CommandView {
                state: command.state(),
                holds: command.held().collect(),
                needs: command.resources().collect(),
                error: ending.map(|e| (e.error, e.cancelled, e.left_moving)),
                result: command.result().map(str::to_owned),
            })
        };
        let index = |id: &CommandId| {
            self.ids
                .iter()
                .position(|other| other == id)
                .unwrap_or(COMMANDS)
        };
        let rules = self.core.rules().map(|(_, rule)| {
            (
                format!("{rule:?}"),
                rule.starts().iter().map(index).collect(),
            )
        });
        Snapshot {
            seen: self.seen,
            commands: [0, 1, 2].map(look),
            rules: rules.collect(),
            moving: [self.bank.moving[0], self.bank.moving[1]],
            made: self.rules,
            tick: self.core.now(),
            wrong,
            path,
        }
    }
}

/// Observable state of a command.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
struct CommandView {
    state: CommandState,
    holds: Vec<u32>,
    needs: Vec<u32>,
    error: Option<(i64, bool, bool)>,
    result: Option<String>,
}

/// Observable state between two ticks, and one path that reaches it.
#[derive(Clone, Debug)]
pub(crate) struct Snapshot {
    seen: StepEvents,
    commands: [Option<CommandView>; COMMANDS],
    /// Rules as text, with the commands that each one starts.
    rules: Vec<(String, Vec<usize>)>,
    moving: [bool; 2],
    made: usize,
    tick: u64,
    wrong: Option<&'static str>,
    path: Vec<Action>,
}

impl PartialEq for Snapshot {
    fn eq(&self, other: &Self) -> bool {
        let all = |s: &Self| (s.seen, s.moving, s.made, s.tick, s.wrong);
        all(self) == all(other) && self.commands == other.commands && self.rules == other.rules
    }
}

impl Eq for Snapshot {}

impl Hash for Snapshot {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (self.seen, &self.commands, &self.rules).hash(state);
        (self.moving, self.made, self.tick, self.wrong).hash(state);
    }
}

impl Snapshot {
    pub(crate) fn path(&self) -> &[Action] {
        &self.path
    }

    pub(crate) fn ticks(&self) -> u64 {
        self.tick
    }

    pub(crate) fn rules_made(&self) -> usize {
        self.made
    }

    pub(crate) fn wrong(&self) -> Option<&'static str> {
        self.wrong
    }

    pub(crate) fn saw_takeover(&self) -> bool {
        self.seen.takeover
    }

    pub(crate) fn saw_braking(&self) -> bool {
        self.seen.braking
    }

    pub(crate) fn saw_loser(&self) -> bool {
        self.seen.loser
    }

    /// Whether an action is worth exploring. Requests that are rejected for their state are tested elsewhere.
    pub(crate) fn offers(&self, action: &Action) -> bool {
        let state = |k: usize| self.commands[k].as_ref().map(|c| c.state);
        match *action {
            Action::Start(k) => state(k) == Some(CommandState::Ready),
            Action::Cancel(k) => state(k) == Some(CommandState::Running),
            Action::Abort(k) => state(k).is_some_and(CommandState::is_running),
            Action::Unload(k) => state(k).is_some_and(|s| !s.is_running()),
            Action::Follow { next, after, .. } | Action::Rescue { next, after } => {
                let waits = matches!(
                    state(next),
                    Some(CommandState::Ready | CommandState::Scheduled)
                );
                waits && next != after && state(after).is_some()
            }
            Action::Tick { .. } => self.commands.iter().flatten().any(|c| c.state.is_running()),
        }
    }

    fn present(&self) -> impl Iterator<Item = &CommandView> {
        self.commands.iter().flatten()
    }

    pub(crate) fn moving_is_held(&self) -> bool {
        (0..2u32).filter(|r| self.moving[*r as usize]).all(|r| {
            let mut running = self.present().filter(|c| c.state.is_running());
            running.any(|c| c.holds.contains(&r))
        })
    }

    pub(crate) fn is_exclusive(&self) -> bool {
        (0..2u32).all(|r| {
            let holders: Vec<_> = self.present().filter(|c| c.holds.contains(&r)).collect();
            holders.len() <= 1 || holders.iter().all(|c| c.state == CommandState::Scheduled)
        })
    }

    pub(crate) fn idle_hold_nothing(&self) -> bool {
        self.present().all(|c| match c.state {
            CommandState::Running | CommandState::Cancelling => c.holds == c.needs,
            CommandState::Scheduled => true,
            _ => c.holds.is_empty(),
        })
    }

    pub(crate) fn nobody_waits_in_vain(&self) -> bool {
        let waits = |k: &usize| {
            let command = self.commands[*k].as_ref();
            command.is_some_and(|c| c.state == CommandState::Scheduled)
        };
        let named = |k: usize| self.rules.iter().any(|(_, starts)| starts.contains(&k));
        let startable = |starts: &Vec<usize>| starts.iter().all(|k| *k < COMMANDS && waits(k));
        (0..COMMANDS).filter(waits).all(named) && self.rules.iter().all(|(_, s)| startable(s))
    }
}
