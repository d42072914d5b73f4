//! C code of primitives, for the translation of images to C.
//!
//! The declaration of each primitive has its C text beside its Rust code, so that a primitive without C does not
//! compile. Both compute the same bits, which the tests of `rpi-codegen` check for every primitive. The text is C99 that
//! is also C++17. It uses the functions of [`support`], but neither `math.h` nor the heap, and its expressions must not
//! depend on contraction or on the order of evaluation.
//!
//! Names in the text:
//!
//! | name | meaning |
//! |---|---|
//! | `inValue`, `Epsilon` | in-port or parameter: a value for `bool`, `int`, `real` and `Time`; else a pointer to reals |
//! | `outValue` | pointer to the out-port: to one value, or to the first of several reals or elements |
//! | `inValue_len`, `inValue_rows`, `inValue_cols` | sizes of an array or matrix, as `int32_t` |
//! | `inValue_present`, `outValue_present` | presence of an in-port; pointer to the presence of an out-port |
//! | `s0`, `s1` | pointers to the components of a state of fixed size |
//! | `ring`, `ring_len` | words of a state of computed size, and their number as `size_t` |
//! | `cx`, `at` | context and place for [`rpi_fault`](support) |
//! | `rpi_dt`, `rpi_tick_ns` | period in s and length of a tick in ns, as reals |
//!
//! The emitter replaces these calls according to the type of the port: `COPY(to, from)` copies a value, `GET(to, array,
//! index)` and `PUT(array, index, from)` one element, `SLICE(to, array, start)` all elements of `to`; `NEUTRAL(to)`
//! writes the neutral value, `LOAD(to, words)` and `STORE(words, from)` convert from and to 64-bit words, and
//! `SLOTS(port)` is the number of words of a value.

use rpi_image::Scalar;

/// C code of a primitive.
#[derive(Clone, Copy, Debug)]
pub struct CCode {
    /// Text of the code.
    pub form: CForm,
    /// Types of the components of a state of fixed size, in the order of their slots.
    pub state: &'static [Scalar],
}

/// Text of the C code of a primitive. The names that it uses are described [above](self).
#[derive(Clone, Copy, Debug)]
pub enum CForm {
    /// Expression for the single out-port of one slot. All ports are present.
    Value(&'static str),
    /// Body of a function that writes all out-ports and their presences.
    Code(&'static str),
    /// Expression for an out-port of one slot if all ports are present; else the body of a function.
    Both(&'static str, &'static str),
}

/// Returns the C functions that the code of primitives uses, elementary functions first: texts of definitions, each after a line
/// `/*# name */`.
pub fn support() -> impl Iterator<Item = &'static str> {
    rpi_math::C_SOURCES.iter().chain(SUPPORT).copied()
}

const SUPPORT: &[&str] = &[
    include_str!("c/real.c"),
    include_str!("c/integer.c"),
    include_str!("c/history.c"),
    include_str!("c/geometry.c"),
    include_str!("c/digits.c"),
];
