//! Graphs of nets: `tests/net-graph/NAME.txt` has the boxes and lines of the commands of `NAME.rpi`. `RPI_BLESS=1` writes them.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use rpi_driver::CompileOptions;
use rpi_graph::{End, NetGraph, Place, Scene};
use rpi_replay::net_graph;

fn programs() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/net-graph");
    let files = std::fs::read_dir(folder).unwrap();
    let files = files.map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = files
        .filter(|file| file.extension().is_some_and(|end| end == "rpi"))
        .collect();
    files.sort();
    files
}

/// Returns the graphs of the commands of a program, with all flows observed, as the page of `rpi view` has them.
fn graphs(program: &Path) -> Vec<NetGraph> {
    let options = CompileOptions {
        watch: vec![String::new()],
        ..CompileOptions::default()
    };
    let compiled = rpi_driver::compile_with(&rpi_driver::read(program).unwrap(), options).unwrap();
    assert!(!compiled.has_errors(), "{}", program.display());
    let nets = compiled.nets().iter();
    let place = |span: rpi_diag::Span| {
        (!span.is_none()).then(|| Place {
            file: String::new(),
            line: compiled.sources.line_col(span).line,
        })
    };
    nets.map(|net| net_graph(net, &place)).collect()
}

fn text(graph: &NetGraph) -> String {
    let mut out = format!("command {}\n", graph.command);
    for (number, scene) in graph.scenes.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "scene {number}");
        for shown in &scene.boxes {
            let line = shown.place.as_ref().map_or(0, |place| place.line);
            let flow = shown.flow.as_deref().unwrap_or("-");
            let fragment = shown.fragment.as_deref();
            let path = fragment.map_or(flow.to_owned(), |path| format!("fragment {path}"));
            let inner = shown.inner.map_or(String::new(), |n| format!(" scene {n}"));
            let others = match shown.other_flows.is_empty() {
                true => String::new(),
                false => format!(", also {}", shown.other_flows.join(", ")),
            };
            let (name, kind) = (&shown.name, shown.kind.name());
            let _ = writeln!(out, "  {kind} {name}: {path}{others}, line {line}{inner}");
        }
        for line in &scene.lines {
            let arrow = match (line.is_delayed, line.is_condition) {
                (true, _) => "-- pre -->",
                (_, true) => "-- when -->",
                _ => "-->",
            };
            let (from, to) = (end(scene, line.from), end(scene, line.to));
            let _ = writeln!(out, "  {from} {arrow} {to}");
        }
    }
    out
}

fn end(scene: &Scene, end: End) -> String {
    let port = end
        .port
        .map_or(String::new(), |port| format!(" port {port}"));
    let shown = &scene.boxes[end.shape];
    format!("{} {}{port}", shown.kind.name(), shown.name)
}

#[test]
fn boxes_and_lines_are_those_of_the_program() {
    for program in programs() {
        let found: String = graphs(&program).iter().map(text).collect();
        let expected = program.with_extension("txt");
        if std::env::var_os("RPI_BLESS").is_some() {
            std::fs::write(&expected, &found).unwrap();
        }
        let expected = std::fs::read_to_string(&expected).unwrap_or_default();
        assert_eq!(found, expected, "{}", program.display());
    }
}

#[test]
fn each_box_and_each_line_has_its_place_in_the_layers() {
    for graph in programs().iter().flat_map(|program| graphs(program)) {
        for scene in &graph.scenes {
            let columns = &scene.layers.columns;
            let column = |shape: usize| columns.iter().position(|c| c.contains(&shape)).unwrap();
            let placed = columns.iter().flatten().filter(|v| **v < scene.boxes.len());
            assert_eq!(placed.count(), scene.boxes.len());
            assert_eq!(scene.layers.chains.len(), scene.lines.len());
            for (line, chain) in scene.lines.iter().zip(&scene.layers.chains) {
                let (from, to) = (column(line.from.shape), column(line.to.shape));
                assert!(chain.is_empty() || from < to, "{line:?}");
                for end in [line.from, line.to] {
                    let inner = scene.boxes[end.shape]
                        .inner
                        .map(|inner| &graph.scenes[inner]);
                    assert!(
                        end.port
                            .is_none_or(|port| port < inner.unwrap().boxes.len())
                    );
                }
            }
        }
    }
}
