//! Reading and writing typed values through operand words.
//!
//! A step's operands are cell numbers. A present-for-sure port takes one word (its first cell); a port that may be
//! absent takes two (first cell, presence cell). Arrays take one word more for their length.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rpi_image::Scalar;

/// A value type of the language as Rust sees it.
pub trait Flow: Copy {
    /// Its type.
    const SCALAR: Scalar;
    /// Number of cells.
    const CELLS: usize = Self::SCALAR.cells() as usize;
    /// Reads it from `cells[at..]`.
    fn load(cells: &[u64], at: usize) -> Self;
    /// Writes it to `cells[at..]`.
    fn store(self, cells: &mut [u64], at: usize);
    /// False, zero, identity.
    fn neutral() -> Self;
}

/// Point in time, nanoseconds since the Unix epoch.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub struct Time(pub i64);
/// Position or direction, metres where it is a position.
pub type Vector = Vector3<f64>;
/// Unit quaternion.
pub type Rotation = UnitQuaternion<f64>;
/// Position and orientation of one frame in another.
pub type Pose = Isometry3<f64>;

/// Velocity of a frame: linear (m/s) and angular (rad/s).
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Twist {
    /// Linear velocity, m/s.
    pub linear: Vector,
    /// Angular velocity, rad/s.
    pub angular: Vector,
}

/// Force (N) and torque (N m).
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Wrench {
    /// Force, N.
    pub force: Vector,
    /// Torque, N m.
    pub torque: Vector,
}

impl Flow for bool {
    const SCALAR: Scalar = Scalar::Bool;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        cells[at] != 0
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        cells[at] = u64::from(self);
    }
    #[inline(always)]
    fn neutral() -> Self {
        false
    }
}

impl Flow for i64 {
    const SCALAR: Scalar = Scalar::Int;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        cells[at].cast_signed()
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        cells[at] = self.cast_unsigned();
    }
    #[inline(always)]
    fn neutral() -> Self {
        0
    }
}

impl Flow for f64 {
    const SCALAR: Scalar = Scalar::Real;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        f64::from_bits(cells[at])
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        cells[at] = self.to_bits();
    }
    #[inline(always)]
    fn neutral() -> Self {
        0.0
    }
}

impl Flow for Time {
    const SCALAR: Scalar = Scalar::Time;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Time(i64::load(cells, at))
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.0.store(cells, at);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Time(0)
    }
}

impl Flow for Vector {
    const SCALAR: Scalar = Scalar::Vector;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Vector::new(
            f64::load(cells, at),
            f64::load(cells, at + 1),
            f64::load(cells, at + 2),
        )
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.x.store(cells, at);
        self.y.store(cells, at + 1);
        self.z.store(cells, at + 2);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Vector::zeros()
    }
}

impl Flow for Rotation {
    const SCALAR: Scalar = Scalar::Rotation;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        let part = |k| f64::load(cells, at + k);
        UnitQuaternion::new_unchecked(Quaternion::new(part(3), part(0), part(1), part(2)))
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        for (k, part) in [self.i, self.j, self.k, self.w].into_iter().enumerate() {
            part.store(cells, at + k);
        }
    }
    #[inline(always)]
    fn neutral() -> Self {
        Rotation::identity()
    }
}

impl Flow for Pose {
    const SCALAR: Scalar = Scalar::Pose;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Isometry3::from_parts(
            Translation3::from(Vector::load(cells, at)),
            Rotation::load(cells, at + 3),
        )
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.translation.vector.store(cells, at);
        self.rotation.store(cells, at + 3);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Pose::identity()
    }
}

impl Flow for Twist {
    const SCALAR: Scalar = Scalar::Twist;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Twist {
            linear: Vector::load(cells, at),
            angular: Vector::load(cells, at + 3),
        }
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.linear.store(cells, at);
        self.angular.store(cells, at + 3);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Twist::default()
    }
}

impl Flow for Wrench {
    const SCALAR: Scalar = Scalar::Wrench;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Wrench {
            force: Vector::load(cells, at),
            torque: Vector::load(cells, at + 3),
        }
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.force.store(cells, at);
        self.torque.store(cells, at + 3);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Wrench::default()
    }
}

/// Something that is read from or written to through operand words: a port, or a tuple of ports.
pub trait Operand: Sized {
    /// Number of operand words.
    const WORDS: usize;
    /// Reads it; `words` starts at its first word.
    fn get(cells: &[u64], words: &[u32]) -> Self;
    /// Writes it; `words` starts at its first word.
    fn put(self, cells: &mut [u64], words: &[u32]);
}

macro_rules! sure_ports {
    ($($t:ty),*) => { $(
        /// A port that is present for sure.
        impl Operand for $t {
            const WORDS: usize = 1;
            #[inline(always)]
            fn get(cells: &[u64], words: &[u32]) -> Self {
                Self::load(cells, words[0] as usize)
            }
            #[inline(always)]
            fn put(self, cells: &mut [u64], words: &[u32]) {
                self.store(cells, words[0] as usize);
            }
        }
    )* };
}

sure_ports!(bool, i64, f64, Time, Vector, Rotation, Pose, Twist, Wrench);

/// Ports that are present for sure, and the same ports when they may be absent.
pub trait Row: Operand {
    /// The ports as options.
    type Maybe: Operand;
    /// All present.
    fn present(self) -> Self::Maybe;
    /// The values; a neutral one where a value is missing against the primitive's promise.
    fn expect(maybe: Self::Maybe) -> Self;
}

/// A port that may be absent. Absent outputs leave their value cells as they were.
impl<T: Flow> Operand for Option<T> {
    const WORDS: usize = 2;
    #[inline(always)]
    fn get(cells: &[u64], words: &[u32]) -> Self {
        (cells[words[1] as usize] != 0).then(|| T::load(cells, words[0] as usize))
    }
    #[inline(always)]
    fn put(self, cells: &mut [u64], words: &[u32]) {
        cells[words[1] as usize] = u64::from(self.is_some());
        if let Some(value) = self {
            value.store(cells, words[0] as usize);
        }
    }
}

macro_rules! tuples {
    ($(($($t:ident . $i:tt),*))*) => { $(
        impl<$($t: Operand),*> Operand for ($($t,)*) {
            const WORDS: usize = 0 $(+ $t::WORDS)*;
            #[inline(always)]
            #[allow(unused_variables, unused_mut, unused_assignments, clippy::unused_unit)]
            fn get(cells: &[u64], words: &[u32]) -> Self {
                let mut at = 0;
                ($({ let v = $t::get(cells, &words[at..]); at += $t::WORDS; v },)*)
            }
            #[inline(always)]
            #[allow(unused_variables, unused_mut, unused_assignments)]
            fn put(self, cells: &mut [u64], words: &[u32]) {
                let mut at = 0;
                $( self.$i.put(cells, &words[at..]); at += $t::WORDS; )*
            }
        }
        impl<$($t: Flow + Operand),*> Row for ($($t,)*) {
            type Maybe = ($(Option<$t>,)*);
            #[inline(always)]
            #[allow(clippy::unused_unit)]
            fn present(self) -> Self::Maybe {
                ($(Some(self.$i),)*)
            }
            #[inline(always)]
            #[allow(unused_variables, clippy::unused_unit)]
            fn expect(maybe: Self::Maybe) -> Self {
                ($(maybe.$i.unwrap_or_else($t::neutral),)*)
            }
        }
        /// A tuple of flows kept side by side: a primitive's state.
        impl<$($t: Flow),*> Memory for ($($t,)*) {
            const CELLS: u32 = 0 $(+ $t::SCALAR.cells())*;
            #[inline(always)]
            #[allow(unused_variables, unused_mut, unused_assignments, clippy::unused_unit)]
            fn load(cells: &[u64], at: usize) -> Self {
                let mut at = at;
                ($({ let v = $t::load(cells, at); at += $t::CELLS; v },)*)
            }
            #[inline(always)]
            #[allow(unused_variables, unused_mut, unused_assignments)]
            fn store(self, cells: &mut [u64], at: usize) {
                let mut at = at;
                $( self.$i.store(cells, at); at += $t::CELLS; )*
            }
        }
    )* };
}

/// State of fixed size: a tuple of flows.
pub trait Memory: Sized {
    /// Number of cells.
    const CELLS: u32;
    /// Reads it from `cells[at..]`.
    fn load(cells: &[u64], at: usize) -> Self;
    /// Writes it to `cells[at..]`.
    fn store(self, cells: &mut [u64], at: usize);
}

tuples! {
    ()
    (A.0)
    (A.0, B.1)
    (A.0, B.1, C.2)
    (A.0, B.1, C.2, D.3)
    (A.0, B.1, C.2, D.3, E.4)
    (A.0, B.1, C.2, D.3, E.4, F.5)
    (A.0, B.1, C.2, D.3, E.4, F.5, G.6)
    (A.0, B.1, C.2, D.3, E.4, F.5, G.6, H.7)
    (A.0, B.1, C.2, D.3, E.4, F.5, G.6, H.7, I.8)
    (A.0, B.1, C.2, D.3, E.4, F.5, G.6, H.7, I.8, J.9)
}
