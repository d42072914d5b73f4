//! The arms that are known by name.
//!
//! Lengths are the vendors'; where a limit is not published, the comment beside it says what stands in for it.

pub mod lbr;

use crate::model::ArmModel;

/// All of them, sorted by name.
pub const ALL: &[&ArmModel] = &[&lbr::IIWA_14, &lbr::IIWA_7, &lbr::LWR_4_PLUS];

/// The arm with this name.
#[must_use]
pub fn by_id(id: &str) -> Option<&'static ArmModel> {
    ALL.iter().copied().find(|model| model.id == id)
}
