//! Compares the compiler's bound on the work per cycle with the work that cycles do.

use rpi_bench::generate;
use rpi_bench::{FakeDevices, NetBuilder, net_builder};
use rpi_core::{CycleContext, Instance};
use rpi_image::image::Step;
use rpi_lower::{LowerOptions, Plan, lower};
use rpi_net::passes::{Analysis, analyse};
use rpi_net::{FragmentId, Input, Net, Restart};
use rpi_prims::PrimId;

const MS: u64 = 1_000_000;
const ROOT: FragmentId = FragmentId::ROOT;

/// Bound of a net and the work of each of its first cycles, in elementary operations.
fn bound_and_cycles(net: &Net, cycles: u64) -> (u64, Vec<u64>) {
    let analysis: Analysis = analyse(net.clone(), |_| false).expect("a net in order");
    let plan = Plan::from_analysis(&analysis).expect("no rings");
    // Lowered as observed, with one step for each primitive, so that the executed steps can be counted.
    let image = lower(&analysis.net, &plan, &LowerOptions::observed(MS)).expect("it is small");
    let works: Vec<u64> = image.steps.iter().map(|step| work(&image, step)).collect();
    let mut bank = FakeDevices::new();
    let mut machine = Instance::load(image, &mut bank).expect("it loads");
    let done = (0..cycles).map(|_| {
        machine.read(&mut bank, &CycleContext::default());
        let (mut pc, mut done) = (0, 0);
        while pc < works.len() {
            done += works[pc];
            pc = machine.step(pc, &mut bank);
        }
        machine.commit();
        machine.hand_over(&mut bank);
        bank.advance();
        done
    });
    (analysis.work.bound(ROOT), done.collect())
}

/// Work of a step according to the declaration of its primitive.
fn work(image: &rpi_image::Image, step: &Step) -> u64 {
    let Step::Run { prim, .. } = *step else {
        return 0;
    };
    let prim =
        PrimId::from_name(&image.prims_used[usize::from(prim)].name).expect("it is registered");
    u64::from(prim.prim().desc.work)
}

/// Row 16: no cycle does more work than the precomputed bound, whatever the values.
#[test]
fn no_cycle_does_more_than_its_bound() {
    for seed in 0..8 {
        let (bound, cycles) = bound_and_cycles(&generate::mixed(400, seed), 50);
        let most = cycles.iter().copied().max().expect("there are cycles");
        assert!(most <= bound, "seed {seed}: {most} of {bound}");
        assert!(
            2 * most > bound,
            "seed {seed}: {most} of {bound} is no bound to rely on"
        );
    }
}

/// Of two mutually exclusive fragments the bound counts the larger one, and cycles with that fragment reach it.
#[test]
fn the_bound_of_fragments_that_exclude_each_other_is_reached() {
    let mut b = NetBuilder::new("Gates");
    let time = b.add(ROOT, "Core::Clock", &[]);
    let late = b.add(
        ROOT,
        "Core::DoubleGreater",
        &[Input::Port(time), net_builder::real(0.0055)],
    );
    let early = b.add(ROOT, "Core::BooleanNot", &[Input::Port(late)]);
    for (when, nodes) in [(late, 5), (early, 50)] {
        let name = if nodes == 5 { "late" } else { "early" };
        let fragment = b.fragment(ROOT, name, when, Restart::Never);
        let mut flow = time;
        for _ in 0..nodes {
            flow = b.add(
                fragment,
                "Core::DoubleAdd",
                &[Input::Port(flow), net_builder::real(1.0)],
            );
        }
        b.export(name, flow);
    }
    let (bound, cycles) = bound_and_cycles(&b.net, 10);
    // Distinguishing the two flows needs no step of its own.
    assert_eq!(cycles[0] + 2, bound, "{cycles:?}");
    assert!(cycles.iter().all(|done| *done <= bound), "{cycles:?}");
    assert_eq!(cycles[9] + 45, cycles[0], "{cycles:?}");
}
