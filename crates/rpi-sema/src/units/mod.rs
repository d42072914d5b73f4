//! Units of measure: dimensions with rational exponents, the table of units, and how both print.
//!
//! A dimension is a product of powers of the seven SI base dimensions and of the plane angle. Values are kept in
//! coherent SI units (m, kg, s, A, K, mol, cd, rad), so a unit is a dimension and a factor, applied when the program is
//! compiled. This module must not know types or expressions.
//!
//! **Angles.** SI calls the radian a plain 1, and formulas rely on it (`v = omega * r`, `omega = sqrt(k / m)`). So the
//! angle is tracked and printed, but two dimensions [meet](Dim::meets) if they agree in everything else. What SI's rule
//! would let slip, a plain number where an angle is wanted (`30` for `30[deg]`), is caught where literals are checked.

mod dim;
mod ratio;
mod resolve;
mod table;

pub use dim::{Base, Dim, FREE};
pub use ratio::Ratio;
pub use resolve::{Measure, UnitFault, is_unit, resolve};
pub use table::{Factor, UNITS, UnitRow};
