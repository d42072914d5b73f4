//! Application of fixes to source texts.

use crate::{Applicability, Diagnostic, Edit, Fix};

/// Returns the sure fixes of the diagnostics that can be applied together, in the order of the diagnostics. Only the
/// first fix of a diagnostic is considered, and applied as a whole or not at all. A fix whose edits overlap those of an
/// earlier fix, or equal them, is skipped; a later run can apply it.
pub fn sure_fixes(diagnostics: &[Diagnostic]) -> Vec<&Fix> {
    let mut taken: Vec<&Fix> = Vec::new();
    let first = diagnostics
        .iter()
        .filter_map(|diagnostic| diagnostic.fixes.first());
    for fix in first.filter(|fix| fix.applicability == Applicability::Sure) {
        let mut edits = taken.iter().flat_map(|other| &other.edits);
        if edits.all(|edit| fix.edits.iter().all(|own| !overlap(own, edit))) {
            taken.push(fix);
        }
    }
    taken
}

/// Returns the edits of [`sure_fixes`] from the last location to the first, so that applying one edit does not move the
/// locations of the next.
pub fn sure_edits(diagnostics: &[Diagnostic]) -> Vec<Edit> {
    let fixes = sure_fixes(diagnostics);
    let mut edits: Vec<Edit> = fixes
        .iter()
        .flat_map(|fix| fix.edits.iter().cloned())
        .collect();
    sort_last_first(&mut edits);
    edits
}

/// Returns whether two edits change the same text or insert at the same location, so that their order would matter.
fn overlap(a: &Edit, b: &Edit) -> bool {
    let end = |edit: &Edit| edit.span.end.max(edit.span.start + 1);
    a.span.file == b.span.file && a.span.start < end(b) && b.span.start < end(a)
}

fn sort_last_first(edits: &mut [Edit]) {
    edits.sort_by_key(|edit| std::cmp::Reverse((edit.span.file, edit.span.start, edit.span.end)));
}

/// Returns `text` with the edits applied. The edits must not overlap. Inserted text gets the line ending of `text` (LF
/// or CRLF).
pub fn apply<'a>(text: &str, edits: impl Iterator<Item = &'a Edit>) -> String {
    let mut edits: Vec<Edit> = edits.cloned().collect();
    sort_last_first(&mut edits);
    let returns = text.contains("\r\n");
    let mut text = text.to_owned();
    for edit in edits {
        let new = match returns {
            true => edit.text.replace("\r\n", "\n").replace('\n', "\r\n"),
            false => edit.text,
        };
        text.replace_range(edit.span.start as usize..edit.span.end as usize, &new);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Code, FileId, Span};

    fn at(start: u32, end: u32) -> Span {
        Span::new(FileId(0), start, end)
    }

    fn diagnostic(fix: Fix) -> Diagnostic {
        Diagnostic::new(Code::RPI0001, "odd").fix(fix)
    }

    fn applied(text: &str, fixes: Vec<Fix>) -> String {
        let diagnostics: Vec<Diagnostic> = fixes.into_iter().map(diagnostic).collect();
        apply(text, sure_edits(&diagnostics).iter())
    }

    #[test]
    fn fixes_that_touch_are_taken_one_by_one_and_as_a_whole() {
        let around = Fix::sure("a")
            .insert_before(at(0, 3), "(")
            .insert_after(at(0, 3), ")");
        let inside = Fix::sure("b").replace(at(1, 2), "_").replace(at(5, 6), "!");
        assert_eq!(
            applied("abc def", vec![around.clone(), inside.clone()]),
            "(a_c) d!f"
        );
        let over = Fix::sure("c").replace(at(0, 2), "x").replace(at(6, 7), "y");
        assert_eq!(applied("abc def", vec![over, inside]), "xc dey");
        assert_eq!(applied("abc", vec![around.clone(), around]), "(abc)");
    }

    #[test]
    fn only_sure_ones_are_taken() {
        assert_eq!(
            applied("abc", vec![Fix::maybe("a").replace(at(0, 3), "x")]),
            "abc"
        );
    }

    #[test]
    fn lines_end_as_they_do_in_the_text() {
        let tel = || vec![Fix::sure("a").insert_after(at(0, 3), "\ntel")];
        assert_eq!(applied("let\r\n", tel()), "let\r\ntel\r\n");
        assert_eq!(applied("let\n", tel()), "let\ntel\n");
    }

    #[test]
    fn what_stands_before_is_not_moved_by_what_stands_behind() {
        let edits = [
            Edit {
                span: at(0, 1),
                text: "long".into(),
            },
            Edit {
                span: at(2, 3),
                text: String::new(),
            },
        ];
        assert_eq!(apply("a b c", edits.iter()), "long  c");
    }
}
