//! Types of the flows in random programs.

/// Type without presence.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    Bool,
    Int,
    Real,
    Length,
    Time,
    Speed,
    Area,
    Mode,
    Point,
    Ints,
    Reals,
}

pub(crate) const KINDS: &[Kind] = &[
    Kind::Bool,
    Kind::Int,
    Kind::Real,
    Kind::Length,
    Kind::Time,
    Kind::Speed,
    Kind::Area,
    Kind::Mode,
    Kind::Point,
    Kind::Ints,
    Kind::Reals,
];

/// Type and presence of a flow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Ty {
    pub(crate) kind: Kind,
    pub(crate) optional: bool,
    /// Whether it is on a clock.
    pub(crate) ticking: bool,
}

impl Kind {
    pub(crate) fn total(self) -> Ty {
        Ty {
            kind: self,
            optional: false,
            ticking: false,
        }
    }

    pub(crate) fn optional(self) -> Ty {
        Ty {
            kind: self,
            optional: true,
            ticking: false,
        }
    }

    /// Returns the type as written in a program.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Kind::Bool => "bool",
            Kind::Int => "int",
            Kind::Real => "real",
            Kind::Length => "real[m]",
            Kind::Time => "real[s]",
            Kind::Speed => "real[m/s]",
            Kind::Area => "real[m^2]",
            Kind::Mode => "Mode",
            Kind::Point => "Point",
            Kind::Ints => "int^3",
            Kind::Reals => "real^3",
        }
    }

    /// Returns whether it is a single value that can be sampled and delayed in one memory slot.
    pub(crate) fn is_scalar(self) -> bool {
        !matches!(self, Kind::Point | Kind::Ints | Kind::Reals)
    }
}

/// Type declarations used by all random programs.
pub(crate) const PRELUDE: &str = "type Mode = enum { Off, Slow, Fast };\n\
    type Point = struct { x: real; n: int };\n";
