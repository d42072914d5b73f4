//! Claims: assertions and contracts of a program, as far as the net publishes whether they hold.
//!
//! A claim is an export, with a further export for each flow that it reads. Monitors of a running net can observe them;
//! no node of the net depends on them.

use rpi_diag::Span;

/// Kind of a claim. It decides who must ensure that the claimed condition holds.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ClaimKind {
    /// `assert`: assumed to hold without proof.
    Assert,
    /// `check`: to be proved from the rest of the body.
    Check,
    /// `assume`: ensured by the caller.
    Assume,
    /// `guarantee`, or `ensure` of a mode: ensured by the body as long as the caller's assumptions hold.
    Guarantee,
    /// The modes of a contract are complete: in every cycle the caller satisfies the `require` clauses of at least one
    /// mode.
    ModeCompleteness,
}

impl ClaimKind {
    /// Returns whether the rest of the program may rely on the claim without proof.
    #[must_use]
    pub fn is_assumed(self) -> bool {
        matches!(self, ClaimKind::Assert | ClaimKind::Assume)
    }
}

/// Claim of a program (assertion, property or contract clause) that a net publishes, so that tests and model checkers
/// can observe it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Claim {
    /// Key of the Boolean export that is true while the claim holds. A claim that always holds has no such export.
    pub key: String,
    /// Whether the claim is an assertion, a property, an assumption, a guarantee or the completeness of modes.
    pub kind: ClaimKind,
    /// Path of the call that contains the claim; empty for the node or command that is run itself.
    pub path: String,
    /// Name of the node, fragment or command that states the claim.
    pub subject: String,
    /// Name of the mode, for a claim from the `ensure` clause of a mode; `None` for other claims.
    pub mode: Option<String>,
    /// Name that the program gives to the claim, a string in quotes; `None` without a name.
    pub label: Option<String>,
    /// Location of the claim in the source text.
    pub span: Span,
    /// Whether the claim depends on values of earlier cycles.
    pub reads_past: bool,
    /// Whether all flows that the claim reads must have a value in every cycle. They need not in Lustre, where a claim
    /// about the previous cycle holds trivially in the first cycle.
    pub is_strict: bool,
    /// Flows that occur in the claim.
    pub reads: Vec<ClaimRead>,
}

/// Flow that occurs in a claim.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ClaimRead {
    /// Name of the flow in the node that states the claim.
    pub name: String,
    /// Key under which the flow is exported.
    pub key: String,
    /// Unit of the flow in brackets, such as `[m/s]`; empty if it has none.
    pub unit: String,
    /// Names of the values if the flow has an enum type, in declaration order; empty for other types.
    pub values: Vec<String>,
}
