//! Units of measure: dimensions with rational exponents, the table of units, and their formatting.
//!
//! A dimension is a product of powers of the seven SI base dimensions and the plane angle. Values are kept in coherent
//! SI units (m, kg, s, A, K, mol, cd, rad), so a unit is a dimension and a factor that is applied at compile time. This
//! module must not know types or expressions.
//!
//! **Angles.** In the SI the radian equals 1, and formulas rely on that (`v = omega * r`, `omega = sqrt(k / m)`). So
//! angles are tracked and printed, but two dimensions [match](Dimension::is_compatible) if they agree in all other exponents. A
//! mistake that this rule would miss, a plain number for an angle (`30` for `30[deg]`), is reported where literals are
//! checked.

mod dim;
mod ratio;
mod resolve;
mod table;

pub use dim::{BaseDim, Dimension, FREE_COUNT};
pub use ratio::Ratio;
pub use resolve::{ResolvedUnit, UnitError, is_unit, resolve};
pub use table::{Factor, UNITS, UnitDef};
