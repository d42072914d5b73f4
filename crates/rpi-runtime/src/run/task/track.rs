//! A running part of a task: a command, or parallel branches.

use std::collections::BTreeSet;

use rpi_core::{CommandId, Ending};
use rpi_image::Image;

use super::super::end;
use super::super::walk::{Cursor, Exit, Place};
use super::ahead::{Launch, Site};
use super::launch::{Request, Slot, Trouble};
use super::workshop::Workshop;
use crate::control::Event;

/// Position of a track in the plan.
#[derive(Debug)]
pub(super) enum Spot {
    /// A single command.
    Command(Slot),
    /// Parallel branches.
    Split {
        at: Cursor,
        strands: Vec<Track>,
        /// Exit through which the branches are left after an error, if any.
        leaving: Option<Exit>,
        /// Commands at the ends of the branches when their common successor was last scheduled.
        met: Vec<CommandId>,
    },
    /// No command: an empty branch.
    Nothing,
}

/// A running part of a task with its scheduled successors.
#[derive(Debug)]
pub(super) struct Track {
    pub(super) spot: Spot,
    /// Request that starts the track; `None` for a branch, which is started together with its siblings.
    pub(super) request: Option<Request>,
    /// Scheduled successors; `None` until they are scheduled.
    pub(super) ahead: Option<Vec<Launch>>,
    /// True once the track was requested to end. It then has no successor.
    winding: bool,
    /// True if the track has ended and waits for its siblings.
    over: bool,
}

/// Progress of a track.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Step {
    /// The track runs.
    Going,
    /// The track has ended.
    Over,
    /// The track has failed, but parts of it still run.
    Leaving(Exit),
    /// The track has failed, and no part of it runs.
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

    /// Returns the current or last commands of the track.
    pub(super) fn slots(&self) -> Vec<&Slot> {
        match &self.spot {
            Spot::Command(slot) => vec![slot],
            Spot::Split { strands, .. } => strands.iter().flat_map(Track::slots).collect(),
            Spot::Nothing => Vec::new(),
        }
    }

    /// Returns the indices of the track's commands in the list of the plan, without duplicates.
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

    /// Returns true once a command of the track was started.
    pub(super) fn has_started(&self) -> bool {
        self.slots().iter().any(|slot| slot.first_tick.is_some())
    }

    /// Returns true while the pending request may still start the track.
    pub(super) fn is_open(&self) -> bool {
        let refused = self.request.as_ref().is_some_and(|r| r.refusal().is_some());
        !self.has_started() && !refused
    }

    /// Requests the track to end: unloads its successors, then cancels its running commands. (M11.7)
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
            // The start may be pending: the command is cancelled if it runs by then and unloaded otherwise. One of the
            // two requests is refused.
            Spot::Command(slot) => {
                shop.cancel(slot.id);
                shop.unload(slot.id);
            }
            Spot::Split { strands, .. } => strands.iter_mut().for_each(|s| s.wind_up(shop)),
            Spot::Nothing => {}
        }
    }

    /// Performs all actions that are possible now.
    ///
    /// # Errors
    /// Returns the commands that could not be started, with the reason.
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
                // The successors are not loaded yet, as long as the simulated planning time has not passed.
                Some(_) if !site.shop.may_plan(slot.first_tick) && waits => Ok(Step::Going),
                Some(ending) => self.go_on_after(ending, site),
            },
            Spot::Split { .. } => self.step_strands(site),
            Spot::Nothing => self.finish(),
        }
    }

    /// Returns the reason for which the track was not started and will not be.
    fn refusal(&self) -> Option<Trouble> {
        let why = self.request.as_ref()?.refusal();
        let why = why.filter(|_| !self.has_started())?;
        let indices = self.indices();
        Some(Trouble { indices, why })
    }

    /// Returns true if the successors are not scheduled yet but must be.
    fn waits(&self) -> bool {
        self.ahead.is_none() && !self.winding
    }

    fn finish(&mut self) -> Result<Step, Trouble> {
        self.over = true;
        Ok(Step::Over)
    }

    /// Schedules the possible successors once they are known.
    fn work_ahead(&mut self, site: &mut Site<'_>) -> Result<Step, Trouble> {
        self.forget_old(site);
        if self.ahead.is_none() && !self.winding {
            self.ahead = site.ahead_of(self)?;
        }
        Ok(Step::Going)
    }

    /// Discards successors that were scheduled on commands which meanwhile ended differently, so that they are
    /// scheduled again.
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

    /// Advances the parallel branches. If one of them fails, the others are requested to end.
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
            // An error that leaves this node as well is passed on to the enclosing track.
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

    /// Continues after the end of the current command or branches: with the successor that the core started, or by
    /// starting the next place now.
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

/// Returns the place that follows a command with this ending.
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
