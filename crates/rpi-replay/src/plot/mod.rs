//! Plot of a run as one SVG file: paths in space, values over time, and a timeline of the commands.
//!
//! The input is plain numbers. This module must not depend on devices, nets or files.

mod axis;
mod chart;
mod frame;
mod page;
mod palette;
mod path_view;
mod simplify;
mod svg;
mod timeline;

pub use page::render_svg;

/// Content of a plot: title, charts over time and views of paths.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Plot {
    /// Title of the plot.
    pub title: String,
    /// Paths in space, one per arm.
    pub paths: Vec<SpacePath>,
    /// Charts of values over time.
    pub charts: Vec<Chart>,
    /// Execution intervals of the commands, in order of their start.
    pub spans: Vec<ExecutionSpan>,
}

/// Path of a point in space.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SpacePath {
    /// Name of the moving object.
    pub name: String,
    /// Time (seconds) and position (metres) of each sample.
    pub points: Vec<(f64, [f64; 3])>,
}

/// A chart of values that share an axis.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Chart {
    /// Title with the unit of the values.
    pub title: String,
    /// Lines of the chart.
    pub lines: Vec<Line>,
}

/// Line of a chart: one value over time, with its name.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Line {
    /// Name of the line.
    pub name: String,
    /// Time (seconds) and value of each sample.
    pub points: Vec<(f64, f64)>,
}

/// Execution interval of a command.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ExecutionSpan {
    /// Name of the command.
    pub command: String,
    /// Start of the first cycle, seconds.
    pub from: f64,
    /// End of the last cycle, seconds.
    pub to: f64,
    /// Short text for how the command ended.
    pub end: String,
}
