//! The URScript program that the driver sends to the controller.

use super::UrSpec;
use rpi_kin::AxisLimits;

/// Program with words in angle brackets that [`text`] replaces.
const TEMPLATE: &str = include_str!("follow.script");

/// Time without a driver after which the program ends, in s.
const IDLE_TIME: f64 = 5.0;
/// Maximum distance of the first set-point from the measured position: the norm over all joints, in rad.
const START_TOLERANCE: f64 = 0.02;
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

/// Returns the text of the program for an arm with these limits and a controller with a cycle of `cycle` s.
pub(super) fn text(spec: &UrSpec, limits: &[AxisLimits], cycle: f64, token: i32) -> String {
    let fastest = limits.iter().map(|axis| axis.velocity).fold(0.0, f64::max);
    let deceleration = limits.iter().map(|axis| axis.acceleration);
    // After an interruption of the connection, the set-points are ahead by its duration. With six axes, the norm is up
    // to 2.45 times the way of one axis, which is the reserve.
    let step = 2.5 * fastest * (cycle + spec.timeout.min(0.02));
    let values = [
        ("<token>", token.to_string()),
        ("<idle>", decimal(IDLE_TIME)),
        ("<start>", decimal(START_TOLERANCE)),
        ("<step>", decimal(step)),
        ("<timeout>", decimal(spec.timeout)),
        ("<lookahead>", decimal(spec.lookahead)),
        ("<gain>", decimal(spec.gain)),
        (
            "<deceleration>",
            decimal(deceleration.fold(f64::INFINITY, f64::min)),
        ),
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
        let text = text(&spec, model.expect("ur5e").limits, 0.002, token(7));
        assert!(text.starts_with("def rpi_follow():\n") && text.ends_with("\nend\n"));
        assert!(text.contains("write_output_integer_register(27, 1380974599)"));
        assert!(text.contains("rpi_cycle, 0.100000, 300.000000)"));
        let words = text.split('<').skip(1);
        let left: Vec<&str> = words.filter(|rest| rest.contains(">\n")).collect();
        assert!(!text.contains("<token>") && left.is_empty(), "{left:?}");
    }

    #[test]
    fn tokens_are_recognised() {
        assert!(is_token(token(0)) && is_token(token(u32::MAX)));
        assert!(!is_token(0) && !is_token(-1));
    }
}
