//! What a machine can hold: how late it wakes a thread that sleeps until an absolute time, again and again, and which period that allows.
//!
//! The way of `cyclictest`: a thread with the priority, memory and core of a cycle sleeps until its next deadline and looks at the
//! clock. How late it is shows what the kernel, interrupts and other programs take. This module must not know what runs in a cycle.

mod measure;
mod verdict;

pub use measure::{Bucket, Wakes, measure};
pub use verdict::{Load, Verdict, verdict};
