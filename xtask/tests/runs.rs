//! Rules 4, 5, 6 and 8 on real programs: images print and verify, a tick and a takeover neither allocate nor free
//! memory, and compilation is deterministic.

use std::path::PathBuf;

use rpi_core::{Command, CommandState, Core, Rule, prim_desc};
use rpi_driver::{Compiled, Input, InputKind, compile, lower_for_execution};
use rpi_image::{Image, verify};
use rpi_sim::{Cell, SimBank};
use rpi_testkit::{files_below, no_alloc};

rpi_testkit::trap_allocations!();

const TICK_NS: u64 = 1_000_000;

/// Two commands with state, fragments and an end after some cycles.
const PROGRAM: &str = "\
node Count (step: int) returns (n: int)
let
  n = 0 -> pre n + step;
tel

command Short ()
let
  n = Count(1);
  fragment Late when n > 3
  let m = Count(2); tel
  export n;
  finish done when (Late.m ?? 0) > 6;
tel
";

fn compiled(path: PathBuf, text: &str) -> Compiled {
    let kind = InputKind::from_path(&path).expect("the name tells the language");
    let input = Input {
        path,
        kind,
        bytes: text.as_bytes().to_vec(),
    };
    compile(&input).unwrap_or_else(|error| panic!("{error}"))
}

fn images(path: PathBuf, text: &str) -> Vec<Image> {
    let compiled = compiled(path, text);
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    let nets = compiled.nets().iter();
    nets.map(|net| lower_for_execution(net, TICK_NS).expect("it lowers"))
        .collect()
}

/// Returns the images of the program above and of every example, with the file names.
fn all_images() -> Vec<(PathBuf, Vec<Image>)> {
    let mut all = vec![(PathBuf::from("short.rpi"), PROGRAM.to_owned())];
    for path in files_below("examples", &[".rpi"]) {
        let text = std::fs::read_to_string(&path).expect("it is UTF-8");
        all.push((path, text));
    }
    all.into_iter()
        .map(|(path, text)| (path.clone(), images(path, &text)))
        .collect()
}

#[test]
fn images_of_all_examples_verify_print_and_read_back() {
    for (path, images) in all_images() {
        for image in images {
            assert!(verify(&image, &prim_desc).is_ok(), "{}", path.display());
            assert!(!rpi_image::text::print(&image, &prim_desc).is_empty());
            let bytes = image.to_bytes();
            let back = Image::from_bytes(&bytes).expect("it reads back");
            assert_eq!(back.to_bytes(), bytes, "{}", path.display());
        }
    }
}

#[test]
fn the_same_program_gives_the_same_bytes() {
    let bytes = || -> Vec<Vec<u8>> {
        let all = all_images().into_iter().flat_map(|(_, images)| images);
        all.map(|image| image.to_bytes()).collect()
    };
    assert_eq!(bytes(), bytes());
}

/// A damaged image must be rejected by its checksum; it must never make the loader or the verifier panic.
#[test]
fn no_damaged_byte_makes_the_verifier_panic() {
    let bytes = images("short.rpi".into(), PROGRAM)[0].to_bytes();
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0xff;
        assert!(
            Image::from_bytes(&damaged).is_err(),
            "byte {at}: damage not detected by the checksum"
        );
    }
}

#[test]
fn a_tick_and_a_switch_neither_allocate_nor_free() {
    let image = images("short.rpi".into(), PROGRAM).remove(0);
    let cell = Cell::parse("cell.toml", "").expect("an empty cell");
    let mut bank = SimBank::new(&cell, TICK_NS as f64 * 1e-9);
    let mut core = Core::with_capacity(4, TICK_NS);
    let mut load = |bank: &mut SimBank| {
        let command = Command::load(image.clone(), bank).expect("it loads");
        core.insert(Box::new(command))
            .unwrap_or_else(|(_, why)| panic!("{why:?}"))
    };
    let (first, second) = (load(&mut bank), load(&mut bank));
    core.start(first, &mut bank).expect("nothing is taken");
    let rule = Rule::follow(first).start(second).keep_orphans();
    let made = core.schedule(Box::new(rule), &mut bank);
    made.unwrap_or_else(|(_, why)| panic!("{why:?}"));
    let mut switched = None;
    no_alloc(|| {
        for tick in 0..100 {
            core.tick(&mut bank, 0, &mut ());
            let runs = core
                .command(second)
                .is_some_and(|c| c.state() == CommandState::Running);
            if runs && switched.is_none() {
                switched = Some(tick);
            }
        }
    });
    assert!(switched.is_some(), "the second command never ran");
}
