//! All primitives, one module per family. [`SORTED`] is the table.

mod base_control;
mod bits;
mod clock;
mod devices;
mod events;
pub(crate) mod frame;
pub(crate) mod frame_otg;
mod functions;
mod fused;
mod generic;
mod int;
mod interpolation;
mod io;
mod kuka_lwr;
mod linear_solver;
mod logic;
mod matrix;
mod matrix_blocks;
mod mobile_base;
mod moving_average;
pub(crate) mod otg;
mod real;
mod robot_arm;
mod rotation;
mod rotation_curves;
mod rpi_ops;
mod spatial_fallbacks;
mod time_alignment;
mod times;
mod twist;
mod vector;

use crate::registry::Prim;
use core::cmp::Ordering;

/// Primitives of each family, such as arithmetic or robot arms. A new module needs one line here.
const FAMILIES: &[&[Prim]] = &[
    robot_arm::ALL,
    moving_average::ALL,
    mobile_base::ALL,
    base_control::ALL,
    bits::ALL,
    matrix_blocks::ALL,
    clock::ALL,
    rotation_curves::ALL,
    events::ALL,
    frame::ALL,
    frame_otg::ALL,
    functions::ALL,
    fused::ALL,
    generic::boolean::ALL,
    generic::double::ALL,
    generic::frame::ALL,
    generic::int::ALL,
    generic::rotation::ALL,
    generic::time::ALL,
    generic::twist::ALL,
    generic::vector::ALL,
    generic::wrench::ALL,
    int::ALL,
    interpolation::ALL,
    io::ALL,
    logic::ALL,
    kuka_lwr::ALL,
    matrix::ALL,
    otg::ALL,
    rpi_ops::commands::ALL,
    rpi_ops::external::ALL,
    rpi_ops::guarded::ALL,
    rpi_ops::int::ALL,
    rpi_ops::machine_int::ALL,
    rpi_ops::logic::ALL,
    rpi_ops::motion::ALL,
    rpi_ops::path_event::ALL,
    rpi_ops::real::ALL,
    rpi_ops::spatial::ALL,
    rpi_ops::ticks::ALL,
    rpi_ops::per_type::boolean::ALL,
    rpi_ops::per_type::double::ALL,
    rpi_ops::per_type::frame::ALL,
    rpi_ops::per_type::int::ALL,
    rpi_ops::per_type::rotation::ALL,
    rpi_ops::per_type::time::ALL,
    rpi_ops::per_type::twist::ALL,
    rpi_ops::per_type::vector::ALL,
    rpi_ops::per_type::wrench::ALL,
    real::ALL,
    rotation::ALL,
    time_alignment::ALL,
    times::ALL,
    twist::ALL,
    vector::ALL,
];

const COUNT: usize = {
    let (mut n, mut k) = (0, 0);
    while k < FAMILIES.len() {
        n += FAMILIES[k].len();
        k += 1;
    }
    n
};

/// All primitives, sorted by registered name at compile time. Duplicate names are a compile error.
pub(crate) static SORTED: [Prim; COUNT] = sorted();

// A bottom-up merge sort written with loops, because `slice::sort` is not a `const fn`.
const fn sorted() -> [Prim; COUNT] {
    let (mut from, mut to) = (unsorted(), unsorted());
    let mut run = 1;
    while run < COUNT {
        let mut at = 0;
        while at < COUNT {
            to = merge_runs(&from, to, at, at + run, at + 2 * run);
            at += 2 * run;
        }
        (from, to) = (to, from);
        run *= 2;
    }
    from
}

/// Returns all primitives, unsorted, family by family.
const fn unsorted() -> [Prim; COUNT] {
    let mut all = [FAMILIES[0][0]; COUNT];
    let (mut n, mut k) = (0, 0);
    while k < FAMILIES.len() {
        let mut i = 0;
        while i < FAMILIES[k].len() {
            all[n] = FAMILIES[k][i];
            n += 1;
            i += 1;
        }
        k += 1;
    }
    all
}

/// Returns `to` with the sorted runs `from[a..b]` and `from[b..c]` merged into `to[a..c]`: one step of a merge sort.
/// `b` and `c` beyond the end of the table count as its end.
const fn merge_runs(
    from: &[Prim; COUNT],
    mut to: [Prim; COUNT],
    a: usize,
    b: usize,
    c: usize,
) -> [Prim; COUNT] {
    let (b, c) = (
        if b < COUNT { b } else { COUNT },
        if c < COUNT { c } else { COUNT },
    );
    let (mut left, mut right, mut at) = (a, b, a);
    while at < c {
        let take_left =
            right == c || (left < b && sorts_before(from[left].desc.name, from[right].desc.name));
        if take_left {
            to[at] = from[left];
            left += 1;
        } else {
            to[at] = from[right];
            right += 1;
        }
        at += 1;
    }
    to
}

/// Returns true if the name `a` sorts before `b`; panics (a compile error) for equal names.
const fn sorts_before(a: &str, b: &str) -> bool {
    let order = compare_names(a, b);
    assert!(
        !matches!(order, Ordering::Equal),
        "two primitives have the same registered name"
    );
    matches!(order, Ordering::Less)
}

/// Compares names byte by byte, in a constant expression.
pub(crate) const fn compare_names(a: &str, b: &str) -> Ordering {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut k = 0;
    while k < a.len() && k < b.len() {
        if a[k] != b[k] {
            return ordering(a[k] < b[k]);
        }
        k += 1;
    }
    match a.len() == b.len() {
        true => Ordering::Equal,
        false => ordering(a.len() < b.len()),
    }
}

const fn ordering(is_less: bool) -> Ordering {
    if is_less {
        Ordering::Less
    } else {
        Ordering::Greater
    }
}
