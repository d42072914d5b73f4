//! Rule 5: the cycle is short enough to be read by a control engineer.

use rpi_house::{functions, source_files};

/// Lines of the function that is the cycle.
const LONGEST_CYCLE: usize = 40;

#[test]
fn the_cycle_is_under_forty_lines() {
    let mut cycles: Vec<(String, usize)> = Vec::new();
    for file in source_files()
        .iter()
        .filter(|file| file.owner == "rpi-core")
    {
        let named = functions(&file.text)
            .into_iter()
            .filter(|f| f.name == "cycle");
        cycles.extend(named.map(|f| (file.path.display().to_string(), f.lines)));
    }
    assert!(!cycles.is_empty(), "rpi-core has no function `cycle`");
    for (path, lines) in cycles {
        assert!(lines < LONGEST_CYCLE, "{path}: `cycle` has {lines} lines");
    }
}
