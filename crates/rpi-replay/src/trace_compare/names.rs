//! Maps the port names of the trace to those of the net.
//!
//! Frameworks that generate nets continue their name counters from run to run, so a trace of another run of the same
//! program may use `p88` for the port `p15` of the net. If no name matches, but all names match with a constant offset,
//! the offset is applied.

use std::collections::{BTreeMap, BTreeSet};

use rpi_record::trace::{Trace, TracePortId};

/// Ports of a trace, by the names that they have in the net.
pub(super) struct PortNames {
    by_name: BTreeMap<String, TracePortId>,
    /// Offset that is added to the numbers in generated names of the trace; 0 if the names match without it.
    pub(super) shift: i64,
}

impl PortNames {
    /// Matches the names of the trace's ports with those of the net. `known` are the names of all ports of the net.
    pub(super) fn new(trace: &Trace, known: &BTreeSet<String>) -> PortNames {
        let has_common_name = trace.ports().any(|(_, name)| known.contains(name));
        let shift = if has_common_name {
            0
        } else {
            common_shift(trace, known).unwrap_or(0)
        };
        let by_name = trace
            .ports()
            .filter_map(|(id, name)| Some((shifted(name, shift)?, id)));
        PortNames {
            by_name: by_name.collect(),
            shift,
        }
    }

    /// Returns the index in the trace of the port with this name in the net; `None` if the trace has no such port.
    pub(super) fn find(&self, name: &str) -> Option<TracePortId> {
        self.by_name.get(name).copied()
    }

    /// Iterates over all ports of the trace with their names in the net.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&str, TracePortId)> {
        self.by_name.iter().map(|(name, id)| (name.as_str(), *id))
    }
}

/// Returns the offset that maps every name of the trace to a known name of the net; `None` if there is no such offset.
fn common_shift(trace: &Trace, known: &BTreeSet<String>) -> Option<i64> {
    let first_of_net = known.iter().flat_map(|name| trailing_numbers(name)).min()?;
    let first_of_trace = trace
        .ports()
        .flat_map(|(_, name)| trailing_numbers(name))
        .min()?;
    let shift = first_of_net.checked_sub(first_of_trace)?;
    let is_known = |name: &str| shifted(name, shift).is_some_and(|name| known.contains(&name));
    trace
        .ports()
        .all(|(_, name)| is_known(name))
        .then_some(shift)
}

/// Returns the numbers at the ends of the parts of a path: 2 and 15 for `f2/p15.out`.
fn trailing_numbers(name: &str) -> impl Iterator<Item = i64> {
    let (path, _) = split_port(name);
    path.split('/')
        .filter_map(|part| split_number(part).map(|(_, number)| number))
}

/// Returns the path of a port with the offset added to the number at the end of each of its parts; `None` if a part has
/// no number.
fn shifted(name: &str, shift: i64) -> Option<String> {
    if shift == 0 {
        return Some(name.to_owned());
    }
    let (path, port) = split_port(name);
    let parts: Option<Vec<String>> = path
        .split('/')
        .map(|part| {
            let (stem, number) = split_number(part)?;
            Some(format!("{stem}{}", number.checked_add(shift)?))
        })
        .collect();
    Some(format!("{}.{port}", parts?.join("/")))
}

fn split_port(name: &str) -> (&str, &str) {
    name.rsplit_once('.').unwrap_or((name, ""))
}

/// Splits a generated name into stem and number: `p` and 15 for `p15`; `None` if the name has no number.
fn split_number(part: &str) -> Option<(&str, i64)> {
    let stem = part.trim_end_matches(|c: char| c.is_ascii_digit());
    Some((stem, part[stem.len()..].parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(trace: &[&str], net: &[&str]) -> PortNames {
        let rows: String = trace.iter().map(|name| format!("1\t{name}\t0\n")).collect();
        let known = net.iter().map(|n| (*n).to_owned()).collect();
        PortNames::new(&Trace::parse(&rows).unwrap(), &known)
    }

    #[test]
    fn a_trace_with_the_nets_names_is_taken_as_it_is() {
        let names = names(&["p1.outValue", "x.outY"], &["p1.outValue", "p2.outValue"]);
        assert_eq!(names.shift, 0);
        assert!(names.find("p1.outValue").is_some() && names.find("p2.outValue").is_none());
    }

    #[test]
    fn generated_names_of_another_run_are_recognised() {
        let names = names(
            &["p15/p14.outA", "p18.outB"],
            &["p87.x", "p88/p87.outA", "p91.outB"],
        );
        assert_eq!(names.shift, 73);
        assert!(names.find("p88/p87.outA").is_some() && names.find("p91.outB").is_some());
    }

    #[test]
    fn a_trace_of_another_net_is_not_bent_to_fit() {
        let names = names(&["p15.outA", "p17.outB"], &["p1.outA", "p2.outB"]);
        assert_eq!(names.shift, 0);
        assert!(names.find("p15.outA").is_some());
    }
}
