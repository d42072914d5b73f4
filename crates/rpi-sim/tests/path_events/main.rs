//! Events on the paths of motions: each fires in the cycle in which its place is passed, at the time of the passage, or is
//! reported. Random motions with overrides and pauses; `RPI_EVENT_MOTIONS` sets their number, `RPI_SEED` the first seed.

mod rig;

use rig::{Answer, Order, Place, Random, Rig};
use rpi_sim::error_code::ErrorCode;

const TICK: f64 = 1e-3;
const AXES: usize = 6;
const HOME: [f64; AXES] = [0.0, -1.57, 1.57, 0.0, 1.57, 0.0];
const SLOTS: usize = AXES + 14;
/// Number of events on each random motion.
const EVENTS: usize = 20;

/// State of a motion after one cycle: distance travelled and speed.
#[derive(Clone, Copy)]
struct Progress {
    travelled: f64,
    speed: f64,
}

/// Returns the time (s) from the passage of `place` between two set-points to the later one, by cubic Hermite
/// interpolation: independent of the time law.
fn time_since(place: f64, before: Progress, after: Progress) -> f64 {
    let at = |share: f64| {
        let (way, v0, v1) = (
            after.travelled - before.travelled,
            before.speed * TICK,
            after.speed * TICK,
        );
        let (b, c) = (3.0 * way - 2.0 * v0 - v1, v0 + v1 - 2.0 * way);
        before.travelled + share * (v0 + share * (b + share * c))
    };
    let (mut early, mut late) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = f64::midpoint(early, late);
        match at(middle) < place {
            true => early = middle,
            false => late = middle,
        }
    }
    (1.0 - late) * TICK
}

/// A random motion from where the arm is.
fn random_order(rig: &mut Rig, random: &mut Random) -> Order {
    match random.between(0.0, 4.0) as u32 {
        0 => {
            let to = rig.moved(random.vector(0.15));
            rig.order("move_line", to, [random.between(0.02, 0.5), 1.0, 10.0])
        }
        1 => {
            let points = [0.06, 0.1, 0.15].map(|most| rig.moved(random.vector(most)));
            rig.order("move_spline", points.concat(), [0.25, 0.5, 5.0])
        }
        2 => {
            let to = HOME.map(|home| home + random.between(-0.4, 0.4)).to_vec();
            rig.order("move_joints", to, [random.between(0.1, 1.0), 1.6, 16.0])
        }
        _ => {
            // One axis moves farthest throughout, so that the reported speed is the derivative of the distance travelled.
            let mut to: Vec<f64> = rig.last.to_vec();
            to.iter_mut()
                .for_each(|to| *to += random.between(-0.01, 0.01));
            to[0] = random.between(-0.4, 0.4);
            rig.order("move_axes", to, [random.between(0.1, 1.0), 1.6, 16.0])
        }
    }
}

fn from_environment(name: &str, default: u64) -> u64 {
    let text = std::env::var(name).ok();
    text.map_or(default, |text| text.parse().expect("a number"))
}

/// Checks one cycle of an event: whether it fires, and at which time. `before` is `None` in the first cycle.
fn check(place: f64, answer: Answer, fired: bool, before: Option<Progress>, now: Progress) {
    assert_eq!(answer.error, ErrorCode::OK);
    let is_due = place <= now.travelled + 1e-9;
    assert_eq!(answer.passed, is_due, "{place} at {}", now.travelled);
    if !answer.passed || fired {
        return;
    }
    assert!((0.0..=TICK).contains(&answer.time), "{answer:?}");
    let Some(before) = before else {
        return;
    };
    let slowest = before.speed.min(now.speed);
    let way = now.travelled - before.travelled;
    let mean = f64::midpoint(before.speed, now.speed) * TICK;
    // Where another axis becomes the farthest one, the speed is not the derivative of the distance travelled.
    let is_smooth = (way - mean).abs() < 1e-3 * way;
    if slowest > 5e-3 && is_smooth {
        let expected = time_since(place, before, now);
        let error = (answer.time - expected).abs();
        assert!(
            error < 1e-6,
            "{place}: {} {expected}, travelled {} to {}, speed {} to {}",
            answer.time,
            before.travelled,
            now.travelled,
            before.speed,
            now.speed
        );
    }
}

/// Runs a random motion with changing overrides and pauses, and checks its events in each cycle. Returns the largest speed;
/// `None` if the arm refuses the motion.
fn run_with_events(rig: &mut Rig, random: &mut Random) -> Option<f64> {
    let order = random_order(rig, random);
    let shares: Vec<f64> = (0..EVENTS).map(|_| random.between(0.0, 1.0)).collect();
    let mut fired = [false; EVENTS];
    let (mut number, mut before, mut fastest) = (0, None, 0.0_f64);
    let (mut override_share, mut pause_left) = (1.0, 0);
    for _ in 0..60_000 {
        if random.between(0.0, 1.0) < 5e-3 {
            override_share = random.between(0.2, 1.0);
        }
        if random.between(0.0, 1.0) < 1e-3 {
            pause_left = 300;
        }
        pause_left = (pause_left - 1).max(0);
        let motion = rig.call(&order, number, override_share, pause_left > 0);
        number = motion.number;
        // An axis that stops for a pause may pass its goal, and then moves back: what is passed remains passed.
        let farthest = before.map_or(0.0, |before: Progress| before.travelled);
        let now = Progress {
            travelled: motion.travelled.max(farthest),
            speed: motion.speed,
        };
        fastest = fastest.max(motion.speed);
        if !rig.reports().is_empty() {
            return None;
        }
        for (share, fired) in shares.iter().zip(&mut fired) {
            let place = Place {
                share: *share,
                ..Place::at(0.0)
            };
            let answer = rig.event(number, place, !*fired);
            let way = way_of(rig, number);
            check(share * way, answer, *fired, before, now);
            *fired |= answer.passed;
        }
        rig.follow(&motion);
        before = Some(now);
        if motion.done {
            assert!(fired.iter().all(|fired| *fired), "{shares:?} {fired:?}");
            return Some(fastest);
        }
    }
    panic!("the motion does not end");
}

#[test]
fn random_events_fire_once_at_their_places() {
    let motions = from_environment("RPI_EVENT_MOTIONS", 40);
    let seed = from_environment("RPI_SEED", 7);
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut rig = Rig::new();
    let runs = (0..motions).map(|_| run_with_events(&mut rig, &mut random));
    let speeds: Vec<f64> = runs.flatten().collect();
    let share = speeds.len() as f64 / motions as f64;
    assert!(share > 0.8, "only {share} of the motions are possible");
    assert!(speeds.into_iter().fold(0.0, f64::max) > 0.1);
}

/// Returns the length of the way of a motion: the place of an event beyond it is refused with the length as limit.
fn way_of(rig: &mut Rig, number: u64) -> f64 {
    let beyond = Place {
        origin: 1,
        ..Place::at(1.0)
    };
    assert_eq!(
        rig.event(number, beyond, true).error,
        ErrorCode::NO_SUCH_PLACE
    );
    let reports = rig.reports();
    let limit = reports
        .iter()
        .find(|report| report.code == ErrorCode::NO_SUCH_PLACE);
    limit.expect("the place is reported").limit
}

/// Runs a line of 0.2 m and returns, for each place, the cycle in which it has been passed, and the cycle of the last set-point,
/// after which the motion is done.
fn passed_cycles(rig: &mut Rig, places: &[Place]) -> (Vec<usize>, usize) {
    let to = rig.moved([0.0, 0.2, 0.0]);
    let order = rig.order("move_line", to, [0.25, 0.5, 5.0]);
    let (mut number, mut cycles) = (0, 0);
    let mut first = vec![usize::MAX; places.len()];
    loop {
        let motion = rig.call(&order, number, 1.0, false);
        number = motion.number;
        for (place, first) in places.iter().zip(&mut first) {
            let answer = rig.event(number, *place, *first == usize::MAX);
            if answer.passed && *first == usize::MAX {
                *first = cycles;
            }
        }
        if motion.done {
            return (first, cycles - 1);
        }
        rig.follow(&motion);
        cycles += 1;
    }
}

#[test]
fn the_ends_of_a_path_are_passed_in_its_first_and_last_cycle() {
    let mut rig = Rig::new();
    let end = Place {
        origin: 1,
        ..Place::at(0.0)
    };
    let whole = Place {
        share: 1.0,
        ..Place::at(0.0)
    };
    let places = [Place::at(0.0), end, whole, Place::at(0.2)];
    let (first, last) = passed_cycles(&mut rig, &places);
    assert_eq!(first, [0, last, last, last]);
    assert!(rig.reports().is_empty());
}

#[test]
fn a_place_off_the_path_is_an_error_that_is_reported_once() {
    let mut rig = Rig::new();
    let to = rig.moved([0.0, 0.2, 0.0]);
    let order = rig.order("move_line", to, [0.25, 0.5, 5.0]);
    let motion = rig.call(&order, 0, 1.0, false);
    let corner = Place {
        origin: 3,
        ..Place::at(0.0)
    };
    for place in [
        Place::at(0.21),
        Place::at(-0.01),
        Place::at(f64::NAN),
        corner,
    ] {
        let answer = rig.event(motion.number, place, true);
        assert_eq!(answer.error, ErrorCode::NO_SUCH_PLACE);
        assert!(!answer.passed);
        // A program that knows the error no longer waits.
        rig.event(motion.number, place, false);
        assert_eq!(rig.reports().len(), 1);
    }
}

#[test]
fn an_event_of_no_motion_of_the_arm_is_reported_and_one_of_an_earlier_motion_is_not() {
    let mut rig = Rig::new();
    let to = rig.moved([0.0, 0.2, 0.0]);
    let order = rig.order("move_line", to, [0.25, 0.5, 5.0]);
    let earlier = rig.call(&order, 0, 1.0, false);
    let present = rig.call(&order, 0, 1.0, false);
    // The motion number of another arm, one that no motion has had yet, and none.
    let foreign = [earlier.number + 1, present.number + 256, 0];
    for (number, reports) in foreign
        .map(|number| (number, 1))
        .into_iter()
        .chain([(earlier.number, 0)])
    {
        let answer = rig.event(number, Place::at(0.1), true);
        assert_eq!(
            (answer.error, answer.passed),
            (ErrorCode::SUPERSEDED, false)
        );
        let reported = rig.reports();
        assert_eq!(reported.len(), reports, "{number}: {reported:?}");
        assert!(
            reported
                .iter()
                .all(|report| report.code == ErrorCode::SUPERSEDED)
        );
    }
}

#[test]
fn a_place_off_the_path_is_reported_from_the_start_of_the_path() {
    let mut rig = Rig::new();
    let to = rig.moved([0.0, 0.2, 0.0]);
    let order = rig.order("move_line", to, [0.25, 0.5, 5.0]);
    let motion = rig.call(&order, 0, 1.0, false);
    let beyond_end = Place {
        origin: 1,
        ..Place::at(0.03)
    };
    let no_point = Place {
        origin: 2,
        point: 7,
        ..Place::at(0.02)
    };
    let mut value = |place| {
        rig.event(motion.number, place, true);
        rig.reports()[0].value
    };
    assert!((value(beyond_end) - 0.23).abs() < 1e-9);
    assert!((value(Place::at(-0.01)) + 0.01).abs() < 1e-12);
    assert!(value(no_point).is_nan(), "a line has no points");
}

#[test]
fn an_event_behind_a_takeover_or_an_end_is_reported_as_missed() {
    let mut rig = Rig::new();
    for takes_over in [true, false] {
        let to = rig.moved([0.0, 0.1, 0.0]);
        let order = rig.order("move_line", to, [0.25, 0.5, 5.0]);
        let mut number = 0;
        for _ in 0..200 {
            let motion = rig.call(&order, number, 1.0, false);
            number = motion.number;
            rig.event(number, Place::at(0.09), true);
            rig.follow(&motion);
        }
        assert!(rig.reports().is_empty());
        if takes_over {
            rig.call(&order, 0, 1.0, false);
        } else {
            (0..10).for_each(|_| rig.bank.step());
        }
        let reports = rig.reports();
        let missed = reports
            .iter()
            .filter(|report| report.code == ErrorCode::EVENT_MISSED);
        let [missed] = missed.collect::<Vec<_>>()[..] else {
            panic!("one event was missed: {reports:?}");
        };
        assert!(
            (missed.value - 0.09).abs() < 1e-12 && missed.limit < 0.09,
            "{missed:?}"
        );
        (0..2000).for_each(|_| rig.bank.step());
        rig.reports();
    }
}

/// Before the passage, the time until it is known as planned: exactly on lines that no axis slows down.
#[test]
fn the_time_until_a_passage_is_that_of_the_plan() {
    let mut rig = Rig::new();
    let to = rig.moved([0.0, 0.3, 0.0]);
    for (name, target) in [
        ("move_line", to),
        ("move_axes", HOME.map(|home| home + 0.3).to_vec()),
    ] {
        let order = rig.order(name, target, [0.25, 0.5, 5.0]);
        let (mut number, mut predicted) = (0, Vec::new());
        let passage = loop {
            let motion = rig.call(&order, number, 1.0, false);
            number = motion.number;
            let answer = rig.event(number, Place::at(0.25), true);
            let now = predicted.len() as f64 * TICK;
            if answer.passed {
                break now - answer.time;
            }
            predicted.push(now - answer.time);
            rig.follow(&motion);
        };
        let known = predicted.iter().position(|time| time.is_finite());
        assert!(known.is_some_and(|known| known < 40), "{known:?}");
        let late = &predicted[predicted.len() - 100..];
        let worst = late
            .iter()
            .map(|time| (time - passage).abs())
            .fold(0.0, f64::max);
        assert!(worst < 1e-4, "{name}: {worst}");
        // Ends the motion.
        (0..3000).for_each(|_| rig.bank.step());
        rig.reports();
    }
}
