//! Results of lowered nets, cycle by cycle.

use rpi_bench::net_builder::real;
use rpi_bench::{NetBuilder, image_compare};
use rpi_core::{CycleContext, Instance};
use rpi_device::NoDevices;
use rpi_image::Image;
use rpi_lower::LowerOptions;
use rpi_net::{FragmentId, Input, Net, PortRef, Restart};
use rpi_prims::PrimId;

const ROOT: FragmentId = FragmentId::ROOT;
const MS: u64 = 1_000_000;

fn image(net: &Net, options: &LowerOptions<'_>) -> Image {
    let image = image_compare::lower_net(net, options).expect("it can be lowered");
    if let Err(errors) = rpi_image::verify(&image, &rpi_core::prim_desc) {
        let text: Vec<String> = errors.iter().map(ToString::to_string).collect();
        let print = rpi_image::text::print(&image, &rpi_core::prim_desc);
        panic!("{}\n{print}", text.join("\n"));
    }
    image
}

/// Runs one cycle up to the commit phase.
fn cycle(instance: &mut Instance) {
    instance.read(&mut NoDevices, &CycleContext::default());
    instance.evaluate(&mut NoDevices);
}

fn finish(instance: &mut Instance) {
    instance.commit();
    assert!(instance.hand_over(&mut NoDevices));
}

/// The value of the probe `path.port` in this cycle; `None` if it is absent.
fn probe(instance: &Instance, name: &str) -> Option<Vec<u64>> {
    let image = instance.image();
    let probe = image
        .debug
        .probes
        .iter()
        .find(|p| image.probe_name(p) == name);
    let probe = probe.unwrap_or_else(|| panic!("no probe {name}"));
    let active = instance.is_active(probe.fragment);
    instance
        .value(probe.value)
        .filter(|_| active)
        .map(<[u64]>::to_vec)
}

/// Adds a node with this name, whose in-ports are connected in declaration order.
fn node(
    b: &mut NetBuilder,
    fragment: FragmentId,
    name: &str,
    prim: &str,
    inputs: &[Input],
) -> PortRef {
    let prim = PrimId::from_name(prim).expect("a primitive");
    b.node(fragment, name, prim, inputs, &[])
}

/// `x = if null(pre x) then 0 else pre x + 1`, the reference system's idiom for a counter.
fn counter(b: &mut NetBuilder, fragment: FragmentId) -> PortRef {
    let pre = node(b, fragment, "pre", "Core::DoublePre", &[]);
    let null = node(
        b,
        fragment,
        "null",
        "Core::DoubleIsNull",
        &[Input::Port(pre)],
    );
    let next = node(
        b,
        fragment,
        "next",
        "Core::DoubleAdd",
        &[Input::Port(pre), real(1.0)],
    );
    let x = node(
        b,
        fragment,
        "x",
        "Core::DoubleConditional",
        &[Input::Port(null), real(0.0), Input::Port(next)],
    );
    b.wire(pre.node, 0, x);
    x
}

fn samples(b: &NetBuilder, name: &str, cycles: usize) -> Vec<Option<f64>> {
    let image = image(&b.net, &LowerOptions::observed(MS));
    let mut instance = Instance::load(image, &mut NoDevices).expect("it loads");
    let mut samples = Vec::new();
    for _ in 0..cycles {
        cycle(&mut instance);
        samples.push(probe(&instance, name).map(|v| f64::from_bits(v[0])));
        finish(&mut instance);
    }
    samples
}

#[test]
fn a_delay_is_absent_in_its_first_cycle() {
    let mut b = NetBuilder::new("test");
    counter(&mut b, ROOT);
    assert_eq!(samples(&b, "pre.outValue", 3), [None, Some(0.0), Some(1.0)]);
    assert_eq!(
        samples(&b, "x.outValue", 3),
        [Some(0.0), Some(1.0), Some(2.0)]
    );
}

/// A net with a fragment that is active in cycles 1, 2, 5, 6, ... counted from 0.
fn gated(restart: Restart) -> NetBuilder {
    let mut b = NetBuilder::new("test");
    let x = counter(&mut b, ROOT);
    let past = node(
        &mut b,
        ROOT,
        "past",
        "Core::DoubleGreater",
        &[Input::Port(x), real(0.5)],
    );
    let pause = node(
        &mut b,
        ROOT,
        "pause",
        "Core::DoubleGreater",
        &[Input::Port(x), real(2.5)],
    );
    let late = node(
        &mut b,
        ROOT,
        "late",
        "Core::DoubleGreater",
        &[Input::Port(x), real(4.5)],
    );
    let not = node(
        &mut b,
        ROOT,
        "not",
        "Core::BooleanNot",
        &[Input::Port(pause)],
    );
    let early = node(
        &mut b,
        ROOT,
        "early",
        "Core::BooleanAnd",
        &[Input::Port(past), Input::Port(not)],
    );
    let when = node(
        &mut b,
        ROOT,
        "when",
        "Core::BooleanOr",
        &[Input::Port(early), Input::Port(late)],
    );
    let f = b.fragment(ROOT, "f", when, restart);
    let inside = counter(&mut b, f);
    node(
        &mut b,
        ROOT,
        "outside",
        "Core::DoubleAdd",
        &[Input::Port(inside), real(10.0)],
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
