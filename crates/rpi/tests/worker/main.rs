//! Compilation in worker processes: what a worker does costs its client an error, and nobody else anything.
#![cfg(target_os = "linux")]

mod client;
mod differential;
mod garbage;
mod limits;
mod processes;
mod scheduling;

/// Device that the texts of the tests move.
const CELL: &str = "
[devices.arm]
kind = \"arm\"
model = \"kuka-lwr4+\"
joints = [\"0 deg\", \"-30 deg\", \"0 deg\", \"90 deg\", \"0 deg\", \"-60 deg\", \"0 deg\"]
";

/// A net that compiles at once.
const SHORT: &str = "{in=Core::DoubleNetcommIn(Key='gain',Value='1.0'),\
    two=Core::DoubleMultiply(inFirst=in.outValue,Second='2.0'),\
    out=Core::DoubleNetcommOut(inValue=two.outValue,Key='twice')}";

/// Returns a net with this many additions in a row, which takes long to compile.
fn long(additions: usize) -> String {
    rpi_testkit::net_of_additions(additions, "1.5")
}
