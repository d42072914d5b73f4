//! Candidates of a completion, their order, and the limits of an answer.

use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionList, CompletionTextEdit, InsertTextFormat,
    Range, TextEdit,
};
use serde_json::{Value, json};

/// Maximum number of items in an answer.
const MAX_ITEMS: usize = 200;

/// Maximum size of the items of an answer in bytes of JSON.
const MAX_BYTES: usize = 60_000;

/// Maximum length of the text beside a name, in characters. The documentation has the full text.
const MAX_DETAIL: usize = 60;

/// Group of candidates. The groups are listed in this order, so that the names declared nearest to the cursor come
/// first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Group {
    Argument,
    Local,
    Declared,
    Builtin,
    Keyword,
    Library,
    Primitive,
}

/// Name that completion can suggest.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) label: String,
    pub(super) kind: CompletionItemKind,
    pub(super) group: Group,
    /// Type or kind of the name, shown beside it; empty if there is none.
    pub(super) detail: String,
    /// Type of the value of the name, without `?`; empty if it is unknown. Candidates of the expected type come first.
    pub(super) ty: String,
    /// True if the name is expected whatever its type, such as a static parameter.
    pub(super) is_expected: bool,
    /// Text that is inserted instead of the label.
    pub(super) text: Option<String>,
    /// True if the inserted text has places for the cursor in the syntax of snippets.
    pub(super) is_snippet: bool,
    /// Edit elsewhere in the document, such as the `use` of a module.
    pub(super) edit: Option<TextEdit>,
    /// Data for the later request of the documentation.
    pub(super) data: Value,
}

impl Candidate {
    pub(super) fn new(group: Group, label: &str, kind: CompletionItemKind) -> Candidate {
        Candidate {
            label: label.to_owned(),
            kind,
            group,
            detail: String::new(),
            ty: String::new(),
            is_expected: false,
            text: None,
            is_snippet: false,
            edit: None,
            data: Value::Null,
        }
    }

    pub(super) fn with_detail(self, detail: &str) -> Candidate {
        let detail = detail.split_whitespace().collect::<Vec<_>>().join(" ");
        let cut = detail.char_indices().nth(MAX_DETAIL);
        let detail = match cut {
            Some((at, _)) => format!("{}\u{2026}", &detail[..at]),
            None => detail,
        };
        Candidate { detail, ..self }
    }

    pub(super) fn with_text(self, text: String) -> Candidate {
        Candidate {
            text: Some(text),
            ..self
        }
    }

    pub(super) fn with_snippet(self, snippet: String) -> Candidate {
        Candidate {
            text: Some(snippet),
            is_snippet: true,
            ..self
        }
    }

    /// Sets the data for the later request of the documentation: the kind of the name and what identifies it.
    pub(super) fn with_data(self, kind: &str, key: impl Into<Value>) -> Candidate {
        Candidate {
            data: json!([kind, key.into()]),
            ..self
        }
    }

    fn into_item(self, range: Range, order: usize) -> CompletionItem {
        let text = self.text.unwrap_or_else(|| self.label.clone());
        CompletionItem {
            kind: Some(self.kind),
            detail: (!self.detail.is_empty()).then_some(self.detail),
            sort_text: Some(format!("{order:03}")),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(range, text))),
            insert_text_format: self.is_snippet.then_some(InsertTextFormat::SNIPPET),
            additional_text_edits: self.edit.map(|edit| vec![edit]),
            data: (!self.data.is_null()).then_some(self.data),
            label: self.label,
            ..CompletionItem::default()
        }
    }
}

/// Returns how well a name matches the typed text, 0 for the best match: a prefix, a prefix in another case, the start of
/// a later word of the name, the initials of its words (`sl` for `speed_limit`). Returns `None` for no match: letters in
/// the middle of words match too many names.
fn match_quality(label: &str, typed: &str) -> Option<u8> {
    if label.starts_with(typed) {
        return Some(0);
    }
    let lower = typed.to_lowercase();
    if label.to_lowercase().starts_with(&lower) {
        return Some(1);
    }
    let starts = word_starts(label);
    let follows = |at: &usize| label[*at..].to_lowercase().starts_with(&lower);
    if starts.iter().any(follows) {
        return Some(2);
    }
    let initials: String = starts
        .iter()
        .filter_map(|at| label[*at..].chars().next())
        .collect();
    let matches_initials = lower.len() > 1 && initials.to_lowercase().starts_with(&lower);
    matches_initials.then_some(3)
}

/// Returns the byte offsets at which the words of a name start: `speed_limit`, `PointToPoint`, `Core::DoubleAdd`.
fn word_starts(label: &str) -> Vec<usize> {
    let mut previous = '_';
    let mut starts = Vec::new();
    for (at, c) in label.char_indices() {
        let is_start = matches!(previous, '_' | ':') || c.is_uppercase() && previous.is_lowercase();
        if is_start && c.is_alphanumeric() {
            starts.push(at);
        }
        previous = c;
    }
    starts
}

/// Returns the list of the candidates that match the typed text, best first, within the limits. The list is marked as
/// incomplete if the limits cut it, or if `has_more` is true.
pub(super) fn list(
    candidates: Vec<Candidate>,
    typed: &str,
    expected: Option<&str>,
    range: Range,
    has_more: bool,
) -> CompletionList {
    let fits = |one: &Candidate| {
        one.is_expected || expected.is_some_and(|ty| !one.ty.is_empty() && one.ty == ty)
    };
    let matching = candidates
        .into_iter()
        .enumerate()
        .filter_map(|(order, one)| {
            let quality = match_quality(&one.label, typed)?;
            // The order of declaration helps among locals, and the alphabet among the many others.
            let name = match one.group {
                Group::Argument | Group::Local => String::new(),
                _ => one.label.to_lowercase(),
            };
            Some(((quality, !fits(&one), one.group, name, order), one))
        });
    let mut matching: Vec<_> = matching.collect();
    matching.sort_by(|(a, _), (b, _)| a.cmp(b));
    let all = matching.len();
    let mut items = Vec::new();
    let mut size = 0;
    for (order, (_, one)) in matching.into_iter().enumerate().take(MAX_ITEMS) {
        let item = one.into_item(range, order);
        size += serde_json::to_string(&item).map_or(0, |text| text.len() + 1);
        if size > MAX_BYTES {
            break;
        }
        items.push(item);
    }
    CompletionList {
        is_incomplete: has_more || items.len() < all,
        items,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn better_matches_have_a_lower_number() {
        let quality = |typed| match_quality("speed_limit", typed);
        assert_eq!(quality("spe"), Some(0));
        assert_eq!(quality("Spe"), Some(1));
        assert_eq!(quality("limit"), Some(2));
        assert_eq!(quality("sl"), Some(3));
        assert_eq!(quality("ls"), None);
        assert_eq!(quality("p"), None);
        assert_eq!(match_quality("Core::DoubleAdd", "add"), Some(2));
        assert_eq!(quality(""), Some(0));
    }

    #[test]
    fn an_answer_has_bounded_size_and_says_whether_it_is_complete() {
        let one = |k: usize| {
            let label = format!("name_{k}");
            Candidate::new(Group::Declared, &label, CompletionItemKind::VARIABLE)
                .with_detail(&"long ".repeat(100))
        };
        let all: Vec<Candidate> = (0..1000).map(one).collect();
        let cut = list(all.clone(), "", None, Range::default(), false);
        assert!(cut.is_incomplete && cut.items.len() <= MAX_ITEMS);
        assert!(serde_json::to_string(&cut).unwrap().len() < 1 << 16);
        let few = list(all, "name_999", None, Range::default(), false);
        assert!(!few.is_incomplete);
        assert_eq!(few.items.len(), 1);
    }
}
