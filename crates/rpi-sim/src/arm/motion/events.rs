//! Events on the path of the present motion: the device function `path_event`.
//!
//! A program calls it after the motion function, in each cycle. A place counts as passed once the set-point of a cycle is
//! there or beyond; the time of the passage within the cycle follows from the time law of the motion. Places are
//! distances from the start of the path, in the unit of the distance travelled.

use super::super::Arm;
use super::super::limits::Violation;
use super::{Motion, NUMBER_STEP, PRESENT_PERIODS};
use crate::device::{SlotWriter, real_at};
use crate::error_code::ErrorCode;
use rpi_motion::path::Landmark;
use rpi_motion::time_of_passage;

/// Number of slots in the result of `path_event`: whether the place has been passed, time since then, error code.
pub(in crate::arm) const EVENT_SLOTS: u32 = 3;

/// Maximum number of pending events of a motion whose miss can be reported.
const CAPACITY: usize = 32;

/// Distance (m, or rad) by which a place may lie beyond an end of the path because of rounding.
const ROUNDING: f64 = 1e-9;

/// Distance (m, or rad) from the end of the path at which the motion is there. In the last cycles the set-points come nearer by
/// less than [`ROUNDING`]: an event at the end belongs to the last one.
const END_ROUNDING: f64 = 1e-12;

/// Progress of the present motion in its last period, and the events that a program waits for.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathEvents {
    /// Farthest place of the motion before the last set-point and up to it; minus infinity before the first one.
    before: f64,
    now: f64,
    /// Places of the events that were pending at the last set-point: the first `count` ones.
    pending: [f64; CAPACITY],
    count: usize,
}

impl Default for PathEvents {
    fn default() -> Self {
        Self {
            before: f64::NEG_INFINITY,
            now: f64::NEG_INFINITY,
            pending: [0.0; CAPACITY],
            count: 0,
        }
    }
}

impl PathEvents {
    /// Records a new set-point at the share `progress` (0 to 1) of a path of the length `way`. Events that are still
    /// pending must be named again in this cycle.
    pub(super) fn advance(&mut self, way: f64, progress: f64) {
        let place = match way - progress * way {
            left if left < END_ROUNDING => way,
            _ => progress * way,
        };
        self.before = self.now;
        self.now = self.now.max(place);
        self.count = 0;
    }

    fn await_at(&mut self, place: f64) {
        if let Some(slot) = self.pending.get_mut(self.count) {
            *slot = place;
            self.count += 1;
        }
    }

    /// Returns the pending events and forgets them.
    fn take_pending(&mut self) -> ([f64; CAPACITY], usize) {
        (self.pending, core::mem::take(&mut self.count))
    }
}

/// Arguments of a call of `path_event`.
struct EventRequest {
    motion: i64,
    landmark: Option<Landmark>,
    offset: f64,
    share: f64,
    is_pending: bool,
}

impl EventRequest {
    /// Reads the arguments, which are in order: number of the motion, origin, index of the point, offset, share, whether the
    /// event is pending. `None` if there are too few slots.
    fn from_slots(slots: &[u64]) -> Option<Self> {
        let [motion, origin, point, _, _, pending] = slots.first_chunk()?;
        let point = usize::try_from(point.cast_signed()).ok();
        let landmark = match origin {
            0 => Some(Landmark::Start),
            1 => Some(Landmark::End),
            2 => point.map(Landmark::Point),
            3 => point.map(Landmark::ZoneEntry),
            4 => point.map(Landmark::ZoneExit),
            _ => None,
        };
        Some(Self {
            motion: motion.cast_signed(),
            landmark,
            offset: real_at(slots, 3),
            share: real_at(slots, 4),
            is_pending: *pending != 0,
        })
    }
}

impl Motion {
    /// Returns true if the present motion or an earlier one of this arm has this number.
    fn has_numbered(&self, number: i64) -> bool {
        (1..=self.number).contains(&number) && number % NUMBER_STEP == self.device
    }

    /// Returns the distance (m, or rad) of the origin of an event from the start of the path; `None` if the path has no such
    /// place.
    fn event_origin(&self, request: &EventRequest) -> Option<f64> {
        match (request.landmark?, self.axes.is_present()) {
            (Landmark::Start, _) => Some(0.0),
            (Landmark::End, _) => Some(self.way),
            (_, true) => None,
            (landmark, false) => {
                Some(self.core.path().landmark(landmark)? / self.parameter_per_way())
            }
        }
    }

    /// Returns the place of an event, from the start of the path.
    ///
    /// # Errors
    /// The place that was requested if it is not on the path; NaN if the path does not have its origin.
    fn event_place(&self, request: &EventRequest) -> Result<f64, f64> {
        let origin = self.event_origin(request).unwrap_or(f64::NAN);
        let place = origin + request.offset + request.share * self.way;
        match place >= -ROUNDING && place <= self.way + ROUNDING {
            true => Ok(place.clamp(0.0, self.way)),
            false => Err(place),
        }
    }

    /// Returns the ratio of the path parameter to the distance travelled; 1 for a path without length.
    fn parameter_per_way(&self) -> f64 {
        match self.axes.is_present() || self.way <= 0.0 {
            true => 1.0,
            false => self.core.path().length() / self.way,
        }
    }

    /// Returns the time (s) from the passage of `place` in the last period to the last set-point.
    fn time_since_passage(&self, place: f64) -> f64 {
        let parameter = place * self.parameter_per_way();
        let at = |elapsed: f64| match self.axes.is_present() {
            true => self.axes.braking_set_point(&self.arm, elapsed).path.s,
            false => self.core.path_position(elapsed),
        };
        -time_of_passage(at, (-self.period, 0.0), parameter)
    }

    /// Returns the time (s) from the last set-point until the motion passes `place`, as planned now; infinity if it is
    /// unknown.
    fn time_until_passage(&self, place: f64) -> f64 {
        let until = match self.axes.is_present() {
            true => self.axes.time_until(&self.arm, place),
            false => self.core.time_until(place * self.parameter_per_way()),
        };
        until.unwrap_or(f64::INFINITY)
    }
}

/// Calls the function `path_event` and writes its result to `out`. Returns false if there are too few arguments.
pub(in crate::arm) fn call_path_event(
    arm: &mut Arm,
    arguments: &[u64],
    out: &mut SlotWriter<'_>,
) -> bool {
    let Some(request) = EventRequest::from_slots(arguments) else {
        return false;
    };
    let (passed, time, error) = path_event(arm, &request);
    out.put_bits(u64::from(passed));
    out.put_real(time);
    out.put_bits(error.0.cast_unsigned());
    true
}

fn path_event(arm: &mut Arm, request: &EventRequest) -> (bool, f64, ErrorCode) {
    let motion = &mut arm.motion;
    // The motion must have computed its set-point in this cycle.
    if request.motion != motion.number || motion.computed != arm.time {
        // An earlier motion of this arm has reported its events when it ended.
        if request.is_pending && !motion.has_numbered(request.motion) {
            arm.report(None, Violation::from_code(ErrorCode::SUPERSEDED));
        }
        return (false, f64::NEG_INFINITY, ErrorCode::SUPERSEDED);
    }
    let place = match motion.event_place(request) {
        Ok(place) => place,
        Err(value) => {
            let (code, limit) = (ErrorCode::NO_SUCH_PLACE, motion.way);
            if request.is_pending {
                arm.report(None, Violation { code, value, limit });
            }
            return (false, f64::NEG_INFINITY, code);
        }
    };
    if request.is_pending {
        motion.events.await_at(place);
    }
    let PathEvents { before, now, .. } = motion.events;
    let time = match (place <= before, place <= now) {
        (true, _) => 0.0,
        (false, true) => motion.time_since_passage(place),
        (false, false) => -motion.time_until_passage(place),
    };
    (place <= now, time, ErrorCode::OK)
}

/// Reports the pending events of the present motion as missed, because it or the run ends, or another motion takes over. The value
/// of a report is the place of the event, its limit the place that the motion has reached.
pub(in crate::arm) fn report_missed_events(arm: &mut Arm) {
    let (pending, count) = arm.motion.events.take_pending();
    let limit = arm.motion.events.now;
    let code = ErrorCode::EVENT_MISSED;
    for value in pending.into_iter().take(count) {
        arm.report(None, Violation { code, value, limit });
    }
    arm.motion.events = PathEvents::default();
}

/// Reports the pending events of a motion that no command continues any more.
pub(in crate::arm) fn report_events_of_ended_motion(arm: &mut Arm) {
    let motion = &arm.motion;
    let is_left = arm.time - motion.computed > PRESENT_PERIODS * motion.period;
    if is_left && motion.events.count > 0 {
        report_missed_events(arm);
    }
}
