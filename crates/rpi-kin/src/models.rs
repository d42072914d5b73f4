//! Known arm models.
//!
//! Lengths are those of the vendors. Where a limit is not published, a comment names its replacement.

pub mod franka;
pub mod kr;
pub mod lbr;
pub mod linear;
pub mod universal;

use crate::model::ArmModel;

/// All arm models, sorted by `id`.
pub const ALL: &[&ArmModel] = &[
    &franka::PANDA,
    &lbr::IIWA_14,
    &lbr::IIWA_7,
    &kr::KR_16_2,
    &kr::KR_6_R900,
    &lbr::LWR_4_PLUS,
    &universal::UR5E,
];

/// Returns the arm model with this name.
#[must_use]
pub fn by_id(id: &str) -> Option<&'static ArmModel> {
    ALL.iter().copied().find(|model| model.id == id)
}
