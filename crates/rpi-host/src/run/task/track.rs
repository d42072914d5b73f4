//! What runs by itself: a command, or strands that run at once.

use std::collections::BTreeSet;

use rpi_core::{CommandId, Ending};
use rpi_image::Image;

use super::super::end;
use super::super::walk::{Cursor, Exit, Place};
use super::ahead::{Launch, Site};
use super::launch::{Request, Slot, Trouble};
use super::workshop::Workshop;
use crate::control::Event;

/// What a track is at.
#[derive(Debug)]
pub(super) enum Spot {
    /// A command.
    Command(Slot),
    /// Strands.
    Split {
        at: Cursor,
        strands: Vec<Track>,
        /// How they are left, if they are.
        leaving: Option<Exit>,
        /// The commands that were to meet when something was last scheduled on that.
        met: Vec<CommandId>,
    },
    /// Nothing: a strand without a command.
    Nothing,
}

/// Something that runs, and what may follow it.
#[derive(Debug)]
pub(super) struct Track {
    pub(super) spot: Spot,
    /// The request that is to start it; none where the strands around it were started as a whole.
    pub(super) request: Option<Request>,
    /// What may follow, once it is scheduled.
    pub(super) ahead: Option<Vec<Launch>>,
    /// It is asked to end: nothing follows.
    winding: bool,
    /// It has ended, and waits for those beside it.
    over: bool,
}

/// How far a track has come.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Step {
    /// It runs.
    Going,
    /// It has ended.
    Over,
    /// It has failed; parts of it still run.
    Leaving(Exit),
    /// It has failed, and nothing of it runs.
    Left(Exit),
}

impl Track {
    pub(super) fn new(spot: Spot, request: Option<Request>) -> Track {
        Track {
            over: matches!(spot, Spot::Nothing),
            spot,
            request,
            ahead: None,
            winding: false,
        }
    }

    /// Its commands: those that run or have run last.
    pub(super) fn slots(&self) -> Vec<&Slot> {
        match &self.spot {
            Spot::Command(slot) => vec![slot],
            Spot::Split { strands, .. } => strands.iter().flat_map(Track::slots).collect(),
            Spot::Nothing => Vec::new(),
        }
    }

    /// The indices of its commands in the plan's list, each once.
    pub(super) fn indices(&self) -> Vec<usize> {
        let indices = self.slots().into_iter().map(|slot| slot.index);
        let unique: BTreeSet<usize> = indices.collect();
        unique.into_iter().collect()
    }

    pub(super) fn hear(&mut self, event: &Event) {
        self.request.iter_mut().for_each(|r| r.hear(event));
        let ahead = self.ahead.iter_mut().flatten();
        ahead.for_each(|launch| launch.track.hear(event));
        match &mut self.spot {
            Spot::Command(slot) => slot.hear(event),
            Spot::Split { strands, .. } => strands.iter_mut().for_each(|s| s.hear(event)),
            Spot::Nothing => {}
        }
    }

    /// True once its commands were started.
    pub(super) fn has_started(&self) -> bool {
        self.slots().iter().any(|slot| slot.first_tick.is_some())
    }

    /// True while it may still be started by what was asked for.
    pub(super) fn is_open(&self) -> bool {
        let refused = self.request.as_ref().is_some_and(|r| r.refusal().is_some());
        !self.has_started() && !refused
    }

    /// Asks it to end: first what may follow is dropped, then what runs is asked to end. (M11.7)
    pub(super) fn wind_up(&mut self, shop: &mut dyn Workshop) {
        if std::mem::replace(&mut self.winding, true) {
            return;
        }
        for launch in self.ahead.iter().flatten() {
            let waiting = launch.track.slots().into_iter();
            waiting.for_each(|slot| shop.unload(slot.id));
        }
        match &mut self.spot {
            Spot::Command(slot) if slot.ending.is_some() => {}
            Spot::Command(slot) if slot.first_tick.is_some() => shop.cancel(slot.id),
            // Whatever starts it may be on its way: then it does not run yet, or not any more.
            Spot::Command(slot) => {
                shop.cancel(slot.id);
                shop.unload(slot.id);
            }
            Spot::Split { strands, .. } => strands.iter_mut().for_each(|s| s.wind_up(shop)),
            Spot::Nothing => {}
        }
    }

    /// Does what can be done now.
    ///
    /// # Errors
    /// What could not be started.
    pub(super) fn step(&mut self, site: &mut Site<'_>) -> Result<Step, Trouble> {
        if self.over {
            return Ok(Step::Over);
        }
        if let Some(why) = self.refusal() {
            return match self.winding {
                true => self.finish(),
                false => Err(why),
            };
        }
        let waits = self.waits();
        match &self.spot {
            Spot::Command(slot) => match slot.ending {
                None => self.work_ahead(site),
                // What follows is not ready yet.
                Some(_) if !site.shop.may_plan(slot.first_tick) && waits => Ok(Step::Going),
                Some(ending) => self.go_on_after(ending, site),
            },
            Spot::Split { .. } => self.step_strands(site),
            Spot::Nothing => self.finish(),
        }
    }

    /// Why it was not started, if it was not and will not be.
    fn refusal(&self) -> Option<Trouble> {
        let why = self.request.as_ref()?.refusal();
        let why = why.filter(|_| !self.has_started())?;
        let indices = self.indices();
        Some(Trouble { indices, why })
    }

    /// Whether something is still to be scheduled behind it.
    fn waits(&self) -> bool {
        self.ahead.is_none() && !self.winding
    }

    fn finish(&mut self) -> Result<Step, Trouble> {
        self.over = true;
        Ok(Step::Over)
    }

    /// Schedules what may follow, once that can be said.
    fn work_ahead(&mut self, site: &mut Site<'_>) -> Result<Step, Trouble> {
        self.forget_old(site);
        if self.ahead.is_none() && !self.winding {
            self.ahead = site.ahead_of(self)?;
        }
        Ok(Step::Going)
    }

    /// What was scheduled on the end of commands that have gone another way, and was given up, is thought of again.
    fn forget_old(&mut self, site: &mut Site<'_>) {
        let now: Vec<CommandId> = self.slots().iter().map(|slot| slot.id).collect();
        let Spot::Split { met, .. } = &mut self.spot else {
            return;
        };
        if *met == now {
            return;
        }
        let ahead = self.ahead.as_deref().unwrap_or_default();
        if ahead.iter().all(|launch| launch.is_given_up()) {
            site.forget_refused(ahead);
            self.ahead = None;
            *met = now;
        }
    }

    fn go_on_after(&mut self, ending: Ending, site: &mut Site<'_>) -> Result<Step, Trouble> {
        let Spot::Command(slot) = &self.spot else {
            return Ok(Step::Going);
        };
        let ahead = self.ahead.as_deref().unwrap_or_default();
        if ahead.iter().any(|launch| launch.track.is_open()) {
            return Ok(Step::Going);
        }
        let (id, image) = (slot.id, site.shop.image(slot.index));
        let has_next = ahead.iter().any(|launch| launch.track.has_started());
        let place = match self.winding || has_next {
            true => Place::Joined,
            false => after(slot, ending, &image, site),
        };
        let fails = place == Place::Error;
        if ending.error > 0 && !fails && !self.winding {
            site.shop.handled(id);
        }
        match place {
            Place::Error => {
                self.over = true;
                Ok(Step::Left(Exit::Error))
            }
            place => self.go_on_to(place, site),
        }
    }

    /// Lets the strands go on. If one fails, the others are asked to end.
    fn step_strands(&mut self, site: &mut Site<'_>) -> Result<Step, Trouble> {
        let winding = self.winding;
        let Spot::Split {
            at,
            strands,
            leaving,
            ..
        } = &mut self.spot
        else {
            return Ok(Step::Going);
        };
        let mut going = false;
        for strand in strands.iter_mut() {
            match strand.step(site)? {
                Step::Going => going = true,
                Step::Over => {}
                Step::Leaving(exit) => {
                    going = true;
                    leaving.get_or_insert(exit);
                }
                Step::Left(exit) => {
                    leaving.get_or_insert(exit);
                }
            }
        }
        let exit = leaving.filter(|_| !winding);
        if exit.is_some() {
            strands.iter_mut().for_each(|s| s.wind_up(site.shop));
        }
        let out = exit.and_then(|exit| site.plan.out_of(at, exit));
        let behind = site.plan.behind(at);
        match (going, exit, out) {
            // Only those around it have to know of an error that is theirs.
            (true, Some(exit), None) => Ok(Step::Leaving(exit)),
            (true, Some(_), Some(_)) => Ok(Step::Going),
            (true, None, _) => self.work_ahead(site),
            (false, _, Some(place)) => self.go_on_to(place, site),
            (false, Some(exit), None) => {
                self.over = true;
                Ok(Step::Left(exit))
            }
            (false, None, None) => match winding {
                true => self.go_on_to(Place::Joined, site),
                false => self.go_on_to(behind, site),
            },
        }
    }

    /// What it is at has ended: goes on with what the core has started, or with what should have been.
    fn go_on_to(&mut self, place: Place, site: &mut Site<'_>) -> Result<Step, Trouble> {
        let ahead = self.ahead.as_deref().unwrap_or_default();
        if ahead.iter().any(|launch| launch.track.is_open()) {
            return Ok(Step::Going);
        }
        site.forget_refused(ahead);
        let mut ahead = self.ahead.take().unwrap_or_default().into_iter();
        let next = match ahead.find(|launch| launch.track.has_started()) {
            Some(started) => started.track,
            None => match place {
                Place::Run(_) | Place::Split { .. } => site.catch_up(self, place)?,
                Place::Left(exit) => {
                    self.over = true;
                    return Ok(Step::Left(exit));
                }
                Place::Joined | Place::Done | Place::Error => return self.finish(),
            },
        };
        let ended = std::mem::replace(self, next);
        ended
            .slots()
            .iter()
            .for_each(|slot| site.shop.unload(slot.id));
        if ended.winding {
            self.wind_up(site.shop);
            return Ok(Step::Going);
        }
        self.work_ahead(site)
    }
}

/// What follows a command that has ended so.
fn after(slot: &Slot, ending: Ending, image: &Image, site: &Site<'_>) -> Place {
    if ending.cancelled {
        return Place::Error;
    }
    match end::result_of(image, ending) {
        Some(result) => {
            let named = Some((result.name.as_str(), result.kind));
            site.plan.after(&slot.cursor, named)
        }
        None if ending.is_regular() => site.plan.after(&slot.cursor, None),
        None => Place::Error,
    }
}
