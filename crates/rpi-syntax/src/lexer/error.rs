//! Errors of the lexer, with the kind that decides which other errors follow from them.

use rpi_diag::Diagnostic;

/// Kind of an error of the lexer. The parser decides by the kind, never by the code or text, what to report.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum LexicalErrorKind {
    /// Characters that form no token.
    UnknownChars,
    /// Comment or string without its end.
    Unclosed,
    /// Operator, literal or comment marker of another language.
    ForeignSyntax,
    /// Argument named with an operator of another language: `f(a := x)`.
    NamedArgument,
    /// Any other error: a number outside of its range or with a suffix, an unsupported contract, a text that is too
    /// long.
    Other,
}

impl LexicalErrorKind {
    /// Returns whether a reported statement of another language explains an error of this kind within it.
    pub(crate) fn is_explained_by_foreign_statement(self) -> bool {
        match self {
            Self::UnknownChars | Self::ForeignSyntax | Self::NamedArgument => true,
            Self::Unclosed | Self::Other => false,
        }
    }

    /// Returns whether the text with the error is missing from the tokens.
    pub(crate) fn leaves_gap(self) -> bool {
        match self {
            Self::UnknownChars | Self::Unclosed => true,
            Self::ForeignSyntax | Self::NamedArgument | Self::Other => false,
        }
    }
}

/// Characters that form no token, with the diagnostic for them.
#[derive(Clone, Debug)]
pub(crate) struct LexicalError {
    pub(crate) kind: LexicalErrorKind,
    pub(crate) diagnostic: Diagnostic,
}
