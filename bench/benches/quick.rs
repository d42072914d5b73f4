//! Quick look.
use rpi_bench::{Puppet, generate};
use rpi_core::{Machine, Moment};
use rpi_lower::{LowerOptions, Plan, lower};
use std::time::Instant;

fn main() {
    let mut nets = vec![];
    for (name, path) in [
        ("lin", "nets/traces/lin-3.rpinet.gz"),
        ("lin16", "nets/v1/seq-011-opt-NAME.rpinet.gz"),
    ] {
        let dir = rpi_testkit::shared_dir().unwrap();
        let mut p = dir.join(path);
        if !p.exists() {
            p = std::fs::read_dir(dir.join("nets/v1"))
                .unwrap()
                .flatten()
                .map(|e| e.path())
                .find(|p| p.to_string_lossy().contains("seq-011"))
                .unwrap();
        }
        let text = rpi_testkit::read_maybe_gz(&p).unwrap();
        let t = Instant::now();
        let (net, findings) = rpi_net::rpinet::read("lin", rpi_diag::FileId(0), &text);
        println!("read {:?} {}", t.elapsed(), findings.len());
        nets.push((name, net.unwrap()));
    }
    for (name, net) in nets.into_iter().chain([
        ("bq91", generate::biquad(91)),
        ("bq909", generate::biquad(909)),
        ("bq9090", generate::biquad(9090)),
        ("pid40", generate::pid(40)),
        ("pid400", generate::pid(400)),
        ("pid3900", generate::pid(3900)),
        ("mix1000", generate::mixed(1000, 1)),
        ("mix10000", generate::mixed(10000, 1)),
        ("mix100000", generate::mixed(100000, 1)),
    ]) {
        let n = net.nodes.len();
        let t = Instant::now();
        let Some(plan) = Plan::new(&net, |_| false) else {
            println!("{name}: cycle");
            continue;
        };
        let t1 = t.elapsed();
        let image = lower(&net, &plan, &LowerOptions::running(1_000_000)).unwrap();
        let t2 = t.elapsed();
        rpi_image::verify(&image, &rpi_core::catalogue).unwrap();
        let t3 = t.elapsed();
        let mut bank = Puppet::new();
        let steps = image.steps.len();
        if std::env::args().any(|a| a == name) {
            println!("{}", rpi_image::print::print(&image, &rpi_core::catalogue));
        }
        let y = image.exports.first().map(|e| e.value);
        let mut m = Machine::load(image, &mut bank).unwrap();
        let cycles = (30_000_000 / n).max(10);
        let mut best = f64::MAX;
        for _ in 0..7 {
            let t = Instant::now();
            for _ in 0..cycles / 7 + 1 {
                m.read(&mut bank, &Moment::default());
                m.evaluate(&mut bank);
                m.commit();
                m.hand_over(&mut bank);
            }
            best = best.min(t.elapsed().as_nanos() as f64 / (cycles / 7 + 1) as f64 / n as f64);
        }
        println!(
            "{name:10} n {n:6} cycle {:9.1} ns steps {steps:6} {best:7.3} ns/prim  plan {t1:?} lower {:?} verify {:?} y {:?}",
            best * n as f64,
            t2 - t1,
            t3 - t2,
            y.and_then(|y| m.value(y)).map(|v| f64::from_bits(v[0]))
        );
    }
}
