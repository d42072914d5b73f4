//! Recorded nets, written as programs and compiled again, are the same nets: same primitives of the same names, same
//! parameters, same links, same activations. What the compiler works out beforehand is worked out here, too.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use rpi_diag::Severity;
use rpi_driver::{Input, Kind, compile, import, read};
use rpi_image::{Role, Value};
use rpi_net::{Absent, Activation, Fragment, Input as Source, Net, NodeId};
use rpi_prims::fold;

/// A net, the same net from its program, and which node became which.
struct Pair<'n> {
    old: &'n Net,
    new: &'n Net,
    constants: Vec<Option<Vec<Value>>>,
    nodes: HashMap<NodeId, NodeId>,
}

impl<'n> Pair<'n> {
    fn new(old: &'n Net, new: &'n Net, names: &[(String, String)]) -> Self {
        let olds = paths(old);
        let news = paths(new);
        let nodes = names
            .iter()
            .filter_map(|(a, b)| Some((*olds.get(a)?, *news.get(b)?)));
        Pair {
            old,
            new,
            constants: constants(old),
            nodes: nodes.collect(),
        }
    }

    fn differences(&self) -> Vec<String> {
        let nodes = self
            .old
            .node_ids()
            .filter(|id| self.constants[id.index()].is_none());
        let nodes = nodes.filter_map(|id| self.node(id).err());
        let fragments = self
            .old
            .fragments
            .iter()
            .filter_map(|f| self.fragment(f).err());
        nodes.chain(fragments).collect()
    }

    fn node(&self, id: NodeId) -> Result<(), String> {
        let old = self.old.node(id);
        let name = format!("{} {}", old.name, old.desc().name);
        let Some(new) = self.nodes.get(&id).map(|id| self.new.node(*id)) else {
            return Err(format!("{name} is missing"));
        };
        if new.prim != old.prim {
            return Err(format!("{name} became {}", new.desc().name));
        }
        let depth = |net: &Net, fragment| net.enclosing(fragment).count();
        if depth(self.old, old.fragment) != depth(self.new, new.fragment) {
            return Err(format!("{name} stands elsewhere"));
        }
        if !old.params.iter().zip(&new.params).all(|(a, b)| close(a, b)) {
            return Err(format!("{name}: {:?} became {:?}", old.params, new.params));
        }
        for (a, b) in old.inputs.iter().zip(&new.inputs) {
            if !self.same(a, b) {
                return Err(format!("{name}: {a:?} became {b:?}"));
            }
        }
        Ok(())
    }

    fn same(&self, old: &Source, new: &Source) -> bool {
        match (self.settled(old), new) {
            (Source::Open, Source::Open) => true,
            (Source::Const(a), Source::Const(b)) => close(&a, b),
            (Source::Port(a), Source::Port(b)) => {
                self.nodes.get(&a.node) == Some(&b.node) && a.port == b.port
            }
            _ => false,
        }
    }

    fn settled(&self, source: &Source) -> Source {
        match source {
            Source::Port(port) => match &self.constants[port.node.index()] {
                Some(values) => Source::Const(values[usize::from(port.port)].clone()),
                None => source.clone(),
            },
            _ => source.clone(),
        }
    }

    /// A fragment runs by the same condition, or by its absence.
    fn fragment(&self, old: &Fragment) -> Result<(), String> {
        let Activation::When { condition, absent } = &old.activation else {
            return Ok(());
        };
        let new = self
            .new
            .fragments
            .iter()
            .find(|new| new.name.trim_start_matches('f') == old.name.trim_start_matches('f'));
        let new = new.ok_or_else(|| format!("fragment {} is missing", old.name))?;
        let same = match (&new.activation, self.settled(&Source::Port(*condition))) {
            (Activation::Always, Source::Const(value)) => value.as_bool() == Some(true),
            (Activation::When { condition: by, .. }, old) => {
                let node = self.new.node(by.node);
                let otherwise = Source::Const(Value::bool(*absent == Absent::Active));
                let by = Source::Port(*by);
                match node.desc().name {
                    "Rpi::BooleanCoalesce" => {
                        self.same(&old, &node.inputs[0]) && node.inputs[1] == otherwise
                    }
                    "Core::BooleanValue" => old == Source::Const(node.params[0].clone()),
                    _ => self.same(&old, &by),
                }
            }
            _ => false,
        };
        same.then_some(())
            .ok_or_else(|| format!("fragment {} has another condition", old.name))
    }
}

fn paths(net: &Net) -> HashMap<String, NodeId> {
    let path = |id: NodeId| net.path(net.node(id).fragment, &net.node(id).name);
    net.node_ids().map(|id| (path(id), id)).collect()
}

/// The out-ports of nodes that read nothing that changes.
fn constants(net: &Net) -> Vec<Option<Vec<Value>>> {
    let mut known: Vec<Option<Vec<Value>>> = vec![None; net.nodes.len()];
    let mut open: Vec<NodeId> = net.node_ids().collect();
    loop {
        let before = open.len();
        open.retain(|id| {
            known[id.index()] = constant(net, &known, *id);
            known[id.index()].is_none()
        });
        if open.len() == before {
            return known;
        }
    }
}

fn constant(net: &Net, known: &[Option<Vec<Value>>], id: NodeId) -> Option<Vec<Value>> {
    let node = net.node(id);
    if node.desc().role == Role::Constant {
        return Some(node.params.clone());
    }
    let value = |source: &Source| match source {
        Source::Const(value) => Some(value.clone()),
        Source::Port(port) => known[port.node.index()]
            .as_ref()?
            .get(usize::from(port.port))
            .cloned(),
        Source::Open => None,
    };
    let inputs: Vec<Value> = node.inputs.iter().map(value).collect::<Option<_>>()?;
    let inputs: Vec<&Value> = inputs.iter().collect();
    fold(node.prim, &inputs, &node.params, &node.outputs)?.ok()
}

/// Angles go through text: a rotation is the same to rounding, all else to the bit.
fn close(a: &Value, b: &Value) -> bool {
    let real = |bits: u64| f64::from_bits(bits);
    let near = |(a, b): (&u64, &u64)| {
        a == b || (real(*a) - real(*b)).abs() <= 1e-14 || (real(*a).is_nan() && real(*b).is_nan())
    };
    match (a.ty(), b.ty()) {
        (Some(x), Some(y)) => {
            let only_reals =
                x.cells() == y.cells() && (a.as_bool().is_none() && a.as_int().is_none());
            a == b || only_reals && a.cells().iter().zip(b.cells()).all(near)
        }
        _ => a == b,
    }
}

/// Reads, writes, compiles and compares; what differs.
fn round_trip(path: &Path) -> Vec<String> {
    let nets = read(path)
        .and_then(|input| compile(&input))
        .expect("a recorded net can be read");
    let [net] = nets.nets() else {
        return vec!["it is no net".to_owned()];
    };
    if is_refused(net) {
        return vec!["the net itself depends on itself".to_owned()];
    }
    let imported = import::import(net);
    let input = Input {
        path: PathBuf::from("imported.rpi"),
        kind: Kind::Rpi,
        bytes: imported.text.into_bytes(),
    };
    let compiled = compile(&input).expect("a program is text");
    let errors = compiled
        .findings
        .iter()
        .filter(|f| f.severity() == Severity::Error);
    let errors: Vec<String> = errors
        .map(|f| format!("{} {}", f.code, f.message))
        .collect();
    match (errors.is_empty(), compiled.nets()) {
        (true, [new]) => Pair::new(net, new, &imported.names).differences(),
        (true, _) => vec!["there is no command".to_owned()],
        (false, _) => errors,
    }
}

/// Whether the passes find an error in the net itself.
fn is_refused(net: &Net) -> bool {
    let analysis =
        rpi_net::passes::analyse(net.clone(), |_| false).expect("a read net is in order");
    analysis
        .findings
        .iter()
        .any(|f| f.severity() == Severity::Error)
}

/// Largest file, packed, in bytes: the others take long to compile without optimisation.
const LARGEST: u64 = 12_000;

fn recorded() -> Vec<PathBuf> {
    let Some(nets) = rpi_testkit::shared_path("nets") else {
        return Vec::new();
    };
    let folders = ["corpus/nets", "v1", "v2"].map(|folder| nets.join(folder));
    let files = folders
        .iter()
        .flat_map(|folder| folder.read_dir().expect("a folder of nets"));
    let files = files.map(|file| file.expect("a file"));
    let small = files.filter(|file| file.metadata().is_ok_and(|m| m.len() <= LARGEST));
    let mut paths: Vec<PathBuf> = small.map(|file| file.path()).collect();
    paths.retain(|path| path.to_string_lossy().contains(".rpinet"));
    paths.sort();
    paths
}

/// What may differ: a part of the text, and why.
const KNOWN: &[(&str, &str)] = &[
    (
        "` depends on itself in the same cycle",
        "a program's fragment is one vertex in the net around it; nets of the older system read one piecewise",
    ),
    (
        "the sizes of `Core::MatrixSet` do not fit",
        "the type of a matrix that is passed on is not found",
    ),
    (
        "Core::DoubleArray",
        "an array that is read across fragments is taken apart and put together again, element by element",
    ),
    (
        "ArmKinematics::Kin",
        "an array that is read across fragments is taken apart and put together again, element by element",
    ),
];

/// How many nets differ for these reasons at most.
const KNOWN_NETS: usize = 28;

#[test]
fn recorded_nets_come_back_from_their_programs() {
    let paths = recorded();
    let next = AtomicUsize::new(0);
    let faults = Mutex::new(Vec::new());
    let begin = Instant::now();
    let work = || {
        while let Some(path) = paths.get(next.fetch_add(1, Ordering::Relaxed)) {
            let differences = round_trip(path);
            if let Some(first) = differences.first() {
                let name = path
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned();
                let text = format!("{name}: {first} (and {} more)", differences.len() - 1);
                faults.lock().expect("no thread failed").push(text);
            }
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(work);
        scope.spawn(work);
    });
    let mut faults = faults.into_inner().expect("no thread failed");
    faults.sort();
    let found = faults.len();
    faults.retain(|fault| !KNOWN.iter().any(|(known, _)| fault.contains(known)));
    println!(
        "{} of {} nets come back ({:?}); {} differ as known",
        paths.len() - found,
        paths.len(),
        begin.elapsed(),
        found - faults.len()
    );
    assert!(
        faults.is_empty(),
        "{} of {} differ:\n{}",
        faults.len(),
        paths.len(),
        faults.join("\n")
    );
    assert!(found <= KNOWN_NETS, "{found} nets differ");
}
