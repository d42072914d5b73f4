//! Search of the reference of the standard library: runs the script of the pages under Node.js.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use rpi_doc::{Module, Site};
use rpi_driver::{FileLoader, inspect, library_modules, library_text};

/// Loader without files: modules of the library need none.
struct NoFiles;

impl FileLoader for NoFiles {
    fn text(&self, _: &Path) -> Option<String> {
        None
    }
}

fn library() -> Site {
    let modules = library_modules().map(|name| Module {
        name: name.to_owned(),
        is_library: true,
        inspected: inspect(
            &PathBuf::from(format!("stdlib/{name}.rpi")),
            library_text(name).unwrap(),
            &NoFiles,
        ),
    });
    Site::new("library", "", &modules.collect::<Vec<_>>())
}

/// Returns the names that the search finds for each query, or nothing if there is no Node.js.
fn results<const N: usize>(queries: [&str; N]) -> Option<[Vec<String>; N]> {
    let site = library();
    let file = |name: &str| &site.files.iter().find(|(file, _)| file == name).unwrap().1;
    let mut script = format!("{}\n{}\n", file("names.js"), file("search.js"));
    for query in queries {
        script.push_str(&format!(
            "console.log(search(NAMES, {query:?}).map((row) => row[0]).join(\" \"));\n"
        ));
    }
    let node = Command::new("node")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn();
    let Ok(mut node) = node else {
        // Straight to standard error, because the test harness captures what passing tests print.
        let line = b"SKIPPED: the search of the reference: there is no Node.js\n";
        std::io::stderr().write_all(line).unwrap();
        return None;
    };
    node.stdin
        .take()
        .unwrap()
        .write_all(script.as_bytes())
        .unwrap();
    let output = node.wait_with_output().unwrap();
    assert!(output.status.success());
    let lines = String::from_utf8(output.stdout).unwrap();
    let rows = lines.lines().map(|line| {
        let names = line.split_whitespace().map(str::to_owned);
        names.collect()
    });
    let rows: Vec<Vec<String>> = rows.collect();
    Some(rows.try_into().expect("one line per query"))
}

#[test]
fn words_of_names_and_descriptions_are_found_names_first() {
    let queries = ["low pass", "High-Pass", "filter", "no such thing", " "];
    let Some([low, high, filter, nothing, blank]) = results(queries) else {
        return;
    };
    assert_eq!(low[..2], ["lowpass", "lowpass2"]);
    // Only the description of `highpass` names the low-pass.
    assert!(low.contains(&"highpass".to_owned()), "{low:?}");
    assert_eq!(high[..2], ["highpass", "highpass2"]);
    assert!(filter.contains(&"biquad".to_owned()), "{filter:?}");
    assert!(nothing.is_empty() && blank.is_empty());
}
