//! Durations beside those of the Python package `ruckig`.

use crate::cases::{Case, Random, plan_together};
use crate::reference::{Reference, Request, run};
use crate::verify::errors;
use rpi_motion::online::{MotionOptions, OnlineMotion, Synchronization};

/// Number of motion requests for which the Python script is called once.
const BATCH: u64 = 20_000;

/// Numbers of requests by the result of their comparison with `ruckig`.
#[derive(Default)]
struct Tally {
    cases: u64,
    failures: u64,
    over_limits: u64,
    missed: u64,
    worst_end: f64,
    reference_errors: u64,
    reference_inexact: u64,
    longer: u64,
    longer_than_inexact: u64,
    shorter: u64,
}

impl Tally {
    fn compare(&mut self, duration: f64, reference: &Reference, describe: impl Fn() -> String) {
        if !reference.is_planned {
            self.reference_errors += 1;
            return;
        }
        // Errors that cannot be rounding: the end of that motion is not the target.
        let is_exact = reference.errors.iter().all(|error| *error <= 1e-12);
        // Its tolerance is 1e-8; the position may be missed by more than the distance, so that it does not move at all.
        self.reference_inexact += u64::from(!is_exact);
        self.shorter += u64::from(duration < reference.duration - 1e-8);
        if duration > reference.duration * (1.0 + 1e-11) + 1e-8 {
            if is_exact {
                self.longer += 1;
            } else {
                self.longer_than_inexact += 1;
            }
            if is_exact && self.longer <= 10 || std::env::var("RPI_SHOW").is_ok() {
                println!(
                    "longer: {duration} instead of {} (end errors {:?}): {}",
                    reference.duration,
                    reference.errors,
                    describe()
                );
            }
        }
    }

    fn report(&self) {
        println!(
            "{} requests: {} failed, {} over a limit by more than 1e-9, {} miss the target by more than 1e-8 (worst {:.1e})",
            self.cases, self.failures, self.over_limits, self.missed, self.worst_end
        );
        println!(
            "ruckig: {} errors, {} motions that miss the target or exceed a limit by more than 1e-12",
            self.reference_errors, self.reference_inexact
        );
        println!(
            "longer than ruckig by more than 1e-8 s: {}, and {} than such motions of ruckig; shorter: {}",
            self.longer, self.longer_than_inexact, self.shorter
        );
    }

    fn verify<const N: usize>(&mut self, axes: &[Case; N], motion: &OnlineMotion<N>) {
        for (case, profile) in axes.iter().zip(motion.axes()) {
            let found = errors(case, profile);
            let end = found.worst_end() - found.rounding;
            let (is_missed, is_over) = (end > 1.01e-8, found.worst_excess() > 1e-9);
            self.worst_end = self.worst_end.max(end);
            self.missed += u64::from(is_missed);
            self.over_limits += u64::from(is_over);
            if is_missed && self.missed <= 10 || is_over && self.over_limits <= 10 {
                println!("invalid: {found:?}: {case:?}\n {:?}", profile.phases());
            }
        }
    }
}

/// Compares `count` random motions of one axis with those of `ruckig`, and prints the numbers of deviations.
pub fn single(count: u64, seed: u64) {
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    for batch in 0..count.div_ceil(BATCH) {
        let size = BATCH.min(count - batch * BATCH);
        let cases: Vec<[Case; 1]> = (0..size).map(|_| [Case::random(&mut random)]).collect();
        let requests = cases.iter().map(|axes| Request {
            axes,
            synchronization: Synchronization::None,
            minimum_duration: 0.0,
        });
        let Some(references) = run(requests) else {
            return;
        };
        for ([case], reference) in cases.iter().zip(&references) {
            tally.cases += 1;
            let Some(motion) = case.plan(MotionOptions::default()) else {
                tally.failures += 1;
                continue;
            };
            tally.verify(&[*case], &motion);
            tally.compare(motion.duration(), reference, || format!("{case:?}"));
        }
    }
    tally.report();
}

/// Compares `count` random synchronised motions of three axes with those of `ruckig`, and prints the numbers of
/// deviations.
pub fn together(count: u64, seed: u64) {
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    let mut unsynchronised = 0;
    for batch in 0..count.div_ceil(BATCH) {
        let size = BATCH.min(count - batch * BATCH);
        let cases: Vec<([Case; 3], f64)> = (0..size).map(|_| axes(&mut random)).collect();
        let requests = cases.iter().map(|(axes, minimum)| Request {
            axes,
            synchronization: Synchronization::Time,
            minimum_duration: *minimum,
        });
        let Some(references) = run(requests) else {
            return;
        };
        for ((axes, minimum), reference) in cases.iter().zip(&references) {
            tally.cases += 1;
            let options = MotionOptions {
                synchronization: Synchronization::Time,
                minimum_duration: *minimum,
            };
            let Some(motion) = plan_together(axes, options) else {
                tally.failures += 1;
                continue;
            };
            unsynchronised += u64::from(motion.synchronization() != Synchronization::Time);
            tally.verify(axes, &motion);
            tally.compare(motion.duration(), reference, || {
                format!("{minimum} {axes:?}")
            });
        }
    }
    println!("{unsynchronised} motions are not synchronised");
    tally.report();
}

fn axes(random: &mut Random) -> ([Case; 3], f64) {
    let mut axes = [(); 3].map(|()| Case::random(random));
    while axes
        .iter()
        .any(|case| case.is_velocity != axes[0].is_velocity)
    {
        axes = [(); 3].map(|()| Case::random(random));
    }
    let minimum = if random.chance(0.3) {
        random.between(0.0, 10.0)
    } else {
        0.0
    };
    (axes, minimum)
}
