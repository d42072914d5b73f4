//! Results of lowered nets, cycle by cycle.

mod support;

use rpi_core::Instance;
use rpi_image::Value;
use rpi_lower::LowerOptions;
use rpi_net::{FragmentId, Input, PortRef, Restart};
use support::{NetBuilder, NoDevices, cycle, finish, image, probe};

const ROOT: FragmentId = FragmentId::ROOT;
const MS: u64 = 1_000_000;

fn real(v: f64) -> Input {
    Input::constant(Value::real(v))
}

/// `x = if null(pre x) then 0 else pre x + 1`, the reference system's idiom for a counter.
fn counter(b: &mut NetBuilder, fragment: FragmentId) -> PortRef {
    let pre = b.node(fragment, "pre", "Core::DoublePre", &[], &[]);
    let null = b.node(
        fragment,
        "null",
        "Core::DoubleIsNull",
        &[("inValue", Input::Port(pre))],
        &[],
    );
    let next = b.node(
        fragment,
        "next",
        "Core::DoubleAdd",
        &[("inFirst", Input::Port(pre)), ("inSecond", real(1.0))],
        &[],
    );
    let x = b.node(
        fragment,
        "x",
        "Core::DoubleConditional",
        &[
            ("inCondition", Input::Port(null)),
            ("inTrue", real(0.0)),
            ("inFalse", Input::Port(next)),
        ],
        &[],
    );
    b.wire(pre.node, 0, x);
    x
}

fn samples(b: &NetBuilder, name: &str, cycles: usize) -> Vec<Option<f64>> {
    let image = image(&b.net, &LowerOptions::observed(MS));
    let mut machine = Instance::load(image, &mut NoDevices).expect("it loads");
    let mut samples = Vec::new();
    for _ in 0..cycles {
        cycle(&mut machine);
        samples.push(probe(&machine, name).map(|v| f64::from_bits(v[0])));
        finish(&mut machine);
    }
    samples
}

#[test]
fn a_delay_is_absent_in_its_first_cycle() {
    let mut b = NetBuilder::new();
    counter(&mut b, ROOT);
    assert_eq!(samples(&b, "pre.outValue", 3), [None, Some(0.0), Some(1.0)]);
    assert_eq!(
        samples(&b, "x.outValue", 3),
        [Some(0.0), Some(1.0), Some(2.0)]
    );
}

/// A net with a fragment that is active in cycles 1, 2, 5, 6, ... counted from 0.
fn gated(restart: Restart) -> NetBuilder {
    let mut b = NetBuilder::new();
    let x = counter(&mut b, ROOT);
    let past = b.node(
        ROOT,
        "past",
        "Core::DoubleGreater",
        &[("inFirst", Input::Port(x)), ("inSecond", real(0.5))],
        &[],
    );
    let pause = b.node(
        ROOT,
        "pause",
        "Core::DoubleGreater",
        &[("inFirst", Input::Port(x)), ("inSecond", real(2.5))],
        &[],
    );
    let late = b.node(
        ROOT,
        "late",
        "Core::DoubleGreater",
        &[("inFirst", Input::Port(x)), ("inSecond", real(4.5))],
        &[],
    );
    let not = b.node(
        ROOT,
        "not",
        "Core::BooleanNot",
        &[("inValue", Input::Port(pause))],
        &[],
    );
    let early = b.node(
        ROOT,
        "early",
        "Core::BooleanAnd",
        &[
            ("inFirst", Input::Port(past)),
            ("inSecond", Input::Port(not)),
        ],
        &[],
    );
    let when = b.node(
        ROOT,
        "when",
        "Core::BooleanOr",
        &[
            ("inFirst", Input::Port(early)),
            ("inSecond", Input::Port(late)),
        ],
        &[],
    );
    let f = b.fragment(ROOT, "f", when, restart);
    let inside = counter(&mut b, f);
    b.node(
        ROOT,
        "outside",
        "Core::DoubleAdd",
        &[("inFirst", Input::Port(inside)), ("inSecond", real(10.0))],
        &[],
    );
    b
}

#[test]
fn an_inactive_fragment_is_absent_and_resumes() {
    let b = gated(Restart::Never);
    let inside = [None, Some(0.0), Some(1.0), None, None, Some(2.0), Some(3.0)];
    assert_eq!(samples(&b, "f/x.outValue", 7), inside);
    let outside = inside.map(|v| v.map(|v| v + 10.0));
    assert_eq!(samples(&b, "outside.outValue", 7), outside);
}

#[test]
fn a_fragment_can_start_afresh_on_activation() {
    let b = gated(Restart::OnActivation);
    let inside = [None, Some(0.0), Some(1.0), None, None, Some(0.0), Some(1.0)];
    assert_eq!(samples(&b, "f/x.outValue", 7), inside);
}
