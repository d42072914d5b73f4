//! Recorded traces: the value of every port of a net, cycle by cycle.
//!
//! Two text formats are supported, plain or compressed with gzip. The tab-separated format (`cycle  path.port  value`,
//! every out-port in every cycle) is in [`tsv`]. The comma-separated format (`cycle,primitive,type,port,value`,
//! selected ports or selected cycles) is in [`csv`]. A trace holds values as text; they are parsed once the types of
//! the net are known.

mod csv;
mod error;
mod trace_data;
mod tsv;

pub use error::{FileReadError, TraceError};
pub use trace_data::{Trace, TraceCycle, TracePortId, TraceRow, read_text};
pub use tsv::TraceWriter;
