//! Constants that leave their fragment: outside they are present only while it is active (M4, M6).

use rpi_core::{CycleContext, Instance};
use rpi_driver::{Input, InputKind, compile, lower_for_execution, lower_for_observation};
use rpi_image::Image;
use rpi_sim::{Cell, SimBank};

const PERIOD_NS: u64 = 1_000_000;

/// Returns the exported integers of a program's only command in each cycle, `None` if absent.
fn exported(image: Image, cycles: usize) -> Vec<Vec<Option<i64>>> {
    let cell = Cell::parse("cell.toml", "").expect("an empty cell");
    let mut bank = SimBank::new(&cell, PERIOD_NS as f64 * 1e-9);
    let mut machine = Instance::load(image, &mut bank).expect("it loads");
    let mut all = Vec::new();
    for _ in 0..cycles {
        machine.read(&mut bank, &CycleContext::default());
        machine.evaluate(&mut bank);
        let exports = machine.image().exports.clone();
        let values = exports
            .iter()
            .map(|e| Some(machine.value(e.value)?[0].cast_signed()));
        all.push(values.collect());
        machine.commit();
    }
    all
}

fn check(program: &str, expected: &[&[Option<i64>]]) {
    let input = Input {
        path: "constants.rpi".into(),
        kind: InputKind::Rpi,
        bytes: program.as_bytes().to_vec(),
    };
    let compiled = compile(&input).expect("a program is text");
    let [net] = compiled.nets() else {
        panic!("{:?}", compiled.diagnostics);
    };
    for lower in [lower_for_execution, lower_for_observation] {
        let image = lower(net, PERIOD_NS).expect("it lowers");
        assert_eq!(exported(image, expected.len()), expected, "{program}");
    }
}

#[test]
fn a_constant_of_an_inactive_fragment_is_absent() {
    let program = "command C ()
        let
          odd = false -> not pre odd;
          fragment F when odd
          let x = 3; tel
          y = F.x ?? 0;
          export y;
          export F.x;
          finish done when y > 5;
        tel";
    check(
        program,
        &[&[Some(0), None], &[Some(3), Some(3)], &[Some(0), None]],
    );
}

/// The order of reader and fragment in the text and the number of enclosing fragments do not matter.
#[test]
fn a_constant_passes_through_fragments() {
    let program = "command C ()
        let
          n = 0 -> pre n + 1;
          fragment A when n > 0
          let
            y = B.z + 1;
            fragment B when n > 1
            let z = 5; tel
          tel
          r = A.y ?? (A.B.z ?? -1);
          s = if present(A.B.z) then 1 else 0;
          export r;
          export s;
          finish done when n > 9;
        tel";
    check(
        program,
        &[
            &[Some(-1), Some(0)],
            &[Some(-1), Some(0)],
            &[Some(6), Some(1)],
        ],
    );
}

#[test]
fn a_constant_of_a_named_fragment_or_an_activated_call_is_absent_too() {
    let program = "fragment Seven (on: bool) returns (x: int) when on
        let x = 7; tel
        node Eight () returns (x: int)
        let x = 8; tel
        command C ()
        let
          odd = false -> not pre odd;
          a = Seven(odd) ?? 0;
          b = (activate Eight every odd initial default 1)();
          export a;
          export b;
          finish done when a > 9;
        tel";
    check(
        program,
        &[
            &[Some(0), Some(1)],
            &[Some(7), Some(8)],
            &[Some(0), Some(8)],
        ],
    );
}

#[test]
fn states_define_flows_by_constants() {
    let program = "command C ()
        let
          n = 0 -> pre n + 1;
          automaton
            initial state One let x = 1; tel until n > 0 then Two;
            state Two let x = 2; tel
          end
          export x;
          finish done when n > 9;
        tel";
    check(program, &[&[Some(1)], &[Some(1)], &[Some(2)], &[Some(2)]]);
}
