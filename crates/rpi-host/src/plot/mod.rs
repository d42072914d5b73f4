//! A picture of a run as one SVG file: paths in space, values over time, and which command ran when.
//!
//! Drawn from plain numbers; nothing here knows a device, a net or a file.

mod axis;
mod chart;
mod draw;
mod frame;
mod palette;
mod path_view;
mod simplify;
mod svg;
mod timeline;

pub use draw::draw;

/// What there is to draw.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Picture {
    /// Heading.
    pub title: String,
    /// Ways through space, one per arm.
    pub paths: Vec<SpacePath>,
    /// Values over time, one chart each.
    pub charts: Vec<Chart>,
    /// The commands in order of their start.
    pub spells: Vec<Spell>,
}

/// The way of a point through space.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SpacePath {
    /// Whose way it is.
    pub name: String,
    /// Seconds and position (metres) of each sample.
    pub points: Vec<(f64, [f64; 3])>,
}

/// Values that share an axis.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Chart {
    /// What is shown, with its unit.
    pub title: String,
    /// The lines.
    pub lines: Vec<Line>,
}

/// A value over time.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Line {
    /// Its name.
    pub name: String,
    /// Seconds and value of each sample.
    pub points: Vec<(f64, f64)>,
}

/// The time in which a command ran.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Spell {
    /// Its name.
    pub command: String,
    /// First cycle, seconds.
    pub from: f64,
    /// End of the last cycle, seconds.
    pub to: f64,
    /// How it ended, in a word.
    pub end: String,
}
