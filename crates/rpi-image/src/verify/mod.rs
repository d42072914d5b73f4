//! Independent verifier of images. It runs before the first step of an image.
//!
//! The verifier does not trust the compiler and shares no code with it. Running an accepted image cannot access memory
//! out of range, loop, read a value before it is written, or write one slot from two steps:
//!
//! - All indices are in range. Operand words match the declarations of the primitives of this build.
//! - Constants and external slots are never written. Every state slot and every value slot has at most one writer.
//! - Every value is written by an earlier step than its readers. A Boolean that affects control (skip, reset, presence)
//!   is written on every path to its reader; skips with the same guard are taken together. Only plain values may be
//!   stale where a fragment is inactive.
//! - Skips jump forward and nest. A commit copy does not read a slot that the commit phase has already overwritten.

mod access;
mod run_steps;
mod steps;
mod tables;

use crate::desc::PrimDesc;
use crate::hash::prim_signature;
use crate::image::{Image, TRUE};
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

/// Function that returns the declaration of a primitive by its registered name; `None` for an unknown name.
pub type PrimLookup<'a> = &'a dyn Fn(&str) -> Option<&'static PrimDesc>;

/// Place in an image at which the verifier reports an error.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ErrorLocation {
    /// Entry of a table of the image: name of the table, and index of the entry.
    Table(&'static str, usize),
    /// Step of the evaluation phase, as an index into [`Image::steps`].
    Step(usize),
    /// Step of the commit phase, as an index into [`Image::commit`].
    Commit(usize),
}

/// Error in an image that the verifier reports.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VerifyError {
    /// Table entry or step of the image that is invalid.
    pub location: ErrorLocation,
    /// Description of the error, with the indices of the slots.
    pub message: String,
}

impl fmt::Display for VerifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.location {
            ErrorLocation::Table(name, index) => write!(f, "{name} {index}: {}", self.message),
            ErrorLocation::Step(pc) => write!(f, "step {pc}: {}", self.message),
            ErrorLocation::Commit(pc) => write!(f, "commit step {pc}: {}", self.message),
        }
    }
}

impl core::error::Error for VerifyError {}

/// Verifies an image: all accesses, jumps and operands are valid for the primitives in `catalogue`.
///
/// # Errors
/// Returns the errors in the order of the image, at most 100. An image with an error must not be executed.
pub fn verify(image: &Image, catalogue: PrimLookup<'_>) -> Result<(), Vec<VerifyError>> {
    let mut check = Verifier::new(image);
    check.layout();
    if check.errors.is_empty() {
        let prims = check.prims(catalogue);
        check.tables();
        check.evaluation(&prims);
        check.commit();
        check.check_results();
    }
    match check.errors.is_empty() {
        true => Ok(()),
        false => Err(check.errors),
    }
}

/// Maximum number of errors that the verifier collects for one image.
const MAX_ERRORS: usize = 100;
/// Entry of [`Verifier::writer_scope`] for a slot that no step has written so far.
const UNWRITTEN: u32 = u32::MAX;

/// Scope: the steps that one skip jumps over, with the Boolean slot (guard) that lets them run.
#[derive(Clone, Copy)]
struct Scope {
    outer: u32,
    guard: u32,
    /// True if no later step of the phase changes the Boolean slot of the guard.
    is_final: bool,
}

/// State of the verification of one image: the errors so far, and which steps have written each slot.
struct Verifier<'a> {
    image: &'a Image,
    errors: Vec<VerifyError>,
    location: ErrorLocation,
    /// For each slot, the scope of the step that writes it: an index into `scopes`, 0 for a step outside all skips, or
    /// [`UNWRITTEN`]. Constants, external slots and state slots have scope 0, because every step may read them.
    writer_scope: Vec<u32>,
    /// For each slot of the state region, true if a step uses the slot as its state.
    owned: Vec<bool>,
    /// Scopes so far: the root scope, which holds the steps outside all skips, and one scope for each skip.
    scopes: Vec<Scope>,
    /// Innermost scope around the current step: an index into `scopes`.
    scope: u32,
    /// For each slot, the number of scopes around the current step that this slot guards. If the number is not 0, the
    /// slot is true whenever the current step runs.
    open_guards: Vec<u32>,
}

impl<'a> Verifier<'a> {
    fn new(image: &'a Image) -> Self {
        Verifier {
            image,
            errors: Vec::new(),
            location: ErrorLocation::Table("layout", 0),
            writer_scope: Vec::new(),
            owned: Vec::new(),
            scopes: vec![Scope {
                outer: 0,
                guard: TRUE,
                is_final: true,
            }],
            scope: 0,
            open_guards: Vec::new(),
        }
    }

    fn report(&mut self, what: String) {
        if self.errors.len() < MAX_ERRORS {
            self.errors.push(VerifyError {
                location: self.location,
                message: what,
            });
        }
    }

    fn require(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if !holds {
            self.report(what());
        }
    }

    /// Returns the declaration of each primitive in [`Image::prims_used`]. Reports an error for a primitive that is
    /// unknown or has another signature; its entry is `None`.
    fn prims(&mut self, catalogue: PrimLookup<'_>) -> Vec<Option<&'static PrimDesc>> {
        let mut found = Vec::with_capacity(self.image.prims_used.len());
        for (k, used) in self.image.prims_used.iter().enumerate() {
            self.location = ErrorLocation::Table("primitive", k);
            let desc = catalogue(&used.name);
            let same = desc.filter(|d| prim_signature(d) == used.signature);
            self.require(desc.is_some(), || {
                alloc::format!("unknown primitive {}", used.name)
            });
            self.require(desc.is_none() || same.is_some(), || {
                alloc::format!("{} is declared differently in this build", used.name)
            });
            found.push(same);
        }
        found
    }
}
