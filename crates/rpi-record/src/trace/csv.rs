//! Comma-separated trace format: `cycle,primitive,type,port,value`. Values that contain commas are in double quotes.
//!
//! A file with in-ports holds selected ports (set-points, published values) in every cycle. A file without in-ports
//! holds all out-ports in selected cycles.

use std::borrow::Cow;

use super::tsv::{invalid_cycle_number, parse_cycle_number};
use super::{Trace, TraceError};

/// Header line of a trace (recorded port values of a net) in comma-separated format.
pub(super) const HEADER: &str = "cycle,primitive,type,port,value";

pub(super) fn parse(text: &str) -> Result<Trace, TraceError> {
    let mut trace = Trace::default();
    let mut in_ports = false;
    for (k, line) in text.lines().enumerate().skip(1) {
        let mut fields = line.splitn(5, ',');
        let mut next = || fields.next();
        let (Some(cycle), Some(node), Some(_), Some(port), Some(value)) =
            (next(), next(), next(), next(), next())
        else {
            return Err(TraceError::new(k + 1, format!("expected `{HEADER}`")));
        };
        in_ports |= port.starts_with("in");
        let cycle = parse_cycle_number(cycle).ok_or_else(|| invalid_cycle_number(k, cycle))?;
        trace.push_row(cycle, &format!("{node}.{port}"), &unquoted(value));
    }
    if in_ports {
        trace.mark_all_listed();
    } else {
        trace.mark_all_complete();
    }
    Ok(trace)
}

fn unquoted(field: &str) -> Cow<'_, str> {
    match field.strip_prefix('"').and_then(|f| f.strip_suffix('"')) {
        None => Cow::Borrowed(field),
        Some(inner) if inner.contains('"') => Cow::Owned(inner.replace("\"\"", "\"")),
        Some(inner) => Cow::Borrowed(inner),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_points_are_recorded_in_every_cycle() {
        let text = format!(
            "{HEADER}\n1,6,RobotArm::JointPosition,inPosition,0.5\n2,9,K,inFrame,\"{{pos:{{x:1,y:2,z:3}}}}\"\n"
        );
        let trace = Trace::parse(&text).unwrap();
        let port = trace.find("6.inPosition").unwrap();
        assert!(trace.is_recorded(port, 2));
        let row = trace.cycle_at(2).unwrap().rows[0];
        assert_eq!(trace.value(row), "{pos:{x:1,y:2,z:3}}");
    }

    #[test]
    fn out_ports_are_recorded_in_chosen_cycles() {
        let text = format!("{HEADER}\n5,6,T,outError,\"0\"\n");
        let trace = Trace::parse(&text).unwrap();
        assert!(trace.cycle_at(5).is_some_and(|c| c.complete));
        assert!(trace.cycle_at(4).is_none());
    }

    #[test]
    fn two_recordings_of_one_run_join() {
        let points =
            Trace::parse(&format!("{HEADER}\n1,6,T,inValue,1\n2,6,T,inValue,2\n")).unwrap();
        let ports = Trace::parse(&format!("{HEADER}\n2,5,T,outValue,2\n")).unwrap();
        let both = points.merged_with(&ports);
        assert_eq!(both.cycle_at(2).unwrap().rows.len(), 2);
        assert!(both.cycle_at(2).unwrap().complete && !both.cycle_at(1).unwrap().complete);
        assert!(both.is_recorded(both.find("6.inValue").unwrap(), 1));
    }

    #[test]
    fn broken_lines_are_named() {
        assert_eq!(
            Trace::parse(&format!("{HEADER}\n1,6,T")).unwrap_err().line,
            2
        );
    }
}
