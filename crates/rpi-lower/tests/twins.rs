//! The optimised image and the observed image give the same results, bit for bit.

use rpi_bench::{generate, image_compare};
use rpi_diag::FileId;
use rpi_net::rpinet;

const MS: u64 = 1_000_000;

#[test]
fn regular_and_irregular_nets() {
    for net in [generate::biquad(20), generate::pid(10)] {
        image_compare::compare(&net, 100, MS).unwrap();
    }
    for seed in 0..20 {
        image_compare::compare(&generate::mixed(400, seed), 50, MS).unwrap();
    }
}

/// Every recorded net of the reference system that can be scheduled.
#[test]
fn recorded_nets() {
    let mut failed = Vec::new();
    let mut done = 0;
    for folder in ["nets/v1", "nets/v2", "nets/traces", "nets/corpus/nets"] {
        let Some(folder) = rpi_testkit::external_data_path(folder) else {
            return;
        };
        let mut files: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .flatten()
            .map(|e| e.path())
            .collect();
        files.sort();
        for file in files
            .iter()
            .filter(|f| f.to_string_lossy().contains(".rpinet"))
        {
            let text = rpi_testkit::read_maybe_gz(file).unwrap();
            let (Some(net), _) = rpinet::parse("net", FileId(0), &text) else {
                continue;
            };
            done += 1;
            if let Err(error) = image_compare::compare(&net, 100, 25 * MS) {
                failed.push(format!("{}: {error}", file.display()));
            }
        }
    }
    assert!(
        failed.is_empty(),
        "{} of {done} nets:\n{}",
        failed.len(),
        failed.join("\n")
    );
}
