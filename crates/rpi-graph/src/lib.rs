//! Drawings of nets: boxes in layers from left to right, joined by lines.
//!
//! | file | idea |
//! |---|---|
//! | `layering.rs` | layers of boxes, and their order with few crossings |
//! | `crossings.rs` | number of crossings of lines between layers |
//! | `net_graph.rs` | the net of a command as boxes that contain one another |
//!
//! Layers and order do not depend on the sizes of boxes. They are computed once, also for boxes that a reader opens and closes; only
//! coordinates change with these. This crate knows neither nets nor programs.

mod crossings;
mod layering;
mod net_graph;

pub use layering::{Edge, LayerConstraint, Layers, layers};
pub use net_graph::{BoxKind, End, GraphBox, Line, NetGraph, Place, Scene};
