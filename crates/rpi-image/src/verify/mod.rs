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

/// Look-up of the declaration of a primitive by registered name.
pub type PrimLookup<'a> = &'a dyn Fn(&str) -> Option<&'static PrimDesc>;

/// Position of an error in an image.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ErrorLocation {
    /// Entry of a table: name of the table and index.
    Table(&'static str, usize),
    /// Step of the evaluation phase with this index.
    Step(usize),
    /// Step of the commit phase with this index.
    Commit(usize),
}

/// Error found by the verifier.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VerifyError {
    /// Position of the error.
    pub location: ErrorLocation,
    /// Description of the error, with the numbers of the slots.
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

/// Verifies an image against the primitives of this build.
///
/// # Errors
/// Returns all errors, in the order of the image, at most 100. The image must not be used.
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

/// Maximum number of collected errors.
const MAX_ERRORS: usize = 100;
/// Scope of a slot that no step has written yet.
const UNWRITTEN: u32 = u32::MAX;

/// Steps that a skip jumps over, with the Boolean that guards them.
#[derive(Clone, Copy)]
struct Scope {
    outer: u32,
    guard: u32,
    /// Whether the Boolean of the guard has its final value: no later step of the phase changes it.
    is_final: bool,
}

/// State of the verification: the image, the errors so far and the knowledge about each slot.
struct Verifier<'a> {
    image: &'a Image,
    errors: Vec<VerifyError>,
    location: ErrorLocation,
    /// Scope of the writer of each slot: 0 outside all skips. Constants, external slots and state slots have scope 0,
    /// as they are readable at any time.
    writer_scope: Vec<u32>,
    /// For each state slot, whether a step uses it as its state.
    owned: Vec<bool>,
    /// The root scope and the scopes of all skips so far.
    scopes: Vec<Scope>,
    /// Index of the innermost scope around the current step.
    scope: u32,
    /// Number of open scopes with this guard, for each slot. The slot is known to be true here if it is not 0.
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

    /// Returns the declarations of the used primitives; `None` for one that is unknown or has another signature.
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
