//! Selection of rows from a sample file or a trace.

use std::io::{self, Write};

use serde_json::Value;

/// Selection of rows of a table of samples by flow and cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RowFilter {
    /// Patterns for the names of flows; `*` matches any text. An empty list selects all flows.
    pub flows: Vec<String>,
    /// Numbers of the cycles whose rows are selected; the end is exclusive.
    pub cycles: std::ops::Range<u64>,
}

impl RowFilter {
    fn matches(&self, cycle: u64, flow: &str) -> bool {
        let named = self.flows.is_empty() || self.flows.iter().any(|p| matches_pattern(p, flow));
        named && self.cycles.contains(&cycle)
    }
}

/// Copies the rows of a sample table that the filter selects to `out`, without changing their format: comma-separated,
/// tab-separated or JSON lines. Headers are copied as well. Returns the number of copied rows.
///
/// # Errors
///
/// Returns the I/O errors of the writer.
pub fn copy_matching(text: &str, filter: &RowFilter, out: &mut dyn Write) -> io::Result<u64> {
    let mut rows = 0;
    for line in text.lines() {
        match parse_row(line) {
            Some((cycle, flow)) if filter.matches(cycle, &flow) => rows += 1,
            Some(_) => continue,
            None => {}
        }
        writeln!(out, "{line}")?;
    }
    Ok(rows)
}

/// Returns the cycle number and the flow name of a row in any of the formats; `None` for a header.
fn parse_row(line: &str) -> Option<(u64, String)> {
    if line.starts_with('{') {
        let object: Value = serde_json::from_str(line).ok()?;
        return Some((
            object["cycle"].as_u64()?,
            object["flow"].as_str()?.to_owned(),
        ));
    }
    let (cycle, rest) = line.split_once(['\t', ','])?;
    let separator = line.as_bytes()[cycle.len()];
    let cycle = cycle.parse().ok()?;
    match separator {
        b'\t' => {
            let name = rest.split('\t').next()?;
            (!name.starts_with('#')).then(|| (cycle, name.to_owned()))
        }
        _ => Some((cycle, parse_flow(rest)?)),
    }
}

/// Returns the flow name in the rest of a comma-separated row after the cycle: of `flow,value`, or of
/// `primitive,type,port,value` from a recording of the reference system (the control core of the Robotics API).
fn parse_flow(rest: &str) -> Option<String> {
    if let Some(quoted) = rest.strip_prefix('"') {
        return Some(quoted.split("\",").next()?.replace("\"\"", "\""));
    }
    let fields: Vec<&str> = rest.splitn(4, ',').collect();
    match fields.as_slice() {
        [node, kind, port, _] if kind.contains("::") => Some(format!("{node}.{port}")),
        [flow, ..] => Some((*flow).to_owned()),
        [] => None,
    }
}

/// Returns true if a name matches a pattern in which `*` stands for any text.
fn matches_pattern(pattern: &str, name: &str) -> bool {
    let Some((start, rest)) = pattern.split_once('*') else {
        return pattern == name;
    };
    let Some(tail) = name.strip_prefix(start) else {
        return false;
    };
    let ends = (0..=tail.len()).filter(|&k| tail.is_char_boundary(k));
    ends.into_iter().any(|k| matches_pattern(rest, &tail[k..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picked(text: &str, flow: &str, cycles: std::ops::Range<u64>) -> String {
        let filter = RowFilter {
            flows: vec![flow.to_owned()],
            cycles,
        };
        let mut out = Vec::new();
        copy_matching(text, &filter, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn rows_are_picked_by_flow_and_cycle_in_every_form() {
        let csv = "cycle,flow,value\n0,a.x,1\n1,a.x,2\n1,a.y,\"{x:1,y:2}\"\n";
        assert_eq!(
            picked(csv, "a.*", 1..9),
            "cycle,flow,value\n1,a.x,2\n1,a.y,\"{x:1,y:2}\"\n"
        );
        let tabs = "0\t#t0\t5\n1\tf/a.outX\t1\n1\tb.outX\t2\n";
        assert_eq!(picked(tabs, "*/a.*", 0..9), "0\t#t0\t5\n1\tf/a.outX\t1\n");
        let json =
            "{\"cycle\":1,\"flow\":\"a\",\"value\":2}\n{\"cycle\":1,\"flow\":\"b\",\"value\":2}\n";
        assert_eq!(
            picked(json, "b", 0..9),
            json.lines().nth(1).unwrap().to_owned() + "\n"
        );
        let reference = "cycle,primitive,type,port,value\n3,6,A::B,inX,0.5\n";
        assert_eq!(picked(reference, "6.inX", 0..9), reference);
    }

    #[test]
    fn stars_stand_for_any_text() {
        let cases = [
            ("*", "", true),
            ("a*c", "abc", true),
            ("a*c", "ab", false),
            ("*b*", "abc", true),
            ("a", "ab", false),
        ];
        for (pattern, name, expected) in cases {
            assert_eq!(matches_pattern(pattern, name), expected, "{pattern} {name}");
        }
    }
}
