//! Test cases of the corpus, and the verdict on each.

use crate::task_error::TaskError;
use std::path::{Path, PathBuf};

use rpi_diag::{Code, CodeGroup};
use serde_json::Value;

use super::options::{Expectation, Options};
use super::tool::{ToolOutput, Tools};
use super::trace::{Flow, Trace, UNDEFINED};

/// Result of the test of one program in a corpus of Lustre programs. Each variant carries a text with details.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Verdict {
    /// The file of the program is missing, or its trace has an unknown format.
    Missing(String),
    /// The program has a syntax error; the text has code and message.
    NotParsed(String),
    /// The compiler rejects the program; the text has code and message.
    Rejected(String),
    /// A tool crashed or timed out on the program.
    Crashed(String),
    /// The run of the program ended with a fault; the text has its message.
    Fault(String),
    /// The outputs or the error codes of the program differ from the expected ones.
    Mismatch(String),
    /// The program gives the expected result.
    Pass(String),
}

/// Program of a corpus of Lustre programs, with its expected result.
pub(crate) struct Case {
    pub(crate) name: String,
    path: PathBuf,
    expected: Expected,
}

enum Expected {
    Trace(Option<Trace>),
    Rejection,
    Codes(Vec<String>),
    Run,
    /// The program must satisfy its contracts. If there is a reason, the program is excluded and must not satisfy them.
    Contracts(Option<String>),
}

/// Relative tolerance of real values for magnitudes above 1, and absolute tolerance below.
const TOLERANCE: f64 = 1e-6;

/// Returns the selected programs of a corpus with their expected results, by name.
///
/// # Errors
/// Returns an error if a file cannot be read or no program is selected.
pub(crate) fn cases(options: &Options) -> Result<Vec<Case>, TaskError> {
    let only = options.filter.as_deref().unwrap_or_default();
    let mut cases = match &options.expectation {
        Expectation::Match(traces) => trace_cases(&options.programs, traces)?,
        Expectation::Reject => directory_cases(&options.programs, || Expected::Rejection)?,
        Expectation::Codes(table) => code_cases(&options.programs, table)?,
        Expectation::Run => directory_cases(&options.programs, || Expected::Run)?,
        Expectation::Contracts(list) => contract_cases(&options.programs, list)?,
    };
    cases.retain(|case| case.name.contains(only));
    match cases.is_empty() {
        true => Err(format!("no programs in {}", options.programs.display()).into()),
        false => Ok(cases),
    }
}

fn trace_cases(programs: &Path, traces: &Path) -> Result<Vec<Case>, TaskError> {
    let bad = |e: &dyn std::fmt::Display| format!("{}: {e}", traces.display());
    let text = std::fs::read_to_string(traces).map_err(|e| bad(&e))?;
    let entries: Value = serde_json::from_str(&text).map_err(|e| bad(&e))?;
    let entries = entries
        .as_object()
        .ok_or_else(|| bad(&"expected a JSON object"))?;
    let case = |(name, entry): (&String, &Value)| Case {
        name: name.clone(),
        path: programs.join(name),
        expected: Expected::Trace(Trace::read(entry)),
    };
    Ok(entries.iter().map(case).collect())
}

/// Returns the programs that a table lists: a JSON object that maps file names to lists of codes. A program must be
/// rejected with any code of its list, where `RPI2` stands for all codes with this prefix. An empty list means that the
/// program must be accepted.
fn code_cases(programs: &Path, table: &Path) -> Result<Vec<Case>, TaskError> {
    let bad = |e: &dyn std::fmt::Display| format!("{}: {e}", table.display());
    let text = std::fs::read_to_string(table).map_err(|e| bad(&e))?;
    let table: std::collections::BTreeMap<String, Vec<String>> =
        serde_json::from_str(&text).map_err(|e| bad(&e))?;
    let case = |(name, codes): (String, Vec<String>)| Case {
        path: programs.join(&name),
        name,
        expected: Expected::Codes(codes),
    };
    Ok(table.into_iter().map(case).collect())
}

/// Returns all programs of a directory, which must satisfy their contracts. The file `list` is a JSON object that maps
/// the file names of excluded programs to reasons.
fn contract_cases(programs: &Path, list: &Path) -> Result<Vec<Case>, TaskError> {
    let bad = |e: &dyn std::fmt::Display| format!("{}: {e}", list.display());
    let text = std::fs::read_to_string(list).map_err(|e| bad(&e))?;
    let mut reasons: std::collections::BTreeMap<String, String> =
        serde_json::from_str(&text).map_err(|e| bad(&e))?;
    let mut cases = directory_cases(programs, || Expected::Contracts(None))?;
    for case in &mut cases {
        case.expected = Expected::Contracts(reasons.remove(&case.name));
    }
    match reasons.into_keys().next() {
        Some(name) => Err(bad(&format!("unknown program {name}")).into()),
        None => Ok(cases),
    }
}

fn directory_cases(programs: &Path, wanted: fn() -> Expected) -> Result<Vec<Case>, TaskError> {
    let (mut open, mut found) = (vec![programs.to_owned()], Vec::new());
    while let Some(folder) = open.pop() {
        let entries = std::fs::read_dir(&folder);
        for entry in entries.map_err(|e| format!("{}: {e}", folder.display()))? {
            let path = entry.map_err(|e| e.to_string())?.path();
            match path.extension() {
                _ if path.is_dir() => open.push(path),
                Some(extension) if extension == "lus" => found.push(path),
                _ => {}
            }
        }
    }
    found.sort();
    let name = |path: &Path| {
        path.strip_prefix(programs)
            .unwrap_or(path)
            .display()
            .to_string()
    };
    let case = |path: PathBuf| Case {
        name: name(&path),
        path,
        expected: wanted(),
    };
    Ok(found.into_iter().map(case).collect())
}

impl Case {
    /// Runs the program with the tools and compares the result with the expected one.
    pub(crate) fn judge(&self, tools: &Tools) -> Verdict {
        let path = self.path.display().to_string();
        if !self.path.is_file() {
            return Verdict::Missing(format!("{path} does not exist"));
        }
        match &self.expected {
            Expected::Trace(None) => Verdict::Missing("the trace has an unknown format".to_owned()),
            Expected::Trace(Some(trace)) => check_trace(trace, &path, tools),
            Expected::Rejection => check_rejection(&run_check(tools, &path)),
            Expected::Codes(codes) => check_codes(codes, &run_check(tools, &path)),
            Expected::Contracts(reason) => {
                apply_exclusion(reason.as_deref(), check_contracts(tools, &path))
            }
            Expected::Run => {
                let args = ["run", &path, "--random", "1", "--cycles", "12"];
                let ended = tools.run("rpi", &args);
                failure(&ended).unwrap_or_else(|| Verdict::Pass(String::new()))
            }
        }
    }
}

/// Number of cycles in which the contracts of a program are checked with random inputs.
const CONTRACT_CYCLES: &str = "100";

/// Checks that a program is accepted, and that it satisfies its guarantees for random inputs that satisfy its
/// assumptions.
fn check_contracts(tools: &Tools, path: &str) -> Verdict {
    let checked = run_check(tools, path);
    if checked.status != Some(0) {
        return check_codes(&[], &checked);
    }
    let random = ["--random", "1", "--cycles", CONTRACT_CYCLES];
    let args = [&["run", path, "--contracts", "fault"][..], &random].concat();
    let ended = tools.run("rpi", &args);
    match failure(&ended) {
        Some(_) if ended.err.contains(NO_NODE) => {
            Verdict::Pass("it has no node that can be run".to_owned())
        }
        Some(fate) => fate,
        None => Verdict::Pass(String::new()),
    }
}

/// Message of `rpi run` for a program that has no node to run, because it has only generic nodes, types or constants.
// Decided by the text because the exit status does not distinguish this case. Must match `rpi-driver/src/node.rs`.
const NO_NODE: &str = "there is no node in it that can be run";

/// Returns the verdict on a program that may be excluded. An excluded program (with a `reason`) passes only if `fate`,
/// the verdict on its run, is a failure other than a crash. Other programs have the verdict `fate`.
fn apply_exclusion(reason: Option<&str>, fate: Verdict) -> Verdict {
    match (reason, fate) {
        (Some(_), Verdict::Pass(_)) => Verdict::Mismatch("excluded, but it passes".to_owned()),
        (Some(_), Verdict::Crashed(why)) => Verdict::Crashed(why),
        (Some(reason), _) => Verdict::Pass(format!("excluded: {reason}")),
        (None, fate) => fate,
    }
}

fn check_trace(trace: &Trace, path: &str, tools: &Tools) -> Verdict {
    let Ok(mut table) = tempfile::NamedTempFile::new() else {
        return Verdict::Crashed("cannot write the inputs".to_owned());
    };
    if std::io::Write::write_all(&mut table, trace.table().as_bytes()).is_err() {
        return Verdict::Crashed("cannot write the inputs".to_owned());
    }
    let inputs = table.path().display().to_string();
    let mut args = vec![
        "run",
        path,
        "--node",
        &trace.node,
        "--inputs",
        &inputs,
        "--numbers",
    ];
    if !trace.locals.is_empty() {
        args.push("--locals");
    }
    let ended = tools.run("rpi", &args);
    match failure(&ended) {
        Some(Verdict::Rejected(why))
            if trace.has_undefined() && group(&why) == Some(CodeGroup::Initialisation) =>
        {
            Verdict::Pass("rejected as expected: the trace reads an undefined value".to_owned())
        }
        Some(fate) => fate,
        None => compare(trace, &ended.out),
    }
}

/// Compares the expected outputs of a trace with the table that `rpi run` has printed. The verdict names the first
/// difference.
fn compare(trace: &Trace, table: &str) -> Verdict {
    let mut lines = table.lines();
    let names: Vec<String> = lines
        .next()
        .unwrap_or_default()
        .split(',')
        .map(flattened_name)
        .collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let mut values = 0;
    for flow in trace.outputs.iter().chain(&trace.locals) {
        let Some(column) = names.iter().position(|name| *name == flow.name) else {
            return Verdict::Mismatch(format!("missing flow `{}`", flow.name));
        };
        match difference(flow, |cycle| rows.get(cycle)?.get(column).copied()) {
            Some(what) => return Verdict::Mismatch(format!("{}, {what}", flow.name)),
            None => values += flow.values.len(),
        }
    }
    match trace.has_undefined() {
        true => Verdict::Pass(format!("{values} values; undefined ones are proved unread")),
        false => Verdict::Pass(format!("{values} values")),
    }
}

fn difference<'t>(flow: &Flow, found: impl Fn(usize) -> Option<&'t str>) -> Option<String> {
    for (cycle, wanted) in flow.values.iter().enumerate() {
        let found = found(cycle).unwrap_or("nothing");
        if !same(wanted, found) {
            return Some(format!("cycle {cycle}: expected {wanted}, found {found}"));
        }
    }
    None
}

fn same(wanted: &str, found: &str) -> bool {
    match (wanted.parse::<f64>(), found.parse::<f64>()) {
        _ if wanted == UNDEFINED || wanted == found => true,
        (Ok(wanted), Ok(found)) => {
            let scale = wanted.abs().max(1.0);
            (wanted - found).abs() <= TOLERANCE * scale || wanted.is_nan() && found.is_nan()
        }
        _ => false,
    }
}

/// Returns the name of a leaf of a structured flow in the form of the traces: `x[2].f` becomes `x_2_f`.
fn flattened_name(name: &str) -> String {
    let kept = name.chars().filter(|c| *c != ']');
    kept.map(|c| if matches!(c, '.' | '[') { '_' } else { c })
        .collect()
}

/// Returns the group of the diagnostic code at the start of a message; `None` if the message does not start with a
/// code.
fn group(message: &str) -> Option<CodeGroup> {
    Code::parse(message.get(..7)?).map(Code::group)
}

/// Returns the verdict on a run of a tool that failed; `None` for a successful run.
fn failure(ended: &ToolOutput) -> Option<Verdict> {
    let why = first_error(&ended.err);
    match ended.status {
        Some(0) => None,
        Some(3) => Some(Verdict::Fault(why)),
        Some(1 | 2) if group(&why) == Some(CodeGroup::Syntax) => Some(Verdict::NotParsed(why)),
        Some(1 | 2) => Some(Verdict::Rejected(why)),
        _ => Some(Verdict::Crashed(why)),
    }
}

fn run_check(tools: &Tools, path: &str) -> ToolOutput {
    tools.run("rpic", &["check", "--format", "short", path])
}

/// Returns the verdict on the output of `rpic check`. It is a pass if one of the errors has one of the expected codes,
/// or if no codes are expected and there is no error.
fn check_codes(codes: &[String], ended: &ToolOutput) -> Verdict {
    let output = format!("{}{}", ended.out, ended.err);
    let errors: Vec<&str> = output.lines().filter_map(error_of_line).collect();
    let right = |error: &&&str| codes.iter().any(|code| error.starts_with(code.as_str()));
    match (ended.status, errors.iter().find(right), errors.first()) {
        (None, ..) => Verdict::Crashed(first_error(&output)),
        (Some(0), ..) if codes.is_empty() => Verdict::Pass(String::new()),
        (Some(0), ..) => Verdict::Mismatch(format!("accepted, expected {}", codes.join(", "))),
        (_, Some(error), _) => Verdict::Pass((*error).to_owned()),
        (_, None, Some(error)) => Verdict::Rejected((*error).to_owned()),
        (_, None, None) => Verdict::Crashed(first_error(&output)),
    }
}

/// Returns the code and the message of an output line that reports an error; `None` for other lines.
fn error_of_line(line: &str) -> Option<&str> {
    line.split_once(": error ").map(|(_, error)| error)
}

fn check_rejection(ended: &ToolOutput) -> Verdict {
    let output = format!("{}{}", ended.out, ended.err);
    match ended.status {
        Some(0) => Verdict::Mismatch("accepted".to_owned()),
        Some(_) => Verdict::Pass(first_error(&output)),
        None => Verdict::Crashed(first_error(&output)),
    }
}

/// Returns the code, message and location of the first error in the output of a tool; the first line if there is no
/// error.
fn first_error(output: &str) -> String {
    let mut lines = output.lines().skip_while(|line| !line.contains("error"));
    let Some(line) = lines.next() else {
        return output.lines().next().unwrap_or("no output").to_owned();
    };
    let place = lines.find_map(|line| line.split_once("[").map(|(_, rest)| rest));
    let place = place
        .and_then(|rest| rest.split_once(']'))
        .map(|(place, _)| place);
    let place = place.map(|place| place.rsplit('/').next().unwrap_or(place));
    let text = line.split_once("error").map_or(line, |(_, rest)| rest);
    let text = text.trim_start_matches([':', ' ']);
    match place {
        Some(place) => format!("{text} ({place})"),
        None => text.to_owned(),
    }
}
