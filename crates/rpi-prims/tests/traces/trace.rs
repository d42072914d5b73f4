//! Recorded trace: values of ports by cycle.

use std::collections::BTreeMap;

/// Texts of all ports by cycle.
pub(crate) struct Trace {
    /// Net clock at cycle 1, ms since the Unix epoch.
    pub(crate) start_ms: i64,
    /// Number of recorded cycles.
    pub(crate) cycles: usize,
    /// Text of a port in each cycle; index 0 is cycle 1. `None` if it is absent.
    pub(crate) ports: BTreeMap<String, Vec<Option<String>>>,
}

/// Reads the lines `cycle, port, value`.
pub(crate) fn read(text: &str) -> Trace {
    let mut trace = Trace {
        start_ms: 0,
        cycles: 0,
        ports: BTreeMap::new(),
    };
    for line in text.lines() {
        let mut parts = line.splitn(3, '\t');
        let (Some(cycle), Some(port), Some(value)) = (parts.next(), parts.next(), parts.next())
        else {
            continue;
        };
        let Ok(cycle) = cycle.parse::<usize>() else {
            continue;
        };
        if cycle == 0 {
            let ms = value.split('\t').next().and_then(|v| v.parse().ok());
            trace.start_ms = ms.unwrap_or(0);
            continue;
        }
        trace.cycles = trace.cycles.max(cycle);
        if !trace.ports.contains_key(port) {
            trace.ports.insert(port.to_owned(), Vec::new());
        }
        let values = trace.ports.get_mut(port).expect("just inserted");
        values.resize(cycle - 1, None);
        values.push(Some(value.to_owned()));
    }
    for values in trace.ports.values_mut() {
        values.resize(trace.cycles, None);
    }
    trace
}
