//! Models of descriptions that were read, kept for the life of the process.
//!
//! Arms refer to their model for as long as they exist, in the cycle and without counting references, and a process reads
//! few descriptions. A model that was read before is found again, so that reading a cell often takes no more memory.

use super::kinematics::Row;
use rpi_kin::{ArmModel, AxisLimits, Chain, Convention, InverseKinematics, Link, Transform};
use std::sync::{Mutex, PoisonError};

/// Maximum number of different robot models that a process stores; they are never freed.
pub(super) const MAX_MODELS: usize = 1024;

static MODELS: Mutex<Vec<&'static ArmModel>> = Mutex::new(Vec::new());

/// Values of a robot model that may not be stored yet.
pub(super) struct NewModel {
    pub(super) id: String,
    pub(super) display_name: String,
    pub(super) source: String,
    pub(super) convention: Convention,
    pub(super) rows: Vec<Row>,
    pub(super) flange: Vec<Row>,
    pub(super) limits: Vec<AxisLimits>,
    pub(super) inverse: InverseKinematics,
}

impl NewModel {
    /// Returns the stored model with these values, and stores it if it is new; `None` if [`MAX_MODELS`] others are
    /// stored.
    pub(super) fn keep(self) -> Option<&'static ArmModel> {
        let mut models = MODELS.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = models.iter().find(|model| self.is(model)) {
            return Some(found);
        }
        if models.len() >= MAX_MODELS {
            return None;
        }
        let model: &'static ArmModel = Box::leak(Box::new(self.leaked()));
        models.push(model);
        Some(model)
    }

    fn is(&self, model: &ArmModel) -> bool {
        let chain = &model.chain;
        (self.id == model.id)
            && self.display_name == model.display_name
            && self.source == model.source
            && self.convention == chain.convention
            && self.limits == model.limits
            && self.inverse == model.inverse
            && are_rows(&self.rows, chain.links)
            && are_rows(&self.flange, chain.fixed_links)
    }

    fn leaked(self) -> ArmModel {
        ArmModel {
            id: self.id.leak(),
            display_name: self.display_name.leak(),
            source: self.source.leak(),
            chain: Chain {
                convention: self.convention,
                links: links(&self.rows).leak(),
                fixed_links: links(&self.flange).leak(),
            },
            limits: self.limits.leak(),
            inverse: self.inverse,
        }
    }
}

fn are_rows(rows: &[Row], links: &[Link]) -> bool {
    let is_row = |(row, link): (&Row, &Link)| {
        let before = link.before.copied();
        row.before == before
            && row.link
                == Link {
                    before: None,
                    ..*link
                }
    };
    rows.len() == links.len() && rows.iter().zip(links).all(is_row)
}

fn links(rows: &[Row]) -> Vec<Link> {
    let link = |row: &Row| {
        let leak = |before: Transform| -> &'static Transform { Box::leak(Box::new(before)) };
        Link {
            before: row.before.map(leak),
            ..row.link
        }
    };
    rows.iter().map(link).collect()
}
