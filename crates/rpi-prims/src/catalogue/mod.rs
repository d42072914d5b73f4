//! The primitives, one file per family; [`SORTED`] is their table.

mod clock;
mod logic;
mod real;

use crate::registry::Prim;

/// The families. A new file is one line here.
const FAMILIES: &[&[Prim]] = &[clock::ALL, logic::ALL, real::ALL];

const COUNT: usize = {
    let (mut n, mut k) = (0, 0);
    while k < FAMILIES.len() {
        n += FAMILIES[k].len();
        k += 1;
    }
    n
};

/// All primitives, sorted by registered name at compile time; two of one name do not compile.
pub(crate) static SORTED: [Prim; COUNT] = sorted();

const fn sorted() -> [Prim; COUNT] {
    let mut all = [FAMILIES[0][0]; COUNT];
    let (mut n, mut k) = (0, 0);
    while k < FAMILIES.len() {
        let mut i = 0;
        while i < FAMILIES[k].len() {
            let mut at = n;
            while at > 0 && !before(all[at - 1].desc.name, FAMILIES[k][i].desc.name) {
                all[at] = all[at - 1];
                at -= 1;
            }
            all[at] = FAMILIES[k][i];
            n += 1;
            i += 1;
        }
        k += 1;
    }
    all
}

/// True if `a` sorts before `b`; equal names are refused.
const fn before(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut k = 0;
    while k < a.len() && k < b.len() {
        if a[k] != b[k] {
            return a[k] < b[k];
        }
        k += 1;
    }
    assert!(
        a.len() != b.len(),
        "two primitives have the same registered name"
    );
    a.len() < b.len()
}
