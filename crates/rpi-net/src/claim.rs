//! What a program claims of itself: assertions and contracts, as far as the net publishes whether they hold.
//!
//! A claim is an export of its own, and one for each flow that it reads. Whoever runs the net can watch them; nothing in
//! the net depends on them.

use rpi_diag::Span;

/// By whom a claim must hold.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ClaimKind {
    /// `assert`: it holds by the writer's word.
    Assert,
    /// `check`: it follows from the rest of the body.
    Check,
    /// `assume`: the caller sees to it.
    Assume,
    /// `guarantee`, and `ensure` of a mode: the body sees to it as long as the caller does its part.
    Guarantee,
    /// The caller keeps to some mode of the contract.
    Modes,
}

impl ClaimKind {
    /// Whether the rest of the program may rely on it.
    #[must_use]
    pub fn is_given(self) -> bool {
        matches!(self, ClaimKind::Assert | ClaimKind::Assume)
    }
}

/// A claim that a net publishes.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Claim {
    /// The export that says whether it holds; there is none if it holds in every cycle.
    pub key: String,
    /// By whom it must hold.
    pub kind: ClaimKind,
    /// Path of the call that it stands in; empty for what is run.
    pub path: String,
    /// The name of what it is claimed of.
    pub of: String,
    /// The mode of the contract whose `ensure` it is.
    pub mode: Option<String>,
    /// Its label, if it has one.
    pub label: Option<String>,
    /// Where it stands.
    pub span: Span,
    /// Whether it is about earlier cycles, too.
    pub looks_back: bool,
    /// Whether what it reads must have a value in every cycle. In Lustre it need not: a claim about the cycle before says nothing
    /// of the first one there.
    pub is_strict: bool,
    /// The flows that it reads.
    pub reads: Vec<ClaimRead>,
}

/// A flow that a claim reads.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ClaimRead {
    /// Its name where the claim stands.
    pub name: String,
    /// Its export.
    pub key: String,
    /// Its unit, `[m/s]`; empty if it has none.
    pub unit: String,
    /// The names of its values, if it is an enum.
    pub values: Vec<String>,
}
