//! Values of a cycle that only one function uses. They become local variables of this function, because C compilers keep
//! local variables in registers, but not the fields of a struct whose address other functions get.

use crate::identifiers::tokens;
use crate::statements::{declarator, zero};
use crate::variables::Variable;
use std::collections::{BTreeMap, BTreeSet};

/// Names of the values that the text of a function reads or writes as fields of the struct.
fn fields(text: &str) -> BTreeSet<&str> {
    let parts = tokens(text);
    let triples = parts.windows(3);
    let fields = triples.filter(|t| t[0] == "v" && t[1] == "->");
    fields.map(|t| t[2]).collect()
}

/// Makes values that only one of the functions uses local variables of it. `main` is the text of the function that calls
/// the others. Returns the names of the values that are fields no longer.
pub(crate) fn localise(
    bodies: &mut [String],
    main: &str,
    variables: &[&Variable],
) -> BTreeSet<String> {
    let mut users: BTreeMap<&str, Option<usize>> = BTreeMap::new();
    for name in fields(main) {
        users.insert(name, None);
    }
    for (k, body) in bodies.iter().enumerate() {
        for name in fields(body) {
            let user = users.entry(name).or_insert(Some(k));
            *user = user.filter(|own| *own == k);
        }
    }
    let mut local: BTreeMap<usize, BTreeSet<String>> = BTreeMap::new();
    for (name, user) in users {
        if let Some(k) = user {
            local.entry(k).or_default().insert(name.to_owned());
        }
    }
    for (k, names) in &local {
        bodies[*k] = with_locals(&bodies[*k], names, variables);
    }
    local.into_values().flatten().collect()
}

/// Returns the text of a function in which the values with these names are local variables.
fn with_locals(body: &str, names: &BTreeSet<String>, variables: &[&Variable]) -> String {
    let declared = variables.iter().filter(|v| names.contains(&v.name));
    let mut out: String = declared
        .map(|v| {
            let declared = declarator(v.ty, &v.name, v.slots.len);
            format!("  {declared} = {};\n", zero(v))
        })
        .collect();
    let parts = tokens(body);
    let is_local = |k: usize| {
        parts.get(k + 1) == Some(&"->")
            && parts.get(k + 2).is_some_and(|name| names.contains(*name))
    };
    let mut k = 0;
    while let Some(part) = parts.get(k) {
        if *part == "v" && is_local(k) {
            k += 2;
            continue;
        }
        out.push_str(part);
        k += 1;
    }
    out
}
