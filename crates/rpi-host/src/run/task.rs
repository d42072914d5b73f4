//! A task under way: works ahead of its running command, as a program outside of the core could.
//!
//! Everything that may follow the running command is loaded and scheduled by rules on its results. What the core then starts
//! goes on; the others it gives up by itself. What was not scheduled in time is started when it is ready, and counted as late.

use rpi_core::{CommandId, Condition, Ending, Fact, Notice, Outcome, Rule, RuleId};
use rpi_image::Image;
use rpi_image::image::EndResult;

use super::end;
use super::host::{Books, Desk};
use super::plan::{After, Cursor, Plan, Successor};
use crate::control::{Event, Rejected, Ticket};

/// A task under way.
pub(super) struct Task<'a> {
    plan: &'a Plan,
    running: Option<Slot>,
    /// What may follow, once it is scheduled.
    ahead: Option<Vec<Slot>>,
    over: bool,
}

/// A command of a task.
struct Slot {
    id: CommandId,
    cursor: Cursor,
    /// The request that is to start it, at once or by a rule.
    ticket: Ticket,
    rule: Option<RuleId>,
    first_tick: Option<u64>,
    ending: Option<Ending>,
    /// Why it was not started.
    refused: Option<rpi_core::Refused>,
    /// Its rule is dropped or has failed.
    dropped: bool,
}

impl Slot {
    fn new(id: CommandId, cursor: Cursor, ticket: Ticket, rule: Option<RuleId>) -> Slot {
        Slot {
            id,
            cursor,
            ticket,
            rule,
            first_tick: None,
            ending: None,
            refused: None,
            dropped: false,
        }
    }

    /// Its rule will not start it any more.
    fn drop_rule(&mut self, outcome: Outcome) {
        self.dropped = true;
        if let Outcome::Failed(why) = outcome {
            self.refused = Some(why);
        }
    }

    /// True if what was asked for did not start it.
    fn is_refused(&self) -> bool {
        self.first_tick.is_none() && (self.dropped || self.refused.is_some())
    }

    /// True while it may still be started by what was asked for.
    fn is_open(&self) -> bool {
        self.first_tick.is_none() && !self.dropped && self.refused.is_none()
    }
}

impl<'a> Task<'a> {
    pub(super) fn new(plan: &'a Plan) -> Task<'a> {
        Task {
            plan,
            running: None,
            ahead: None,
            over: false,
        }
    }

    pub(super) fn is_over(&self) -> bool {
        self.over
    }

    /// Notes what concerns its commands.
    pub(super) fn hear(&mut self, event: &Event) {
        let ahead = self.ahead.iter_mut().flatten();
        let mut slots = self.running.iter_mut().chain(ahead);
        match *event {
            Event::Notice(Notice::Started { command, tick }) => slots
                .filter(|s| s.id == command)
                .for_each(|s| s.first_tick = Some(tick)),
            Event::Notice(Notice::Ended {
                command, ending, ..
            }) => slots
                .filter(|s| s.id == command)
                .for_each(|s| s.ending = Some(ending)),
            Event::Notice(Notice::Rule { rule, outcome }) if outcome != Outcome::Fired => slots
                .filter(|s| s.rule == Some(rule))
                .for_each(|s| s.drop_rule(outcome)),
            Event::Answer {
                ticket, refused, ..
            } => {
                if let Some(slot) = slots.find(|s| s.ticket == ticket) {
                    slot.refused = refused;
                }
            }
            _ => {}
        }
    }

    /// Does what can be done now.
    pub(super) fn advance(&mut self, desk: &mut Desk<'_>, books: &mut Books<'_>) {
        if self.over {
            return;
        }
        match &self.running {
            None => match self.plan.first() {
                Some(cursor) => self.start(cursor, desk, books),
                None => self.over = true,
            },
            Some(slot) if slot.is_refused() => self.refuse(desk, books),
            Some(slot) if slot.ending.is_some() => self.go_on(desk, books),
            Some(_) => self.look_ahead(desk, books),
        }
    }

    fn start(&mut self, cursor: Cursor, desk: &mut Desk<'_>, books: &mut Books<'_>) {
        let index = self.plan.command(&cursor);
        let started = desk
            .load(index)
            .and_then(|id| Ok((id, desk.control.start(id)?)));
        match started {
            Ok((id, ticket)) => {
                self.running = Some(Slot::new(id, cursor, ticket, None));
                self.ahead = None;
                self.look_ahead(desk, books);
            }
            Err(rejected) => self.give_up(index, rejected, books),
        }
    }

    fn refuse(&mut self, desk: &Desk<'_>, books: &mut Books<'_>) {
        self.over = true;
        if let Some(slot) = self.running.take()
            && let Some(why) = slot.refused
        {
            books.not_started(
                self.plan.command(&slot.cursor),
                end::refused(why, desk.cell),
            );
        }
    }

    fn give_up(&mut self, index: usize, rejected: Rejected, books: &mut Books<'_>) {
        self.over = true;
        match rejected {
            Rejected::Loading(faults) => books.not_loaded(index, faults),
            other => books.not_started(index, other.to_string()),
        }
    }

    /// Schedules all that may follow, once planning is over.
    fn look_ahead(&mut self, desk: &mut Desk<'_>, books: &mut Books<'_>) {
        let Some(slot) = self.running.as_ref().filter(|_| self.ahead.is_none()) else {
            return;
        };
        let planned = slot.first_tick.map_or(desk.planning == 0, |first| {
            desk.tick() >= first + desk.planning
        });
        if !planned {
            return;
        }
        let (id, image) = (slot.id, &desk.images[self.plan.command(&slot.cursor)]);
        let mut ahead = Vec::new();
        for successor in self.plan.successors(&slot.cursor, image) {
            let index = self.plan.command(&successor.cursor);
            match schedule((id, image), successor, index, desk) {
                Ok(slot) => ahead.push(slot),
                Err(rejected) => return self.give_up(index, rejected, books),
            }
        }
        self.ahead = Some(ahead);
    }

    /// Its command has ended: goes on with what the core has started, or with what should have been.
    fn go_on(&mut self, desk: &mut Desk<'_>, books: &mut Books<'_>) {
        let ahead = self.ahead.as_deref().unwrap_or_default();
        if ahead.iter().any(Slot::is_open) {
            return;
        }
        let Some(ended) = self.running.take() else {
            return;
        };
        let ahead = self.ahead.take().unwrap_or_default();
        let refused = ahead.iter().filter(|s| s.refused.is_some());
        refused.for_each(|s| drop(desk.control.unload(s.id)));
        self.running = ahead.into_iter().find(|s| s.first_tick.is_some());
        let image = &desk.images[self.plan.command(&ended.cursor)];
        let after = match self.running {
            Some(_) => None,
            None => Some(self.after(&ended, image)),
        };
        if let Some(After::Run(cursor)) = &after {
            desk.late += 1;
            self.start_late(&ended, cursor, desk, books);
        }
        // It can only be refused if it is unloaded already.
        let _ = desk.control.unload(ended.id);
        match after {
            Some(After::Done | After::Error) => self.over = true,
            _ if self.over => {}
            _ => self.look_ahead(desk, books),
        }
    }

    /// Starts what follows a command that has ended already, by a rule as in time: it takes over the same, and knows whom it
    /// follows.
    fn start_late(
        &mut self,
        ended: &Slot,
        cursor: &Cursor,
        desk: &mut Desk<'_>,
        books: &mut Books<'_>,
    ) {
        let before = &desk.images[self.plan.command(&ended.cursor)];
        let mut successors = self.plan.successors(&ended.cursor, before).into_iter();
        let Some(successor) = successors.find(|s| s.cursor == *cursor) else {
            self.over = true;
            return;
        };
        let index = self.plan.command(cursor);
        match schedule((ended.id, before), successor, index, desk) {
            Ok(slot) => (self.running, self.ahead) = (Some(slot), None),
            Err(rejected) => self.give_up(index, rejected, books),
        }
    }

    fn after(&self, ended: &Slot, image: &Image) -> After {
        let Some(ending) = ended.ending.filter(|e| !e.cancelled) else {
            return After::Error;
        };
        let result = |r: &'_ EndResult| self.plan.after(&ended.cursor, Some((&r.name, r.kind)));
        match end::result_of(image, ending) {
            Some(named) => result(named),
            None if ending.is_regular() => self.plan.after(&ended.cursor, None),
            None => After::Error,
        }
    }
}

/// Loads a successor and makes the rule that starts it, with what it takes over.
fn schedule(
    (after, image): (CommandId, &Image),
    successor: Successor,
    index: usize,
    desk: &mut Desk<'_>,
) -> Result<Slot, Rejected> {
    let id = desk.load(index)?;
    let mut rule = Rule::when(condition(after, &successor)).start(id);
    for (export, input) in handed(image, &desk.images[index]) {
        rule = rule.hand((after, export), (id, input));
    }
    let (rule, ticket) = desk.control.schedule(rule)?;
    Ok(Slot::new(id, successor.cursor, ticket, Some(rule)))
}

/// The exports of a command from which its successor takes inputs over: those of the same key.
fn handed(from: &Image, to: &Image) -> Vec<(u32, u32)> {
    let key_of = |key: &str| from.exports.iter().position(|export| export.key == key);
    let inputs = to.inputs.iter().zip(0..);
    let pairs = inputs.filter_map(|(input, k)| Some((u32::try_from(key_of(&input.key)?).ok()?, k)));
    pairs.collect()
}

/// It has ended by one of these results; without named ones, regularly.
fn condition(after: CommandId, successor: &Successor) -> Condition {
    let fact = |fact: Fact| Condition::of(after, fact);
    let any = |results: &[u32]| {
        let one = results.iter().map(|k| fact(Fact::Result(*k)));
        one.reduce(|a, b| a | b)
    };
    let regular = any(&successor.regular).map(|r| fact(Fact::Regular) & r);
    match (regular, any(&successor.fails)) {
        (Some(a), Some(b)) => a | b,
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => fact(Fact::Regular),
    }
}
