//! A naive interpreter of typed programs: what the language means, written in the most obvious way.
//!
//! It is there to be read, and to be compared with: random programs run here and as optimised images, and every value
//! must agree, bit for bit. So it shares nothing with the other way but the typed program: the clocks and the presence that
//! the checker infers are not used here. It knows no net, no schedule, no lowering and no primitive's code: a flow is
//! worked out when somebody asks for it, and the clocks and the operators on numbers are written out again, because an
//! interpreter that calls the code under test agrees with it whatever it does.
//!
//! Everything is told of one *leaf*: a Boolean, integer, real or enum value; structs and arrays are rows of them. A leaf
//! is `Some` value or, where the flow is absent, `None` (rule M4.1). Rules are those of the chapter on semantics.
//!
//! | file | idea |
//! |---|---|
//! | `value.rs` | values |
//! | `operator.rs` | operators on numbers and truth values |
//! | `time.rs` | exact time |
//! | `instance.rs` | an instance of a unit: what it remembers, and what is known of it in this cycle |
//! | `cycle.rs` | one cycle: everything that is active once, then what is kept for the next |
//! | `leaf.rs` | expressions |
//! | `flow.rs` | flows and their equations |
//! | `call.rs` | calls |
//! | `clock.rs` | by which clock each part of a value ticks |
//! | `block.rs` | fragments and states: when they are active |
//!
//! Not covered: devices, spatial values, tasks.

mod block;
mod call;
mod clock;
mod cycle;
mod flow;
mod instance;
mod leaf;
mod operator;
mod time;
mod value;

pub use cycle::{Cycle, Reference};
pub use value::{Leaf, Stop, Value};
