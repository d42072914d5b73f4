//! Random requests to a control core, and checks of its events.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use rpi_image::Image;
use rpi_runtime::control::{
    AbortReason, Cause, CommandId, CommandState, Condition, Control, Ending, Event, Executive,
    Fact, Notice, Options, Rule, Ticket, open,
};
use rpi_sim::{FaultKind, ScheduledFault, SimBank};

use crate::cell::{ARMS, AXES, Arms, BOTH, Random, TICK_NS, cell, images};
use crate::limit_check::LimitChecker;

/// Index of the result `early` of every command.
const EARLY: u32 = 1;

/// Capacity of the command table.
const ROOM: usize = 32;

/// Expected state of a command.
struct CommandRecord {
    arms: Arms,
    /// Commands that it may follow.
    after: Vec<CommandId>,
    first: Option<u64>,
    /// Its last tick and its ending.
    last: Option<(u64, Ending)>,
    /// Whether a successor is scheduled.
    followed: bool,
    unloading: bool,
}

pub(crate) struct RandomDriver {
    control: Control,
    executive: Executive<SimBank>,
    watch: LimitChecker,
    images: Vec<(Arms, Arc<Image>)>,
    random: Random,
    known: BTreeMap<CommandId, CommandRecord>,
    /// Commands that pending requests will start.
    pending_starts: BTreeMap<Ticket, Vec<CommandId>>,
    /// Device faults are expected until this time (s).
    troubled: f64,
    tally: Tally,
}

#[derive(Default, Debug)]
struct Tally {
    ticks: u64,
    takeovers: u64,
    in_motion: u64,
    aborted: u64,
    cancelled: u64,
    faults: u64,
    braked: u64,
    given_up: u64,
}

impl RandomDriver {
    pub(crate) fn new(seed: u64) -> RandomDriver {
        let cell = cell();
        let bank = || SimBank::new(&cell, TICK_NS as f64 * 1e-9);
        let mut plant = bank();
        let watch = LimitChecker::new(&cell, &mut plant);
        let options = Options {
            commands: ROOM,
            ..Options::default()
        };
        let (control, executive) = open(plant, Box::new(bank()), options);
        let mut random = Random(seed);
        RandomDriver {
            control,
            executive,
            watch,
            images: images(&mut random),
            random,
            known: BTreeMap::new(),
            pending_starts: BTreeMap::new(),
            troubled: 0.0,
            tally: Tally::default(),
        }
    }

    pub(crate) fn run_until(&mut self, takeovers: u64) {
        while self.tally.takeovers < takeovers {
            self.act();
            self.tick();
        }
    }

    fn tick(&mut self) {
        rpi_testkit::no_alloc(|| self.executive.tick(0, &mut ()));
        self.watch.look(self.executive.plant(), self.tally.ticks);
        self.tally.ticks += 1;
        while let Some(event) = self.control.poll() {
            self.hear(&event);
        }
        self.check_devices();
    }

    /// A device must not have an error unless a fault was injected; after a fault it also refuses further set-points of
    /// its command.
    fn check_devices(&mut self) {
        let bank = self.executive.plant();
        let (now, until) = (bank.time(), self.troubled);
        let lost = bank.reports(|device, report| {
            assert!(now <= until + 1e-9, "{device} at {now}: {report:?}");
        });
        assert_eq!(lost, 0);
    }

    fn hear(&mut self, event: &Event) {
        match *event {
            Event::Notice(Notice::Started { command, tick }) => self.started(command, tick),
            Event::Notice(Notice::Ended {
                command,
                tick,
                ending,
            }) => self.ended(command, tick, ending),
            Event::Notice(Notice::Orphaned { command, .. }) => {
                self.tally.given_up += 1;
                self.known.remove(&command);
            }
            Event::Notice(Notice::Braked { .. }) => self.tally.braked += 1,
            Event::Notice(Notice::Discontinuity {
                command,
                discontinuity: jump,
            }) => {
                panic!("{command:?} jumps in tick {}: {jump:?}", self.tally.ticks)
            }
            Event::Answer {
                ticket, refused, ..
            } => self.answered(ticket, refused.is_some()),
            Event::Freed(command) => {
                self.known.remove(&command);
            }
            _ => {}
        }
    }

    /// The first cycle of a successor is in the tick after the last one of its predecessor.
    fn started(&mut self, command: CommandId, tick: u64) {
        let known = &self.known[&command];
        let before = known.after.iter().filter_map(|id| self.known.get(id)?.last);
        let last = before.map(|(last, _)| last).max();
        if let Some(last) = last {
            assert_eq!(tick, last + 1, "a gap before {command:?}");
            self.tally.takeovers += 1;
        }
        if let Some(known) = self.known.get_mut(&command) {
            known.first = Some(tick);
        }
    }

    fn ended(&mut self, command: CommandId, tick: u64, ending: Ending) {
        match ending.cause {
            Cause::Result(_) if ending.error == 0 => {
                let early = ending.cause == Cause::Result(EARLY as usize);
                self.tally.in_motion += u64::from(early);
            }
            Cause::Result(_) | Cause::Fault(_) => self.tally.faults += 1,
            _ => self.tally.aborted += 1,
        }
        self.tally.cancelled += u64::from(ending.cancelled);
        if let Some(known) = self.known.get_mut(&command) {
            known.last = Some((tick, ending));
        }
    }

    fn act(&mut self) {
        self.clear_away();
        self.take_idle_arms();
        self.plan_ahead();
        self.disturb();
    }

    /// Unloads ended commands. A result is kept until the successors have started.
    fn clear_away(&mut self) {
        let over: Vec<CommandId> = self
            .known
            .iter()
            .filter(|(_, k)| k.last.is_some() && !k.unloading)
            .map(|(id, _)| *id)
            .collect();
        for id in over {
            if self.control.unload(id).is_ok()
                && let Some(known) = self.known.get_mut(&id)
            {
                known.unloading = true;
            }
        }
    }

    /// Starts a command on arms that are at rest, without error and free.
    fn take_idle_arms(&mut self) {
        let taken = self.known.values().filter(|k| k.last.is_none());
        let taken = taken.fold(0, |all, k| all | k.arms);
        let bank = self.executive.plant();
        if bank.time() <= self.troubled {
            return;
        }
        let rests = |(k, s): (usize, rpi_sim::DeviceStatus<'_>)| {
            if s.moving { 0 } else { 1 << k }
        };
        let resting: Arms = bank.status().enumerate().map(rests).sum();
        let idle = resting & !taken;
        let wanted = match idle {
            0 => return,
            BOTH => 1 + self.random.below(3) as Arms,
            one => one,
        };
        if let Some(id) = self.load(wanted, &[]) {
            let ticket = self.control.start(id).expect("there is room for requests");
            self.pending_starts.insert(ticket, vec![id]);
        }
    }

    /// Schedules successors of commands that have none.
    fn plan_ahead(&mut self) {
        let open = |id: &CommandId| {
            let known = &self.known[id];
            known.first.is_some() && known.last.is_none() && !known.followed
        };
        let open: Vec<CommandId> = self.known.keys().copied().filter(open).collect();
        for id in open {
            if !self.random.once_in(20) {
                continue;
            }
            match (self.known[&id].arms, self.random.below(3)) {
                (BOTH, 0) => self.split(id),
                (arms, 1) => self.offer_two(id, arms),
                (arms, _) => self.follow(id, arms),
            }
            if let Some(known) = self.known.get_mut(&id) {
                known.followed = true;
            }
        }
    }

    fn follow(&mut self, id: CommandId, arms: Arms) {
        if let Some(next) = self.load(arms, &[id]) {
            self.schedule(Rule::follow(id).start(next));
        }
    }

    /// Schedules one successor for the early end and another one for the regular end.
    fn offer_two(&mut self, id: CommandId, arms: Arms) {
        let early =
            Condition::from_fact(id, Fact::Result(EARLY)) & Condition::from_fact(id, Fact::Regular);
        let other =
            Condition::from_fact(id, Fact::Result(0)) & Condition::from_fact(id, Fact::Regular);
        for when in [early, other] {
            if let Some(next) = self.load(arms, &[id]) {
                self.schedule(Rule::when(when).start(next));
            }
        }
    }

    /// Schedules one command per arm as successors of a command for both.
    fn split(&mut self, id: CommandId) {
        if let (Some(left), Some(right)) = (self.load(1, &[id]), self.load(2, &[id])) {
            self.schedule(Rule::follow(id).start(left).start(right));
        }
    }

    fn schedule(&mut self, rule: Rule) {
        let starts = rule.starts().to_vec();
        let scheduled = self.control.schedule(rule);
        self.pending_starts
            .insert(scheduled.expect("there is room for rules").1, starts);
    }

    /// A refused command will never run, for example the successor of a command that was cancelled meanwhile.
    fn answered(&mut self, ticket: Ticket, refused: bool) {
        let starts = self.pending_starts.remove(&ticket).unwrap_or_default();
        for id in starts.into_iter().filter(|_| refused) {
            self.control.unload(id).expect("it is ready");
            self.known.remove(&id);
        }
    }

    fn load(&mut self, arms: Arms, after: &[CommandId]) -> Option<CommandId> {
        let fitting: Vec<&Arc<Image>> = self
            .images
            .iter()
            .filter(|i| i.0 == arms)
            .map(|i| &i.1)
            .collect();
        let image = Arc::clone(fitting[self.random.below(fitting.len())]);
        let id = self.control.load(image).ok()?;
        let known = CommandRecord {
            arms,
            after: after.to_vec(),
            first: None,
            last: None,
            followed: false,
            unloading: false,
        };
        self.known.insert(id, known);
        Some(id)
    }

    fn disturb(&mut self) {
        let running: Vec<CommandId> = self
            .known
            .iter()
            .filter(|(_, k)| k.first.is_some() && k.last.is_none())
            .map(|(id, _)| *id)
            .collect();
        if running.is_empty() {
            return;
        }
        let one = running[self.random.below(running.len())];
        // A refusal because the command has ended meanwhile is ignored.
        if self.random.once_in(2_000) {
            let _ = self.control.cancel(one);
        }
        if self.random.once_in(2_000) {
            let _ = self.control.abort(one, AbortReason::Request);
        }
        if self.random.once_in(10_000) {
            let _ = self.control.emergency_stop();
        }
        if self.random.once_in(5_000) {
            self.inject_fault();
        }
    }

    fn inject_fault(&mut self) {
        let kind = match self.random.below(2) {
            0 => FaultKind::JointFailure(self.random.below(AXES)),
            _ => FaultKind::EmergencyStop,
        };
        let arm = ARMS[self.random.below(ARMS.len())];
        let bank = self.executive.plant();
        let from = bank.time();
        let until = from + 0.05;
        self.troubled = until;
        let fault = ScheduledFault { from, until, kind };
        assert!(bank.inject(arm, fault));
    }

    /// Ends everything and checks that nothing is held, moves or remains.
    pub(crate) fn come_to_rest(&mut self) {
        self.control
            .emergency_stop()
            .expect("there is room for requests");
        for _ in 0..2_000 {
            self.clear_away();
            self.tick();
        }
        assert!(
            self.control
                .commands()
                .all(|(_, info)| info.state == CommandState::Ready)
        );
        assert_eq!(self.executive.core().rules().count(), 0);
        let held = self.executive.core().commands().flat_map(|(_, c)| c.held());
        assert_eq!(held.count(), 0, "a resource is still held");
        assert!(self.executive.plant().status().all(|s| !s.moving));
        assert_eq!(self.executive.core().notices_lost(), 0);
    }

    pub(crate) fn is_eventful(&self) {
        let t = &self.tally;
        let enough = [
            t.in_motion,
            t.aborted,
            t.cancelled,
            t.faults,
            t.braked,
            t.given_up,
        ];
        assert!(enough.iter().all(|n| *n * 1000 > t.takeovers), "{t:?}");
    }
}

impl fmt::Display for RandomDriver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let t = &self.tally;
        write!(
            f,
            "{} takeovers ({} ends in motion) in {} ticks: {} aborted, {} cancelled, {} faults, {} braked, {} dropped",
            t.takeovers,
            t.in_motion,
            t.ticks,
            t.aborted,
            t.cancelled,
            t.faults,
            t.braked,
            t.given_up
        )
    }
}
