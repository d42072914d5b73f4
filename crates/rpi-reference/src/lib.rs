//! Naive interpreter of typed programs: an executable definition of the semantics.
//!
//! It is written to be read and to serve as a test oracle: random programs run here and as optimised images, and every
//! value must agree bit for bit. It therefore shares only the typed program with the compiler. It does not use the
//! clocks and the presence inferred by the checker, nor nets, schedules, lowering or the code of primitives. A flow is
//! evaluated on demand; clocks and arithmetic operators are implemented again, because an interpreter that calls the
//! code under test would always agree with it.
//!
//! Every function handles one *leaf*: a Boolean, integer, real or enum value; structs and arrays are sequences of
//! leaves. A leaf is `Some` value, or `None` if the flow is absent (rule M4.1). The rules are those of the chapter on
//! semantics.
//!
//! | file | idea |
//! |---|---|
//! | `value.rs` | values |
//! | `operator.rs` | arithmetic and logical operators |
//! | `time.rs` | exact time |
//! | `instance.rs` | instance of a unit: its memory, and its values in the current cycle |
//! | `cycle.rs` | execution of a cycle, and update of the memory |
//! | `leaf.rs` | expressions |
//! | `sampling.rs` | ticks of sampled clocks |
//! | `flow.rs` | flows and their equations |
//! | `call.rs` | calls |
//! | `clock.rs` | clock of each leaf |
//! | `block.rs` | activation of fragments and states |
//!
//! Not supported: devices, spatial values, tasks.

mod block;
mod call;
mod clock;
mod cycle;
mod flow;
mod instance;
mod leaf;
mod operator;
mod sampling;
mod time;
mod value;

pub use cycle::{CycleOutput, Interpreter};
pub use value::{EvalError, Leaf, Value};
