//! Errors of the lexer, with the kind that decides which other errors follow from them.

use rpi_diag::Diagnostic;

/// Kind of an error of the lexer. The parser decides by the kind, and not by code or text of the diagnostic, whether to
/// report the error.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum LexicalErrorKind {
    /// Characters that form no token.
    UnknownChars,
    /// Comment or string without its end.
    Unclosed,
    /// Operator, literal or comment marker of another language.
    ForeignSyntax,
    /// Argument that is named with an operator of another language: `f(a := x)`.
    NamedArgument,
    /// Any other error: a number that is out of range or has a suffix, an unsupported contract, or a text that is too
    /// long.
    Other,
}

impl LexicalErrorKind {
    /// Returns whether an error of this kind within a reported statement of another language needs no diagnostic of its
    /// own.
    pub(crate) fn is_explained_by_foreign_statement(self) -> bool {
        match self {
            Self::UnknownChars | Self::ForeignSyntax | Self::NamedArgument => true,
            Self::Unclosed | Self::Other => false,
        }
    }

    /// Returns whether the characters with an error of this kind are missing from the tokens.
    pub(crate) fn leaves_gap(self) -> bool {
        match self {
            Self::UnknownChars | Self::Unclosed => true,
            Self::ForeignSyntax | Self::NamedArgument | Self::Other => false,
        }
    }
}

/// Error of the lexer: its kind and its diagnostic.
#[derive(Clone, Debug)]
pub(crate) struct LexicalError {
    pub(crate) kind: LexicalErrorKind,
    pub(crate) diagnostic: Diagnostic,
}
