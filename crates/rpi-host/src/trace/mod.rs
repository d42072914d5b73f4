//! Recorded traces: what every port of a net carried, cycle by cycle.
//!
//! Two text forms are read, plain or gzip: the tab-separated one (`cycle  path.port  value`, every out-port in every
//! cycle; [`tabbed`]) and the comma-separated one (`cycle,primitive,type,port,value`, chosen ports or chosen cycles;
//! [`comma`]). A trace knows texts and nothing of a net: values are read when the net's types are known.

mod arena;
mod comma;
mod error;
mod tabbed;

pub use arena::{Cycle, PortId, Row, Trace, read_text};
pub use error::{ReadError, TraceError};
pub use tabbed::TraceWriter;
