//! Functions in C that are defined outside of the program.

use crate::aggregates::Array;
use crate::macros::interface;
use crate::operand::Text;
use crate::registry::Prim;
use rpi_image::{Role, ShapeRule};

pub(in crate::catalogue) const ALL: &[Prim] = &[EXTERNAL_FUNCTION];

interface! {
    /// Call of a function in C. `Signature` has its name and its ports; the compiler writes it. The values of the ports
    /// are grouped by kind, each group in the order of the ports. The function must be pure: its results depend only on
    /// its arguments.
    EXTERNAL_FUNCTION = "Rpi::ExternalFunction";
    in { inReals: Array<f64>; inIntegers: Array<i64>; inBooleans: Array<bool> }
    param { Signature: Text = Str(""); Reals: i64 = Int(0); Integers: i64 = Int(0); Booleans: i64 = Int(0) }
    out { outReals: Array<f64>; outIntegers: Array<i64>; outBooleans: Array<bool> }
    shape ShapeRule::FromParams(&["Reals", "Integers", "Booleans"]);
    presence strict work 100;
    role Role::ExternalFunction("Signature")
}
