//! Two arms, and commands that bring one or both of them to some goal from any state of motion.

use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

use rpi_driver::{Input, InputKind, compile, lower_for_execution};
use rpi_image::Image;
use rpi_sim::Cell;

pub(crate) const TICK_NS: u64 = 1_000_000;
pub(crate) const ARMS: [&str; 2] = ["left", "right"];
pub(crate) const AXES: usize = 7;

/// Number of goals for each set of arms.
const GOALS: usize = 12;

/// Set of arms that a command moves, as bits.
pub(crate) type Arms = u8;

pub(crate) const BOTH: Arms = 3;

pub(crate) fn cell() -> Cell {
    let arm = |name: &str| {
        format!(
            "[devices.{name}]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\n\
             joints = [\"0 deg\", \"-30 deg\", \"0 deg\", \"90 deg\", \"0 deg\", \"-60 deg\", \"0 deg\"]\n"
        )
    };
    let text = ARMS.map(arm).concat();
    Cell::parse("cell.toml", &text).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns the images with the arms that each one moves.
pub(crate) fn images(random: &mut Random) -> Vec<(Arms, Arc<Image>)> {
    let sets: Vec<Arms> = (1..=BOTH).flat_map(|set| [set; GOALS]).collect();
    let text: String = sets
        .iter()
        .enumerate()
        .map(|(k, set)| command(k, *set, random))
        .collect();
    let input = Input {
        path: PathBuf::from("soak.rpi"),
        kind: InputKind::Rpi,
        bytes: format!("use motion;\n{text}").into_bytes(),
    };
    let compiled = compile(&input).unwrap_or_else(|e| panic!("{e}"));
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    let image = |k: usize| {
        let name = format!("Go{k}");
        let net = compiled.nets().iter().find(|net| net.name == name);
        let image = lower_for_execution(net.expect("it was written"), TICK_NS);
        Arc::new(image.unwrap_or_else(|e| panic!("{e}")))
    };
    sets.iter()
        .enumerate()
        .map(|(k, set)| (*set, image(k)))
        .collect()
}

/// Returns a command that moves to a random goal and may be taken over after a random time; `early` is its second
/// result.
fn command(k: usize, set: Arms, random: &mut Random) -> String {
    let arms: Vec<&str> = (0..2)
        .filter(|a| set & (1 << a) != 0)
        .map(|a| ARMS[a])
        .collect();
    let params: Vec<String> = arms.iter().map(|arm| format!("{arm}: Arm")).collect();
    let mut text = format!("command Go{k} ({})\nlet\n", params.join("; "));
    let (mut done, mut broken) = (Vec::new(), Vec::new());
    for arm in arms {
        let goal: Vec<String> = (0..AXES)
            .map(|_| format!("{:.3}[rad]", random.between(-1.0, 1.0)))
            .collect();
        let _ = writeln!(
            text,
            "  {arm}_way = PointToPoint<<speed: 1[rad/s], acceleration: 2[rad/s^2], jerk: 20[rad/s^3]>>(\n    \
             {arm}, to: [{}]);\n  \
             {arm}.joints = {arm}_way.joints;",
            goal.join(", ")
        );
        done.push(format!("{arm}_way.done"));
        broken.push(format!("{arm}.error"));
    }
    let after = random.between(2.0, 60.0);
    let (done, broken) = (done.join(" and "), broken.join(" or "));
    let _ = writeln!(
        text,
        "  finish done when {done};\n  yield early when time > {after:.1}[ms];\n  fail broken when {broken};\ntel"
    );
    text
}

/// Pseudo-random number generator splitmix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators,
/// 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// Returns true with probability 1/`times`.
    pub(crate) fn once_in(&mut self, times: u64) -> bool {
        self.next().is_multiple_of(times)
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }
}
