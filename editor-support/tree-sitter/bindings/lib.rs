//! Grammar of the `.rpi` language and of Lustre for tree-sitter.

use tree_sitter_language::LanguageFn;

unsafe extern "C" {
    /// The generated parser.
    fn tree_sitter_rpi() -> *const ();
}

/// Grammar for `tree_sitter::Parser::set_language`.
// The function is generated for exactly this purpose: it returns a pointer to constant tables.
pub const LANGUAGE: LanguageFn = unsafe { LanguageFn::from_raw(tree_sitter_rpi) };

/// Query for syntax highlighting.
pub const HIGHLIGHTS: &str = include_str!("../queries/highlights.scm");
/// Query for scopes and declarations.
pub const LOCALS: &str = include_str!("../queries/locals.scm");
/// Query for the declarations of a file.
pub const TAGS: &str = include_str!("../queries/tags.scm");
/// Query for texts in other languages.
pub const INJECTIONS: &str = include_str!("../queries/injections.scm");
/// Query for ranges that can be folded.
pub const FOLDS: &str = include_str!("../queries/folds.scm");
/// Query for the indentation of lines.
pub const INDENTS: &str = include_str!("../queries/indents.scm");
