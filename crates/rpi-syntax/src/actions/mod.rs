//! Actions of the grammar: functions that build the nodes of the syntax tree, with one module per kind of node.

pub(crate) mod blocks;
pub(crate) mod bodies;
pub(crate) mod calls;
pub(crate) mod contracts;
pub(crate) mod declarations;
pub(crate) mod exprs;
pub(crate) mod tasks;
pub(crate) mod types;

/// Returns the list with one more element.
pub(crate) fn with_element<T>(mut list: Vec<T>, element: T) -> Vec<T> {
    list.push(element);
    list
}

/// Returns `list` followed by the elements of `more`.
pub(crate) fn with_elements<T>(mut list: Vec<T>, more: impl IntoIterator<Item = T>) -> Vec<T> {
    list.extend(more);
    list
}
