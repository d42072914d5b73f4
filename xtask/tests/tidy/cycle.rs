//! Rule 5: the cycle is short enough to be read by a control engineer.

use xtask::{functions, source_files};

/// Lines below which the cycle and each of its phases must stay.
const LONGEST: usize = 40;

/// Functions of the cycle (`tick` and its phases), all in rpi-core.
const CYCLE: &[&str] = &[
    "tick",
    "latch_inputs",
    "read",
    "evaluate",
    "commit",
    "hand_over",
    "notify_observer",
    "decide",
];

#[test]
fn the_cycle_is_under_forty_lines() {
    let files = source_files();
    let core: Vec<_> = files
        .iter()
        .filter(|file| file.owner == "rpi-core")
        .collect();
    for name in CYCLE {
        let functions = core.iter().flat_map(|file| functions(&file.text));
        let lines: Vec<usize> = functions
            .filter(|f| f.name == *name)
            .map(|f| f.lines)
            .collect();
        assert!(
            !lines.is_empty(),
            "rpi-core has no function `{name}`; update CYCLE"
        );
        assert!(
            lines.iter().all(|lines| *lines < LONGEST),
            "`{name}` has {lines:?} lines"
        );
    }
}

/// Crates whose code runs, or may run, on the cycle thread.
const REAL_TIME: &[&str] = &[
    "rpi-core",
    "rpi-device",
    "rpi-image",
    "rpi-kin",
    "rpi-math",
    "rpi-motion",
    "rpi-prims",
];

/// Code that is not allowed in them. Absence of allocation is checked by the allocation trap; absence of threads,
/// clocks and files follows from `no_std`.
const FORBIDDEN: &[&str] = &[
    ".unwrap()",
    ".expect(",
    "panic!(",
    "unreachable!(",
    "catch_unwind",
    "spin_loop",
    "loop {",
];

#[test]
fn nothing_on_the_real_time_side_panics_or_waits() {
    let mut found = Vec::new();
    for file in source_files()
        .iter()
        .filter(|file| REAL_TIME.contains(&file.owner.as_str()))
    {
        for (number, line) in file.without_tests().lines().enumerate() {
            let code = line.split("//").next().unwrap_or("");
            if FORBIDDEN.iter().any(|word| code.contains(word)) {
                found.push(format!(
                    "{}:{}: {}",
                    file.path.display(),
                    number + 1,
                    line.trim()
                ));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
