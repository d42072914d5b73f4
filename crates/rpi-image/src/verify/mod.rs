//! The independent verifier: what must hold of an image before a single step of it runs.
//!
//! It trusts nobody, least of all our own compiler, and shares no code with it. After it has passed, running the image
//! cannot leave its memory, loop, read a value before somebody has written it, or let two steps write one cell:
//!
//! - all indices are in range, operand words fit the declarations of this build's primitives;
//! - constants and external cells are never written, every state and value cell has at most one writer;
//! - every value is written by an earlier step than reads it, and what decides about control (skips, resets, presence)
//!   is written on every path to its reader (skips of one guard are taken or not taken together); only plain values may
//!   be stale where a fragment is inactive;
//! - skips jump forward and nest; a commit copy reads nothing that the commit phase has already overwritten.

mod access;
mod rows;
mod steps;
mod tables;

use crate::desc::PrimDesc;
use crate::hash::signature;
use crate::image::{Image, TRUE};
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

/// How the verifier and the printer get at the declarations of the primitives.
pub type Catalogue<'a> = &'a dyn Fn(&str) -> Option<&'static PrimDesc>;

/// Where something is wrong.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum At {
    /// In a table: its name and the index in it.
    Table(&'static str, usize),
    /// In the evaluation phase, at this step.
    Step(usize),
    /// In the commit phase, at this step.
    Commit(usize),
}

/// Something that does not hold.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VerifyError {
    /// Where.
    pub at: At,
    /// What, in words that name the cell.
    pub what: String,
}

impl fmt::Display for VerifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.at {
            At::Table(name, index) => write!(f, "{name} {index}: {}", self.what),
            At::Step(pc) => write!(f, "step {pc}: {}", self.what),
            At::Commit(pc) => write!(f, "commit step {pc}: {}", self.what),
        }
    }
}

impl core::error::Error for VerifyError {}

/// Checks an image against the primitives of this build.
///
/// # Errors
/// Everything that does not hold, in the order of the image. Nothing of the image may be used then.
pub fn verify(image: &Image, catalogue: Catalogue<'_>) -> Result<(), Vec<VerifyError>> {
    let mut check = Check::new(image);
    check.layout();
    if check.errors.is_empty() {
        let prims = check.prims(catalogue);
        check.tables();
        check.evaluation(&prims);
        check.commit();
        check.results();
    }
    match check.errors.is_empty() {
        true => Ok(()),
        false => Err(check.errors),
    }
}

/// No more findings than this are collected from a hopeless image.
const ENOUGH: usize = 100;
/// The scope of a cell that nobody has written yet.
const UNWRITTEN: u32 = u32::MAX;

/// Steps that a skip jumps over.
#[derive(Clone, Copy)]
struct Scope {
    outer: u32,
    guard: u32,
    /// Whether no later step of the phase changes the guard.
    is_final: bool,
}

/// The image, what was found so far, and what is known of each cell.
struct Check<'a> {
    image: &'a Image,
    errors: Vec<VerifyError>,
    at: At,
    /// For each cell the scope of its writer: 0 outside of all skips. Constants and external cells have scope 0, state
    /// cells are readable at any time.
    writer: Vec<u32>,
    /// For each state cell whether something owns it.
    owned: Vec<bool>,
    /// The root and every skip so far: what is around it and the cell that opens it.
    scopes: Vec<Scope>,
    /// The innermost open scope.
    scope: u32,
    /// For each cell how many open scopes it opens: it is true here if there is one.
    holds: Vec<u32>,
}

impl<'a> Check<'a> {
    fn new(image: &'a Image) -> Self {
        Check {
            image,
            errors: Vec::new(),
            at: At::Table("layout", 0),
            writer: Vec::new(),
            owned: Vec::new(),
            scopes: vec![Scope {
                outer: 0,
                guard: TRUE,
                is_final: true,
            }],
            scope: 0,
            holds: Vec::new(),
        }
    }

    fn fail(&mut self, what: String) {
        if self.errors.len() < ENOUGH {
            self.errors.push(VerifyError { at: self.at, what });
        }
    }

    fn demand(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if !holds {
            self.fail(what());
        }
    }

    /// The declarations of the primitives used; none where a primitive is unknown or another.
    fn prims(&mut self, catalogue: Catalogue<'_>) -> Vec<Option<&'static PrimDesc>> {
        let mut found = Vec::with_capacity(self.image.prims.len());
        for (k, used) in self.image.prims.iter().enumerate() {
            self.at = At::Table("primitive", k);
            let desc = catalogue(&used.name);
            let same = desc.filter(|d| signature(d) == used.signature);
            self.demand(desc.is_some(), || {
                alloc::format!("{} is unknown", used.name)
            });
            self.demand(desc.is_none() || same.is_some(), || {
                alloc::format!("{} is declared differently in this build", used.name)
            });
            found.push(same);
        }
        found
    }
}
