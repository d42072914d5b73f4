//! Plot of a run as one SVG file: paths in space, values over time, and a timeline of the commands.
//!
//! The input is plain numbers. This module must not depend on devices, nets or files.

mod axis;
mod chart;
mod frame;
mod labels;
mod page;
mod palette;
mod path_view;
mod simplify;
mod svg;
mod timeline;

pub use page::render_svg;

/// Content of a plot of a run: title, paths in space, charts over time, and execution intervals of the commands.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Plot {
    /// Title of the plot.
    pub title: String,
    /// Paths of the tools in space, one per arm.
    pub paths: Vec<SpacePath>,
    /// Charts of values over time.
    pub charts: Vec<Chart>,
    /// Intervals in which the commands were executed, in order of their start.
    pub spans: Vec<ExecutionSpan>,
}

/// Path of a point in space over time, such as that of an arm's tool.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SpacePath {
    /// Name of the device whose point moves.
    pub name: String,
    /// Time in seconds since the start of the run, and position x, y, z in metres, of each sample.
    pub points: Vec<(f64, [f64; 3])>,
}

/// Chart of one or more values over time, which share the vertical axis.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Chart {
    /// Title of the chart, with the unit of the values.
    pub title: String,
    /// Lines of the chart, one per value.
    pub lines: Vec<Line>,
    /// Names of the levels 0, 1 and so on of values that have no numbers, such as `false` and `true`; empty for numbers. Each line
    /// then has rows of its own, one per level, so that no line hides another.
    pub levels: Vec<String>,
}

/// Line of a chart: one value over time, with its name.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Line {
    /// Name of the value, shown at the end of the line.
    pub name: String,
    /// Time in seconds since the start of the run, and value, of each sample.
    pub points: Vec<(f64, f64)>,
}

/// Interval in which a command was executed.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ExecutionSpan {
    /// Name of the command that was executed.
    pub command: String,
    /// Start of the first cycle, in seconds since the start of the run.
    pub from: f64,
    /// End of the last cycle, in seconds since the start of the run.
    pub to: f64,
    /// Short text for how the command ended.
    pub end: String,
}
