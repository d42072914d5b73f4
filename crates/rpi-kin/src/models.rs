//! The arms that are known by name.
//!
//! Lengths are the vendors'; where a limit is not published, the comment beside it says what stands in for it.

pub mod franka;
pub mod kr;
pub mod lbr;
pub mod linear;
pub mod universal;

use crate::model::ArmModel;

/// All arms, sorted by name.
pub const ALL: &[&ArmModel] = &[
    &franka::PANDA,
    &lbr::IIWA_14,
    &lbr::IIWA_7,
    &kr::KR_16_2,
    &kr::KR_6_R900,
    &lbr::LWR_4_PLUS,
    &universal::UR5E,
];

/// The arm with this name.
#[must_use]
pub fn by_id(id: &str) -> Option<&'static ArmModel> {
    ALL.iter().copied().find(|model| model.id == id)
}
