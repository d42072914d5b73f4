//! `rpic machine`: measures the worst-case time of an elementary operation on this machine, for the budgets of
//! programs.

use std::path::PathBuf;

use rpi_driver::{Input, InputKind, compile, lower_for_execution, machine_text};
use rpi_runtime::cycle_time::cold_cycle_ns;

use crate::args::MachineArgs;
use crate::outcome::{CommandResult, Exit, write_output};

/// Number of equations of the program whose cycle is measured. So many equations of different kinds defeat the branch
/// prediction of the processor.
const EQUATIONS: usize = 2_000;

/// Number of cycles of the program that are measured.
const CYCLES: usize = 500;

/// Safety factor on the measured time of an operation. Other programs and cold caches make an operation slower than in
/// the measurement.
const MARGIN: f64 = 2.0;

/// Period for which the measured program is compiled, in ns (1 ms).
const PERIOD: u64 = 1_000_000;

/// Carries out `rpic machine`: measures the time of an elementary operation, and writes it to a `machine.toml` file or
/// prints it.
pub(crate) fn machine(args: &MachineArgs) -> CommandResult {
    let input = Input {
        path: PathBuf::from("measured.rpi"),
        kind: InputKind::Rpi,
        bytes: program(EQUATIONS).into_bytes(),
    };
    let compiled = compile(&input)?;
    let [net] = compiled.nets() else {
        return Err("internal error: the measured program does not compile".into());
    };
    let operations = net.work_bound().max(1);
    let cycle = cold_cycle_ns(lower_for_execution(net, PERIOD)?, CYCLES)?;
    let measured = cycle as f64 / operations as f64;
    let ns = MARGIN * measured;
    rpi_diag::println_stderr!(
        "a cycle of {operations} operations took {cycle} ns with cold caches: {measured:.2} ns per operation, recorded as {ns:.2}"
    );
    write_output(args.output.as_deref(), machine_text(ns).as_bytes())?;
    Ok(Exit::Success)
}

/// Returns the source text of the measured program: a command with `equations` sums, products, selections, comparisons
/// and delays.
fn program(equations: usize) -> String {
    let mut body = String::from("  x0 = time / 1[s];\n");
    for k in 1..equations {
        // A multiple of the golden ratio spreads the second operand over all earlier flows, and with it over the cache.
        let (one, other) = (k - 1, ((k * 2_654_435_761) >> 7) % k);
        let value = match (k * 31) % 5 {
            0 => format!("0.5 * x{one} + 0.25 * x{other}"),
            1 => format!("if x{one} > x{other} then x{one} else -x{other}"),
            2 => format!("x{one} -> pre x{one} * 0.5"),
            3 => format!("x{one} - x{other} * 0.125"),
            _ => format!("if x{one} >= 0.0 and x{other} <= 1.0 then 0.5 else x{one}"),
        };
        body.push_str(&format!("  x{k} = {value};\n"));
    }
    let last = equations - 1;
    format!(
        "command Measured ()\nlet\n{body}  export x{last};\n  finish done when x{last} > 1000000.0;\ntel\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_that_is_measured_compiles() {
        let input = Input {
            path: PathBuf::from("measured.rpi"),
            kind: InputKind::Rpi,
            bytes: program(50).into_bytes(),
        };
        let compiled = compile(&input).expect("it is a program");
        assert_eq!(compiled.diagnostics, []);
        assert_eq!(compiled.nets().len(), 1);
    }
}
