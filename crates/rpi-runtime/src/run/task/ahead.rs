//! Loading of the commands that may follow, and scheduling them by rules on the results of the running ones.

use rpi_core::{CommandId, Condition, Fact, Rule};
use rpi_image::Image;
use rpi_image::image::{End, EndKind};

use super::super::plan::Plan;
use super::super::walk::{By, Cursor, Place};
use super::launch::{Request, Slot, Trouble};
use super::track::{Spot, Track};
use super::workshop::{NotStarted, Workshop};
use crate::control::Rejected;

/// Plan of a task, and the control core on which the task runs.
pub(super) struct Site<'s> {
    pub(super) plan: &'s Plan,
    pub(super) shop: &'s mut dyn Workshop,
}

/// A loaded successor with the rule that starts it.
#[derive(Debug)]
pub(super) struct Launch {
    pub(super) track: Track,
}

impl Launch {
    /// Returns true if the successor will never start.
    pub(super) fn is_given_up(&self) -> bool {
        !self.track.is_open() && !self.track.has_started()
    }
}

/// Condition under which a successor starts, and the commands that it follows.
struct Cause {
    after: Vec<Slot>,
    condition: Condition,
}

impl Cause {
    fn and(mut self, other: Cause) -> Cause {
        self.after.extend(other.after);
        self.condition = self.condition & other.condition;
        self
    }
}

impl Site<'_> {
    /// Loads the commands at a place without predecessors and requests their start.
    ///
    /// # Errors
    /// Returns the commands that could not be started, with the reason.
    pub(super) fn begin(&mut self, place: Place) -> Result<Track, Trouble> {
        let mut track = self.load(place)?;
        let commands: Vec<CommandId> = track.slots().iter().map(|s| s.id).collect();
        let asked = match commands.as_slice() {
            [only] => self
                .shop
                .start(*only)
                .map(|ticket| Request::new(ticket, None)),
            all => {
                let rule = Rule::when(Condition::always());
                let rule = all.iter().copied().fold(rule, Rule::start);
                self.shop
                    .schedule(rule)
                    .map(|(rule, ticket)| Request::new(ticket, Some(rule)))
            }
        };
        track.request = Some(asked.map_err(|why| trouble(track.indices(), why))?);
        Ok(track)
    }

    /// Loads and schedules all possible successors of a track. Returns `None` as long as the successors are not known
    /// or planning must wait.
    ///
    /// # Errors
    /// Returns the commands that could not be loaded, with the reason.
    pub(super) fn ahead_of(&mut self, track: &Track) -> Result<Option<Vec<Launch>>, Trouble> {
        let planned = |slot: &&Slot| self.shop.may_plan(slot.first_tick);
        if !track.slots().iter().all(planned) {
            return Ok(None);
        }
        let Some(ways) = self.ways(track) else {
            return Ok(None);
        };
        let mut ahead = Vec::new();
        for (place, cause) in ways {
            ahead.push(self.launch(place, cause)?);
        }
        Ok(Some(ahead))
    }

    /// Returns the possible next places of a track with their conditions; `None` as long as parallel branches have more
    /// commands to run before they join.
    fn ways(&self, track: &Track) -> Option<Vec<(Place, Cause)>> {
        match &track.spot {
            Spot::Command(slot) => {
                let image = self.shop.image(slot.index);
                let ways = self.plan.ways(&slot.cursor, &image).into_iter();
                let goes_on = |place: &Place| matches!(place, Place::Run(_) | Place::Split { .. });
                let ways = ways.filter(|(place, _)| goes_on(place));
                Some(ways.map(|(place, by)| (place, cause(slot, &by))).collect())
            }
            Spot::Split { at, .. } => match self.plan.behind(at) {
                Place::Joined | Place::Done => Some(Vec::new()),
                place => Some(vec![(place, self.joins(track)?)]),
            },
            Spot::Nothing => Some(Vec::new()),
        }
    }

    /// Returns the condition for the end of a track; `None` if the end needs more than its running commands.
    fn joins(&self, track: &Track) -> Option<Cause> {
        match &track.spot {
            Spot::Command(slot) => {
                let image = self.shop.image(slot.index);
                let ways = self.plan.ways(&slot.cursor, &image).into_iter();
                let by = ways.filter(|(place, _)| *place == Place::Joined);
                by.map(|(_, by)| cause(slot, &by)).next()
            }
            Spot::Split { strands, .. } => {
                let busy = strands.iter().filter(|s| !matches!(s.spot, Spot::Nothing));
                let mut all = None;
                for strand in busy {
                    let is_split = matches!(&strand.spot, Spot::Split { at, .. } if self.plan.behind(at) != Place::Joined);
                    let own = self.joins(strand).filter(|_| !is_split)?;
                    all = Some(match all {
                        Some(all) => Cause::and(all, own),
                        None => own,
                    });
                }
                all
            }
            Spot::Nothing => None,
        }
    }

    /// Continues at a place that was not scheduled in time. The command is started by a rule as well, so that it takes
    /// over in the same way and has the same predecessors.
    ///
    /// # Errors
    /// Returns the commands that could not be loaded, with the reason.
    pub(super) fn catch_up(&mut self, ended: &Track, place: Place) -> Result<Track, Trouble> {
        let mut ways = self.ways(ended).unwrap_or_default().into_iter();
        let cause = match ways.find(|(known, _)| *known == place) {
            Some((_, cause)) => {
                let slots = ended.slots().into_iter();
                let yields = slots.map(|s| has_yield(&self.shop.image(s.index)));
                let in_motion = yields.fold(false, |all, one| all | one);
                self.shop.late(in_motion);
                cause
            }
            // The branches were left because of an error, so the next place could not be known in advance.
            None => Cause {
                after: ended.slots().into_iter().cloned().collect(),
                condition: Condition::always(),
            },
        };
        Ok(self.launch(place, cause)?.track)
    }

    /// Unloads successors whose rule was refused. The core unloads the others when it drops their rules.
    pub(super) fn forget_refused(&mut self, ahead: &[Launch]) {
        let refused = |launch: &&Launch| {
            let request = launch.track.request.as_ref();
            request.is_some_and(Request::was_refused)
        };
        for launch in ahead.iter().filter(refused) {
            let slots = launch.track.slots().into_iter();
            slots.for_each(|slot| self.shop.unload(slot.id));
        }
    }

    /// Loads the commands at a place and adds the rule that starts them and passes values to their inputs.
    fn launch(&mut self, place: Place, cause: Cause) -> Result<Launch, Trouble> {
        let mut track = self.load(place)?;
        let mut rule = Rule::when(cause.condition);
        for slot in track.slots() {
            rule = rule.start(slot.id);
            let image = self.shop.image(slot.index);
            for (from, export, input) in self.handed(&cause.after, &image) {
                rule = rule.hand((from, export), (slot.id, input));
            }
        }
        let asked = self.shop.schedule(rule);
        let (rule, ticket) = asked.map_err(|why| trouble(track.indices(), why))?;
        track.request = Some(Request::new(ticket, Some(rule)));
        Ok(Launch { track })
    }

    /// Loads the commands at a place. If one cannot be loaded, the others are unloaded.
    fn load(&mut self, place: Place) -> Result<Track, Trouble> {
        match place {
            Place::Run(cursor) => Ok(Track::new(Spot::Command(self.slot(cursor)?), None)),
            Place::Split { at, strands } => {
                let mut loaded: Vec<Track> = Vec::new();
                for strand in strands {
                    match self.load(strand) {
                        Ok(track) => loaded.push(track),
                        Err(why) => {
                            let slots = loaded.iter().flat_map(Track::slots);
                            slots.for_each(|slot| self.shop.unload(slot.id));
                            return Err(why);
                        }
                    }
                }
                let spot = Spot::Split {
                    at,
                    strands: loaded,
                    leaving: None,
                    met: Vec::new(),
                };
                Ok(Track::new(spot, None))
            }
            _ => Ok(Track::new(Spot::Nothing, None)),
        }
    }

    fn slot(&mut self, cursor: Cursor) -> Result<Slot, Trouble> {
        let index = self.plan.command(&cursor);
        let loaded = self.shop.load(index);
        let id = loaded.map_err(|why| trouble(vec![index], why))?;
        Ok(Slot {
            id,
            cursor,
            index,
            first_tick: None,
            ending: None,
        })
    }

    /// Returns the exports of predecessors that are passed to the inputs of a successor: same key and type; the first
    /// predecessor with a match counts. Each entry is predecessor, export index, input index.
    fn handed(&self, from: &[Slot], to: &Image) -> Vec<(CommandId, u32, u32)> {
        let inputs = to.inputs.iter().zip(0u32..);
        let found = inputs.filter_map(|(input, k)| {
            from.iter().find_map(|slot| {
                let image = self.shop.image(slot.index);
                let same = |e: &rpi_image::image::Export| {
                    e.key == input.key && e.value.ty == input.value.ty
                };
                let export = image.exports.iter().position(same)?;
                Some((slot.id, u32::try_from(export).ok()?, k))
            })
        });
        found.collect()
    }
}

fn trouble(indices: Vec<usize>, why: Rejected) -> Trouble {
    Trouble {
        indices,
        why: NotStarted::Rejected(why),
    }
}

fn has_yield(image: &Image) -> bool {
    match &image.end {
        End::Results(results) => results.iter().any(|r| r.kind == EndKind::Yield),
        End::Ports { .. } => false,
    }
}

/// Returns the condition that a command has ended with one of these results, or regularly if it has no named results.
fn cause(slot: &Slot, by: &By) -> Cause {
    let fact = |fact: Fact| Condition::of(slot.id, fact);
    let any = |results: &[u32]| {
        let one = results.iter().map(|k| fact(Fact::Result(*k)));
        one.reduce(|a, b| a | b)
    };
    let regular = any(&by.regular).map(|r| fact(Fact::Regular) & r);
    let condition = match (regular, any(&by.fails)) {
        (Some(a), Some(b)) => a | b,
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => fact(Fact::Regular),
    };
    Cause {
        after: vec![slot.clone()],
        condition,
    }
}
