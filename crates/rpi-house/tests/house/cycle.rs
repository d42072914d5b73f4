//! Rule 5: the cycle is short enough to be read by a control engineer.

use rpi_house::{functions, source_files};

/// Lines of the function that is the cycle.
const LONGEST_CYCLE: usize = 40;

#[test]
fn the_cycle_is_under_forty_lines() {
    let files = source_files();
    let core = files
        .iter()
        .filter(|(path, _)| path.starts_with("crates/rpi-core/src"));
    let cycles: Vec<(String, usize)> = core
        .flat_map(|(path, text)| {
            let named = functions(text).into_iter().filter(|f| f.name == "cycle");
            named
                .map(|f| (path.display().to_string(), f.lines))
                .collect::<Vec<_>>()
        })
        .collect();
    assert!(!cycles.is_empty(), "rpi-core has no function `cycle`");
    for (path, lines) in cycles {
        assert!(lines < LONGEST_CYCLE, "{path}: `cycle` has {lines} lines");
    }
}
