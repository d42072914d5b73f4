//! Application of the edits of the protocol to texts.

use serde_json::Value;

/// Returns the byte offset of a position in UTF-16 units.
pub(crate) fn offset_of(text: &str, position: &Value) -> usize {
    let line = position["line"].as_u64().unwrap() as usize;
    let mut left = position["character"].as_u64().unwrap() as usize;
    let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    for (at, c) in text[start..].char_indices() {
        if left == 0 {
            return start + at;
        }
        left -= c.len_utf16();
    }
    text.len()
}

/// Returns a text after edits, which must not overlap.
pub(crate) fn apply(text: &str, edits: &[Value]) -> String {
    let range = |edit: &Value| {
        let start = offset_of(text, &edit["range"]["start"]);
        start..offset_of(text, &edit["range"]["end"])
    };
    let mut edits: Vec<(std::ops::Range<usize>, &str)> = edits
        .iter()
        .map(|edit| (range(edit), edit["newText"].as_str().unwrap()))
        .collect();
    edits.sort_by_key(|(range, _)| std::cmp::Reverse((range.start, range.end)));
    let mut out = text.to_owned();
    for (range, new) in edits {
        out.replace_range(range, new);
    }
    out
}

/// Returns the edits of a workspace edit, by URI.
pub(crate) fn changes(edit: &Value) -> Vec<(String, Vec<Value>)> {
    let files = edit["changes"].as_object().cloned().unwrap_or_default();
    let edits = |list: &Value| list.as_array().cloned().unwrap_or_default();
    files
        .iter()
        .map(|(uri, list)| (uri.clone(), edits(list)))
        .collect()
}
