//! Known arm models.
//!
//! Lengths are those of the vendors. Where a limit is not published, a comment names its replacement.

pub mod franka;
pub mod kuka_kr;
pub mod kuka_lbr;
pub mod linear;
pub mod universal_robots;

use crate::model::ArmModel;

/// All built-in arm models, sorted by their name `id`.
pub const ALL: &[&ArmModel] = &[
    &franka::PANDA,
    &kuka_lbr::IIWA_14,
    &kuka_lbr::IIWA_7,
    &kuka_kr::KR_16_2,
    &kuka_kr::KR_6_R900,
    &kuka_lbr::LWR_4_PLUS,
    &universal_robots::UR5E,
];

/// Returns the arm model that a cell description names, such as `ur5e`; `None` if there is no such model.
#[must_use]
pub fn by_id(id: &str) -> Option<&'static ArmModel> {
    ALL.iter().copied().find(|model| model.id == id)
}
