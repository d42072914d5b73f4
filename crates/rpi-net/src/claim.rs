//! Claims: assertions and contracts of a program, as far as the net publishes whether they hold.
//!
//! A claim is an export, with a further export for each flow that it reads. Monitors of a running net can observe them;
//! no node of the net depends on them.

use rpi_diag::Span;

/// Kind of a claim, which decides who must ensure it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ClaimKind {
    /// `assert`: assumed to hold without proof.
    Assert,
    /// `check`: must follow from the rest of the body.
    Check,
    /// `assume`: ensured by the caller.
    Assume,
    /// `guarantee`, or `ensure` of a mode: ensured by the body as long as the caller's assumptions hold.
    Guarantee,
    /// Claim that the modes of a contract are complete: in every cycle the caller satisfies the `require` of at least
    /// one mode.
    ModeCompleteness,
}

impl ClaimKind {
    /// Whether the rest of the program may rely on the claim.
    #[must_use]
    pub fn is_assumed(self) -> bool {
        matches!(self, ClaimKind::Assert | ClaimKind::Assume)
    }
}

/// Claim (assertion or contract clause) that a net publishes, so that tests and model checkers can observe it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Claim {
    /// Key of the Boolean export of the claim. A claim that always holds has no such export.
    pub key: String,
    /// Whether the claim is an assertion, a property, an assumption, a guarantee or the completeness of modes.
    pub kind: ClaimKind,
    /// Path of the call that contains the claim; empty for the unit that is run.
    pub path: String,
    /// Name of the unit whose claim this is.
    pub subject: String,
    /// Mode of the contract, for the `ensure` of a mode.
    pub mode: Option<String>,
    /// Label of the claim, if it has one.
    pub label: Option<String>,
    /// Location of the claim in the source text.
    pub span: Span,
    /// Whether the claim also reads values of earlier cycles.
    pub reads_past: bool,
    /// Whether all flows that the claim reads must have a value in every cycle. In Lustre they need not: there, a claim
    /// about the previous cycle is vacuous in the first cycle.
    pub is_strict: bool,
    /// Flows that the claim reads.
    pub reads: Vec<ClaimRead>,
}

/// Flow that a claim reads.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ClaimRead {
    /// Name of the flow in the scope of the claim.
    pub name: String,
    /// Key of the flow's export.
    pub key: String,
    /// Unit of the flow, `[m/s]`; empty if it has none.
    pub unit: String,
    /// Names of the enum's values; empty for other types.
    pub values: Vec<String>,
}
