//! A task under way: works ahead of its running commands, as a program outside of the core could.
//!
//! Everything that may follow the running commands is loaded and scheduled by rules on their results. What the core then starts
//! goes on; the others it gives up by itself. What was not scheduled in time is started when it is ready, and counted as late.
//!
//! | file | idea |
//! |---|---|
//! | `workshop.rs` | what a task asks of whoever runs it |
//! | `launch.rs` | commands that were loaded, and the request that is to start them |
//! | `track.rs` | what runs by itself: a command, or strands that run at once |
//! | `ahead.rs` | what may follow it, loaded and scheduled |
//!
//! A task is a tree of tracks. A track is at a command, or where strands run at once, each a track of its own.

mod ahead;
mod launch;
mod track;
mod workshop;

use std::borrow::Borrow;

use rpi_core::CommandId;

use super::plan::Plan;
use super::walk::Place;
use crate::control::Event;
use ahead::Site;
use launch::Trouble;
use track::{Step, Track};

pub use workshop::{NotStarted, Workshop};

/// How a task has ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TaskEnd {
    /// By its last command.
    Done,
    /// By an error that no branch is for, or as something could not be started.
    Failed,
    /// It was asked to.
    Cancelled,
}

/// A task under way, with its plan or a reference to it.
#[derive(Debug)]
pub struct Task<P> {
    plan: P,
    root: Option<Track>,
    cancelled: bool,
    failed: bool,
    end: Option<TaskEnd>,
}

impl<P: Borrow<Plan>> Task<P> {
    /// A task that has not begun.
    pub fn new(plan: P) -> Task<P> {
        Task {
            plan,
            root: None,
            cancelled: false,
            failed: false,
            end: None,
        }
    }

    /// How it has ended, if it has: it runs nothing any more then.
    pub fn end(&self) -> Option<TaskEnd> {
        self.end
    }

    /// The commands that run, or wait to be started at once.
    pub fn running(&self) -> Vec<CommandId> {
        let root = self.root.iter();
        let slots = root.flat_map(|track| track.slots());
        slots
            .filter(|slot| slot.ending.is_none())
            .map(|slot| slot.id)
            .collect()
    }

    /// Notes what concerns its commands.
    pub fn hear(&mut self, event: &Event) {
        self.root.iter_mut().for_each(|root| root.hear(event));
    }

    /// Asks it to end: nothing follows any more, and what runs is asked to end.
    pub fn cancel(&mut self, shop: &mut dyn Workshop) {
        self.cancelled = true;
        self.wind_up(shop);
    }

    /// Everything was stopped by force: nothing follows any more, and it has failed.
    pub fn stop(&mut self, shop: &mut dyn Workshop) {
        self.failed = true;
        self.wind_up(shop);
    }

    /// Does what can be done now.
    pub fn advance(&mut self, shop: &mut dyn Workshop) {
        if self.end.is_some() {
            return;
        }
        let mut site = Site {
            plan: self.plan.borrow(),
            shop: &mut *shop,
        };
        let step = match &mut self.root {
            Some(root) => root.step(&mut site),
            None => match site.plan.first() {
                Place::Run(_) | Place::Split { .. } => {
                    let begun = site.begin(site.plan.first());
                    begun.map(|track| {
                        self.root = Some(track);
                        Step::Going
                    })
                }
                _ => Ok(Step::Over),
            },
        };
        match step {
            Ok(Step::Going | Step::Leaving(_)) => {}
            Ok(Step::Over) => self.finish(shop),
            Ok(Step::Left(_)) => {
                self.failed = true;
                self.finish(shop);
            }
            Err(trouble) => self.fail(trouble, shop),
        }
    }

    /// Something does not run: whatever does is asked to end.
    fn fail(&mut self, trouble: Trouble, shop: &mut dyn Workshop) {
        shop.not_started(&trouble.indices, trouble.why);
        self.failed = true;
        self.wind_up(shop);
    }

    fn wind_up(&mut self, shop: &mut dyn Workshop) {
        match &mut self.root {
            Some(root) => root.wind_up(shop),
            None if self.end.is_none() => self.finish(shop),
            None => {}
        }
    }

    /// Nothing of it runs any more.
    fn finish(&mut self, shop: &mut dyn Workshop) {
        self.end = Some(match (self.cancelled, self.failed) {
            (true, _) => TaskEnd::Cancelled,
            (false, true) => TaskEnd::Failed,
            (false, false) => TaskEnd::Done,
        });
        if let Some(root) = &mut self.root {
            root.wind_up(shop);
            root.slots().iter().for_each(|slot| shop.unload(slot.id));
        }
    }
}
