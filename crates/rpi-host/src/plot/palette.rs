//! Colours: ink for text, greys for what stands back, hues for what is compared.
//!
//! The hues keep apart for readers with the common kinds of colour blindness when they stand in this order; lines carry
//! their names besides, so that colour never stands alone.

/// The paper.
pub(super) const PAPER: &str = "#fcfcfb";
/// Headings.
pub(super) const INK: &str = "#16181d";
/// Labels and figures.
pub(super) const SOFT_INK: &str = "#5b606b";
/// Grid lines.
pub(super) const GRID: &str = "#e8e8e4";
/// Axes and borders.
pub(super) const AXIS: &str = "#b9bab5";

const HUES: [&str; 8] = [
    "#2a78d6", "#eb6834", "#1baf7a", "#4a3aa7", "#e34948", "#eda100", "#008300", "#e87ba4",
];

/// The hue of the `k`-th thing in a picture.
pub(super) fn hue(k: usize) -> &'static str {
    HUES[k % HUES.len()]
}

/// The dashes of the `k`-th line: from the ninth on, hues come again with other dashes.
pub(super) fn dashes(k: usize) -> Option<&'static str> {
    [None, Some("6 3"), Some("2 3")][(k / HUES.len()) % 3]
}
