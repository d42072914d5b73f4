//! Chunks of joint positions that arrive late by random delays: every limit of every axis holds in every cycle, the arm follows
//! the policy closely, brakes on its path when a chunk is late, and goes on when it comes.
//!
//! `RPI_CHUNK_SESSIONS` sets the number of sessions, `RPI_SEED` the first seed (defaults: a smoke for CI).

mod policy;
mod session;
mod single;
#[path = "../takeovers/watch.rs"]
mod watch;
#[path = "../support/xorshift.rs"]
mod xorshift;

use rpi_kin::{ArmModel, models};
use session::{Kind, Outcome, Session};
use xorshift::Random;

rpi_testkit::trap_allocations!();

const ARMS: [&ArmModel; 3] = [
    &models::kuka_lbr::LWR_4_PLUS,
    &models::universal_robots::UR5E,
    &models::franka::PANDA,
];

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().expect("a number"))
}

/// A policy that asks for at most half of each limit, with delays under half of its horizon.
fn tracked(random: &mut Random) -> Kind {
    let period = random.between(0.01, 0.1);
    let horizon = random.between(1.0, 3.0);
    let rows = ((horizon / period) as usize + 1).clamp(11, 200);
    let longest = (0.5 * period * (rows - 1) as f64).min(0.8);
    Kind {
        chunks: 20,
        ask: random.between(0.2, 0.5),
        period,
        rows,
        delay: (0.02, longest),
        noise: 1e-3 * random.unit() * random.unit(),
        offset: 5e-3 * random.unit(),
        with_velocities: random.unit() < 0.3,
        is_wild: false,
    }
}

fn wild(random: &mut Random) -> Kind {
    let period = random.between(0.01, 0.1);
    Kind {
        chunks: 20,
        ask: random.between(0.2, 3.0),
        period,
        rows: 5 + (196.0 * random.unit() * random.unit()) as usize,
        delay: (0.02, 0.8),
        noise: 0.02 * random.unit() * random.unit(),
        offset: 0.05 * random.unit(),
        with_velocities: false,
        is_wild: true,
    }
}

fn check(outcome: &Outcome, model: &ArmModel, kind: &Kind, seed: u64) {
    assert!(
        outcome.is_within,
        "{} seed {seed} {kind:?}: {:?}",
        model.id, outcome.worst
    );
}

/// Value below which the share `share` of the sorted values lies.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share) as usize]
}

/// Runs sessions of a policy on each arm, and checks the distances of the set-points from its curve.
fn follow(name: &str, kind: fn(&mut Random) -> Kind) {
    let (sessions, first) = (number("RPI_CHUNK_SESSIONS", 100), number("RPI_SEED", 1));
    for model in ARMS {
        let mut all = Vec::new();
        let (mut rest, mut late, mut limited, mut smoothing) = (0, 0, 0, 0.0f64);
        for seed in first..first + sessions.div_ceil(3) {
            let kind = kind(&mut Random::new(seed));
            let outcome = Session::new(model, kind, seed).run();
            check(&outcome, model, &kind, seed);
            rest += outcome.at_rest;
            late += outcome.late;
            limited += outcome.limited;
            smoothing = smoothing.max(outcome.smoothing);
            assert_eq!(outcome.rejected, 0, "{} seed {seed}", model.id);
            all.extend(outcome.errors);
        }
        all.sort_by(f64::total_cmp);
        let (median, p99) = (quantile(&all, 0.5), quantile(&all, 0.99));
        println!(
            "{name}, {}: {} cycles, error median {median:.4} p99 {p99:.4} largest {:.4}, {rest} at rest, {late} late, {limited} limited, smoothing {smoothing:.4}",
            model.id,
            all.len(),
            quantile(&all, 1.0)
        );
        assert!(median < 0.02 && p99 < 0.06, "{}: {median} {p99}", model.id);
    }
}

#[test]
fn a_policy_is_followed_closely() {
    follow("any horizon", tracked);
}

/// Delays up to half of a horizon of 1 s: two of them in succession may be as long as the chunk.
#[test]
fn a_policy_with_a_short_horizon_is_followed_closely() {
    follow("1 s", |random| Kind {
        ask: random.between(0.2, 0.5),
        delay: (0.02, 0.5),
        chunks: 20,
        rows: 51,
        ..OFTEN_LATE
    });
}

#[test]
fn wild_chunks_keep_every_limit_and_give_the_same_bits_again() {
    let (sessions, first) = (number("RPI_CHUNK_SESSIONS", 100), number("RPI_SEED", 1));
    for model in ARMS {
        for seed in first..first + sessions.div_ceil(3) {
            let kind = wild(&mut Random::new(seed));
            let outcome = Session::new(model, kind, seed).run();
            check(&outcome, model, &kind, seed);
            if seed % 10 == 0 {
                let again = Session::new(model, kind, seed).run();
                assert_eq!(outcome.digest, again.digest, "{} seed {seed}", model.id);
            }
        }
    }
}

/// Time in which every axis of an arm can stop from its highest velocity, s.
fn braking_time(model: &ArmModel) -> f64 {
    let of_axis = |limits: &rpi_kin::AxisLimits| {
        limits.velocity / limits.acceleration + limits.acceleration / limits.jerk
    };
    model.limits.iter().map(of_axis).fold(0.0, f64::max)
}

/// Chunks of 1 s, with delays up to 0.8 s: some come after the last row of the one before.
const OFTEN_LATE: Kind = Kind {
    chunks: 200,
    ask: 0.5,
    period: 0.02,
    rows: 50,
    delay: (0.02, 0.8),
    noise: 5e-5,
    offset: 2e-3,
    with_velocities: false,
    is_wild: false,
};

#[test]
fn two_hundred_chunks_with_long_delays_keep_every_limit_and_give_the_same_bits_again() {
    for model in ARMS {
        let outcome = Session::new(model, OFTEN_LATE, 7).run();
        check(&outcome, model, &OFTEN_LATE, 7);
        let mut errors = outcome.errors.clone();
        errors.sort_by(f64::total_cmp);
        println!(
            "{}: {} cycles, {} late, {} at rest, error median {:.4}",
            model.id,
            errors.len(),
            outcome.late,
            outcome.at_rest,
            quantile(&errors, 0.5)
        );
        assert!(
            outcome.late > 0 && outcome.at_rest < outcome.late,
            "{}",
            model.id
        );
        let again = Session::new(model, OFTEN_LATE, 7).run();
        assert_eq!(outcome.digest, again.digest, "{}", model.id);
    }
}

#[test]
fn a_late_chunk_stops_the_arm_on_its_path_and_the_next_one_moves_it_on() {
    for model in ARMS {
        for seed in 0..20 {
            let kind = Kind {
                offset: 0.0,
                ..tracked(&mut Random::new(seed))
            };
            let mut session = Session::new(model, kind, seed);
            session.run_chunks(6);
            let mut remaining = session.cycle(true).remaining;
            let mut cycles = 0.0;
            let at = loop {
                let at = session.cycle(true);
                cycles += 1.0;
                assert!(at.deviation < 1e-3, "{} seed {seed}: {at:?}", model.id);
                // The time of the curve never passes faster than real time, nor beyond the last row.
                assert!(at.remaining <= remaining && at.remaining >= -1e-9, "{at:?}");
                remaining = at.remaining;
                if at.at_rest {
                    break at;
                }
                assert!(cycles < 1e4, "{} seed {seed} does not stop", model.id);
            };
            assert!(at.is_late && at.remaining < 1e-6, "{at:?}");
            let longest = kind.horizon() + braking_time(model);
            assert!(
                cycles * watch::PERIOD <= longest,
                "{} {seed} {cycles}",
                model.id
            );
            session.run_chunks(6);
            let error = session.error();
            assert!(error < 0.06, "{} seed {seed}: {error}", model.id);
            assert!(session.watch.is_within(), "{:?}", session.watch.worst);
        }
    }
}

/// A policy goes on while the arm pauses: its new chunks do not move the arm.
#[test]
fn a_pause_stops_the_arm_while_chunks_go_on_coming() {
    for model in ARMS {
        for seed in 0..10 {
            let kind = tracked(&mut Random::new(seed));
            let mut session = Session::new(model, kind, seed);
            session.run_chunks(5);
            session.set_paused(true);
            session.fastest_within(2.0 * braking_time(model) + 0.5);
            let fastest = session.fastest_within(3.0);
            assert!(fastest < 1e-9, "{} seed {seed}: {fastest}", model.id);
            session.set_paused(false);
            session.run_chunks(12);
            let error = session.error();
            assert!(error < 0.06, "{} seed {seed}: {error}", model.id);
            assert!(session.watch.is_within(), "{:?}", session.watch.worst);
        }
    }
}
