//! Simulated devices and the description of a cell.
