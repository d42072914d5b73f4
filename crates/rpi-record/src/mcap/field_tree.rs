//! Nested structure of the fields of a message.
//!
//! Viewers address a value by a path: a dot selects a member of an object, `[n]` an element of a list. The names of flows and
//! ports are such paths (`way.travelled`, `joint.commanded_position[3]`), so their messages are nested in the same way.

/// Tree of the fields of a message: objects and lists, with fields as leaves. It follows from the dots and indices in
/// the names of the fields.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum FieldTree {
    /// List element without a field, because no field has its index.
    Gap,
    /// Leaf: a field, by its index in the list of fields of the message.
    Field(usize),
    /// Object: names and subtrees of its members, in the order of their first field.
    Object(Vec<(String, FieldTree)>),
    /// List: subtrees of its elements, by index.
    List(Vec<FieldTree>),
}

/// Step on the path from the root of a message to a field: to a member of an object, or to an element of a list.
enum Step<'a> {
    Member(&'a str),
    Element(usize),
}

/// Name of the member with the value of a field whose name is also the path of an object or list, such as `a` if there
/// is also a field `a.b`.
const OWN_VALUE: &str = "value";

impl FieldTree {
    /// Builds the tree of a message from the names of its fields, such as `way.travelled` and `joint.position[3]`.
    pub(super) fn from_names<'n>(names: impl Iterator<Item = &'n str>) -> FieldTree {
        let mut root = FieldTree::Object(Vec::new());
        for (field, name) in names.enumerate() {
            let place = steps(name)
                .iter()
                .fold(&mut root, |node, step| node.child(step));
            place.put(field);
        }
        root
    }

    /// Returns the child node to which a step leads. The child is created if it does not exist.
    fn child(&mut self, step: &Step<'_>) -> &mut FieldTree {
        match step {
            Step::Member(name) => self.member(name),
            Step::Element(index) => self.element(*index),
        }
    }

    fn member(&mut self, name: &str) -> &mut FieldTree {
        self.become_object();
        let FieldTree::Object(members) = self else {
            unreachable!("the node was made an object above")
        };
        let known = members.iter().position(|(own, _)| own == name);
        let at = known.unwrap_or_else(|| {
            members.push((name.to_owned(), FieldTree::Gap));
            members.len() - 1
        });
        &mut members[at].1
    }

    fn element(&mut self, index: usize) -> &mut FieldTree {
        match self {
            FieldTree::Gap => *self = FieldTree::List(Vec::new()),
            FieldTree::List(_) => {}
            // An object cannot have elements: the element becomes a member.
            _ => return self.member(&index.to_string()),
        }
        let FieldTree::List(elements) = self else {
            unreachable!("the node is a list, as matched above")
        };
        if elements.len() <= index {
            elements.resize(index + 1, FieldTree::Gap);
        }
        &mut elements[index]
    }

    fn become_object(&mut self) {
        let members = match std::mem::replace(self, FieldTree::Gap) {
            FieldTree::Object(members) => members,
            FieldTree::Gap => Vec::new(),
            field @ FieldTree::Field(_) => vec![(OWN_VALUE.to_owned(), field)],
            FieldTree::List(elements) => {
                let numbered = elements.into_iter().enumerate();
                numbered.map(|(k, e)| (k.to_string(), e)).collect()
            }
        };
        *self = FieldTree::Object(members);
    }

    /// Makes this node the leaf for the field with this index. If the node is not empty, the field becomes its member
    /// [`OWN_VALUE`].
    fn put(&mut self, field: usize) {
        match self {
            FieldTree::Gap => *self = FieldTree::Field(field),
            _ => *self.member(OWN_VALUE) = FieldTree::Field(field),
        }
    }
}

/// Splits the name of a field into steps: `a.b[2]` is member `a`, member `b`, element 2.
fn steps(name: &str) -> Vec<Step<'_>> {
    let mut steps = Vec::new();
    for part in name.split('.') {
        let (member, indices) = split_indices(part);
        steps.push(Step::Member(member));
        steps.extend(indices.into_iter().map(Step::Element));
    }
    steps
}

/// Splits a part of a field name, such as `b[2][0]`, into the name `b` and its indices. A part with other brackets is
/// one name.
fn split_indices(part: &str) -> (&str, Vec<usize>) {
    /// Maximum index that becomes an element of a list; larger ones stay part of the name. The missing elements of a
    /// list are filled with `null`.
    const MAX_INDEX: usize = 4096;
    let Some(open) = part.find('[') else {
        return (part, Vec::new());
    };
    let (member, rest) = part.split_at(open);
    let inner = rest.strip_prefix('[').and_then(|r| r.strip_suffix(']'));
    let indices: Option<Vec<usize>> = inner.and_then(|inner| {
        let texts = inner.split("][");
        texts
            .map(|text| text.parse().ok().filter(|n| *n <= MAX_INDEX))
            .collect()
    });
    indices.map_or((part, Vec::new()), |indices| (member, indices))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree(names: &[&str]) -> FieldTree {
        FieldTree::from_names(names.iter().copied())
    }

    fn object(members: &[(&str, FieldTree)]) -> FieldTree {
        let members = members.iter();
        FieldTree::Object(members.map(|(n, t)| ((*n).to_owned(), t.clone())).collect())
    }

    #[test]
    fn dots_are_members_and_brackets_are_elements() {
        let lists = FieldTree::List(vec![
            FieldTree::Field(1),
            FieldTree::Gap,
            FieldTree::Field(0),
        ]);
        let joint = object(&[("position", lists)]);
        assert_eq!(
            tree(&["joint.position[2]", "joint.position[0]", "error"]),
            object(&[("joint", joint), ("error", FieldTree::Field(2))])
        );
    }

    #[test]
    fn a_value_beside_members_of_its_own_keeps_both() {
        let both = object(&[("value", FieldTree::Field(0)), ("b", FieldTree::Field(1))]);
        assert_eq!(tree(&["a", "a.b"]), object(&[("a", both)]));
        let both = object(&[("b", FieldTree::Field(0)), ("value", FieldTree::Field(1))]);
        assert_eq!(tree(&["a.b", "a"]), object(&[("a", both)]));
        let both = object(&[("0", FieldTree::Field(0)), ("b", FieldTree::Field(1))]);
        assert_eq!(tree(&["a[0]", "a.b"]), object(&[("a", both)]));
    }

    #[test]
    fn unusual_brackets_are_part_of_a_name() {
        for name in ["a[", "a[x]", "a[1", "a[99999999]", "]["] {
            assert_eq!(tree(&[name]), object(&[(name, FieldTree::Field(0))]));
        }
    }
}
