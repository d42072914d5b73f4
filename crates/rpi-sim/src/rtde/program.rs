//! The URScript program that the driver sends to the controller.

use super::UrSpec;
use rpi_kin::AxisLimits;

/// Program with words in angle brackets that [`text`] replaces.
const TEMPLATE: &str = include_str!("follow.script");

/// Time without a driver after which the program ends, in s.
const IDLE_TIME: f64 = 5.0;
/// Maximum distance of the first set-point from the measured position: the norm over all joints, in rad.
const START_TOLERANCE: f64 = 0.02;
/// Share of the velocity limit that the program never exceeds. The playing speed varies by 5 %.
const VELOCITY_RESERVE: f64 = 1.05;
/// Share of the acceleration limit that the program never exceeds: interpolation and jitter add to that of the cell.
const ACCELERATION_RESERVE: f64 = 1.05;
/// Velocity with which a deviation from the set-points after a gap is corrected, per deviation, in 1/s.
const CORRECTION: f64 = 10.0;
/// Maximum deviation from the set-points that is corrected: the norm over all joints, in rad.
const GAP: f64 = 0.1;
/// Time without set-points in which the velocity stays, in s. Afterwards it decreases.
const BRIDGE_TIME: f64 = 0.02;
/// Upper 16 bits of the token of each program of this driver, in ASCII "RP".
const TOKEN_MARK: i32 = 0x5250_0000;

/// Returns a token for the programs of one connection, from any number.
pub(super) fn token(seed: u32) -> i32 {
    TOKEN_MARK | (seed & 0xffff) as i32
}

/// True for a token of a program of this driver, of this process or another one.
pub(super) fn is_token(token: i32) -> bool {
    token >> 16 == TOKEN_MARK >> 16
}

/// Returns the text of the program for an arm with these limits.
pub(super) fn text(spec: &UrSpec, limits: &[AxisLimits], token: i32) -> String {
    let list = |value: &dyn Fn(&AxisLimits) -> f64| {
        let values: Vec<String> = limits.iter().map(|axis| decimal(value(axis))).collect();
        format!("[{}]", values.join(", "))
    };
    let accelerations = || limits.iter().map(|axis| axis.acceleration);
    let softest = accelerations().fold(f64::INFINITY, f64::min);
    let hardest = accelerations().fold(0.0, f64::max);
    // A weak servo is later.
    let lag = spec.lookahead * (300.0 / spec.gain).max(1.0);
    let values = [
        ("<token>", token.to_string()),
        ("<idle>", decimal(IDLE_TIME)),
        ("<start>", decimal(START_TOLERANCE)),
        (
            "<velocities>",
            list(&|axis| VELOCITY_RESERVE * axis.velocity),
        ),
        (
            "<accelerations>",
            list(&|axis| ACCELERATION_RESERVE * axis.acceleration),
        ),
        ("<softest>", decimal(softest)),
        ("<correction>", decimal(CORRECTION)),
        ("<gap>", decimal(GAP)),
        ("<bridge>", decimal(BRIDGE_TIME.min(spec.timeout))),
        ("<lag>", decimal(1.5 * lag)),
        // At the turn of a motion with the acceleration limit, the servo is behind without a velocity.
        ("<reach>", decimal(0.01 + 0.3 * hardest * lag * lag)),
        ("<shock>", decimal(0.05)),
        ("<jolt>", decimal(25.0)),
        ("<timeout>", decimal(spec.timeout)),
        ("<lookahead>", decimal(spec.lookahead)),
        ("<servo_gain>", decimal(spec.gain)),
        ("<deceleration>", decimal(softest)),
    ];
    // The description at the head of the file has lines with the same words.
    let begin = TEMPLATE.find("def ").unwrap_or(0);
    let replace = |text: String, (word, value): &(&str, String)| text.replace(word, value);
    values.iter().fold(TEMPLATE[begin..].to_owned(), replace)
}

/// Returns a number in the notation of URScript, which has no exponents.
fn decimal(value: f64) -> String {
    format!("{value:.6}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_has_no_word_left_to_replace() {
        let spec = UrSpec {
            host: "localhost".to_owned(),
            rtde_port: 30004,
            script_port: 30002,
            timeout: 0.1,
            lookahead: 0.1,
            gain: 300.0,
        };
        let model = rpi_kin::models::ALL.iter().find(|model| model.id == "ur5e");
        let text = text(&spec, model.expect("ur5e").limits, token(7));
        assert!(text.starts_with("def rpi_follow():\n") && text.ends_with("\nend\n"));
        assert!(text.contains("write_output_integer_register(27, 1380974599)"));
        assert!(text.contains("rpi_cycle, 0.100000, 300.000000)"));
        let words = text.split('<').skip(1);
        let is_word = |rest: &&str| rest.starts_with(|c: char| c.is_ascii_lowercase());
        let left: Vec<&str> = words.filter(is_word).collect();
        assert!(left.is_empty(), "{left:?}");
        assert!(
            text.contains("rpi_hardest = [9.896017, 9.896017,"),
            "{text}"
        );
    }

    #[test]
    fn tokens_are_recognised() {
        assert!(is_token(token(0)) && is_token(token(u32::MAX)));
        assert!(!is_token(0) && !is_token(-1));
    }
}
