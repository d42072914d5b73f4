//! Colours: dark for text, greys for background elements, hues for compared data.
//!
//! In this order the hues are distinguishable with the common kinds of colour blindness. Lines are also labelled with
//! their names, so that no information depends on colour alone.

/// Colour of the background of a plot.
pub(super) const BACKGROUND: &str = "#fcfcfb";
/// Colour of headings and names in a plot.
pub(super) const TEXT: &str = "#16181d";
/// Colour of labels, and of the numbers at axes.
pub(super) const SECONDARY_TEXT: &str = "#5b606b";
/// Colour of the grid lines in a plot.
pub(super) const GRID: &str = "#e8e8e4";
/// Colour of the axes and borders in a plot.
pub(super) const AXIS: &str = "#b9bab5";

const HUES: [&str; 8] = [
    "#2a78d6", "#eb6834", "#1baf7a", "#4a3aa7", "#e34948", "#eda100", "#008300", "#e87ba4",
];

/// Returns the hue of the command or line with the index `k`. The hues repeat after the eighth.
pub(super) fn hue(k: usize) -> &'static str {
    HUES[k % HUES.len()]
}

/// Returns the dash pattern of the line with the index `k`; `None` for a solid line. From the ninth line on, the hues
/// repeat with other patterns.
pub(super) fn dashes(k: usize) -> Option<&'static str> {
    [None, Some("6 3"), Some("2 3")][(k / HUES.len()) % 3]
}
