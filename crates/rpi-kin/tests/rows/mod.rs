//! Recorded calls of `InvKin` in the nets and traces stored with the project: pose and hint as inputs, joints as
//! output.

use nalgebra::{Translation3, UnitQuaternion};
use rpi_kin::Pose;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Recorded call.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) place: String,
    pub(crate) flange: Pose,
    pub(crate) hint: [f64; 7],
    pub(crate) joints: [f64; 7],
}

/// Values of one cycle by port name, `path.port`.
type Cycle = BTreeMap<String, String>;

/// Returns all calls with recorded inputs.
pub(crate) fn all(nets: &Path) -> Vec<Row> {
    let mut rows = Vec::new();
    for net in files(&nets.join("corpus/nets")) {
        let trace = nets.join("corpus/traces").join(name(&net) + ".trace.gz");
        rows.extend(of_net(&net, &cycles(&trace, '\t')));
    }
    for net in files(&nets.join("traces")) {
        let folder = nets.join("traces");
        let mut both = cycles(&folder.join(name(&net) + ".ports.csv.gz"), ',');
        for (cycle, ports) in cycles(&folder.join(name(&net) + ".setpoints.csv.gz"), ',') {
            both.entry(cycle).or_default().extend(ports);
        }
        rows.extend(of_net(&net, &both));
    }
    rows
}

fn of_net(net: &Path, cycles: &BTreeMap<u32, Cycle>) -> Vec<Row> {
    let text = rpi_testkit::read_maybe_gz(net).expect("a readable net");
    let calls: Vec<Call> = text
        .match_indices("::InvKin(")
        .filter_map(|(at, _)| Call::at(&text, at))
        .collect();
    let each = cycles
        .iter()
        .flat_map(|(cycle, ports)| calls.iter().map(move |call| (cycle, ports, call)));
    each.filter_map(|(cycle, ports, call)| {
        let place = format!("{} cycle {cycle} {}", name(net), call.name);
        Some(Row {
            place,
            flange: call.input(ports, "inFrame", &call.frame).map(pose)?,
            hint: call
                .input(ports, "inHintJoints", &call.hint)
                .and_then(joints)?,
            joints: ports
                .get(&format!("{}.outJoints", call.name))
                .and_then(|text| joints(text))?,
        })
    })
    .collect()
}

/// Call in the text of a net: its name and the ports connected to its inputs.
struct Call {
    name: String,
    frame: String,
    hint: String,
}

impl Call {
    fn at(text: &str, at: usize) -> Option<Self> {
        let (before, after) = (&text[..at], &text[at..]);
        let arguments = &after[after.find('(')? + 1..after.find(')')?];
        let source = |port: &str| {
            let found = arguments
                .split(',')
                .find_map(|argument| argument.trim().strip_prefix(port))?;
            Some(found.trim_start_matches('=').to_owned())
        };
        let name = before[..before.rfind('=')?]
            .rsplit([',', '{', '\n'])
            .next()?
            .trim();
        Some(Self {
            name: name.to_owned(),
            frame: source("inFrame")?,
            hint: source("inHintJoints")?,
        })
    }

    /// Returns the recorded value of an input, at the call or else at its source.
    fn input<'a>(&self, ports: &'a Cycle, port: &str, source: &str) -> Option<&'a str> {
        ports
            .get(&format!("{}.{port}", self.name))
            .or_else(|| ports.get(source))
            .map(String::as_str)
    }
}

/// Reads a trace. Each line has the cycle and `path.port value` or `primitive,type,port,"value"`.
fn cycles(trace: &Path, separator: char) -> BTreeMap<u32, Cycle> {
    let mut cycles = BTreeMap::<u32, Cycle>::new();
    let text = rpi_testkit::read_maybe_gz(trace).unwrap_or_default();
    for line in text.lines() {
        let columns = if separator == '\t' { 3 } else { 5 };
        let fields: Vec<&str> = line.splitn(columns, separator).collect();
        let Some(cycle) = fields.first().and_then(|field| field.parse().ok()) else {
            continue;
        };
        let (port, value) = match fields[..] {
            [_, port, value] => (port.to_owned(), value),
            [_, primitive, _, port, value] => {
                (format!("{primitive}.{port}"), value.trim_matches('"'))
            }
            _ => continue,
        };
        cycles
            .entry(cycle)
            .or_default()
            .insert(port, value.to_owned());
    }
    cycles
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path());
    let mut nets: Vec<PathBuf> = entries
        .filter(|path| path.to_string_lossy().ends_with(".rpinet.gz"))
        .collect();
    nets.sort();
    nets
}

fn name(net: &Path) -> String {
    let file = net.file_name().unwrap_or_default().to_string_lossy();
    file.trim_end_matches(".rpinet.gz").to_owned()
}

/// Returns all numbers in a text such as `{pos:{x:1.0,y:2.0E-5,z:-3.0},rot:{a:0.0,b:nan,c:1.0}}` or `[1.0,2.0]`.
fn numbers(text: &str) -> Vec<f64> {
    text.split([',', ':', '{', '}', '[', ']'])
        .filter_map(|part| part.trim().parse().ok())
        .collect()
}

fn joints(text: &str) -> Option<[f64; 7]> {
    numbers(text).try_into().ok()
}

/// Reads a position and Euler angles in the convention of KUKA: `Rz(a) Ry(b) Rx(c)`.
fn pose(text: &str) -> Pose {
    let all = numbers(text);
    let [x, y, z, a, b, c] = all[..] else {
        return Pose::rotation(nalgebra::Vector3::repeat(f64::NAN));
    };
    Pose::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::from_euler_angles(c, b, a),
    )
}
