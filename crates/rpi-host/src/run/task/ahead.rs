//! What may follow, loaded and scheduled by rules on the results of what runs.

use rpi_core::{CommandId, Condition, Fact, Rule};
use rpi_image::Image;
use rpi_image::image::{End, EndKind};

use super::super::plan::Plan;
use super::super::walk::{By, Cursor, Place};
use super::launch::{Request, Slot, Trouble};
use super::track::{Spot, Track};
use super::workshop::{NotStarted, Workshop};
use crate::control::Rejected;

/// A task's plan, and who carries it out.
pub(super) struct Site<'s> {
    pub(super) plan: &'s Plan,
    pub(super) shop: &'s mut dyn Workshop,
}

/// Something that may follow.
#[derive(Debug)]
pub(super) struct Launch {
    pub(super) track: Track,
}

impl Launch {
    /// Nothing will come of it.
    pub(super) fn is_given_up(&self) -> bool {
        !self.track.is_open() && !self.track.has_started()
    }
}

/// What must have happened before something follows: the commands that it follows, and how they must have ended.
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
    /// Begins with a place that nothing comes before.
    ///
    /// # Errors
    /// What could not be started.
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

    /// Schedules all that may follow what a track is at; nothing as long as that cannot be said.
    ///
    /// # Errors
    /// What could not be loaded.
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

    /// The places to which a track may come, and what leads there; none as long as strands have more to do before they meet.
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

    /// What must happen for a track to be over: none if that takes more than its running commands.
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

    /// Goes on with a place that was not scheduled in time: by a rule as in time, so that it takes over the same, and knows whom
    /// it follows.
    ///
    /// # Errors
    /// What could not be loaded.
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
            // Strands were left by an error: what comes then could not be known before.
            None => Cause {
                after: ended.slots().into_iter().cloned().collect(),
                condition: Condition::always(),
            },
        };
        Ok(self.launch(place, cause)?.track)
    }

    /// Lets go of what was refused: it is still loaded.
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

    /// Loads what is at a place and makes the rule that starts it, with what it takes over.
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

    /// Loads the commands at a place: all or, if one cannot be loaded, none.
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

    /// The exports of commands from which one that follows takes inputs over: those of the same key and type, of the first that
    /// has them.
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

/// That a command has ended by one of these results; without named ones, regularly.
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
