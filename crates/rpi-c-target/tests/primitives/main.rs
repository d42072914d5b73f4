//! Every primitive in the core and in C, compared bit by bit.
//!
//! The C compilers are those of [`COMPILERS`]; one that is not installed is reported as skipped. `RPI_C_CYCLES` sets the
//! number of cycles.

mod image_builder;
mod values;

use image_builder::ImageBuilder;
use rpi_c_target::{CCompiler, Lockstep};
use rpi_core::CycleContext;
use rpi_device::NoDevices;
use rpi_image::{Form, Image, Role};
use rpi_prims::{Prim, PrimId, registry};
use std::sync::Arc;
use values::Random;

/// Warnings that the text must not cause.
const WARNINGS: &str = "-Wall -Wextra -Wconversion -Wshadow -pedantic -Werror";

/// Commands of C compilers, without the options for warnings.
const COMPILERS: &[&str] = &[
    "gcc -std=c99 -O0",
    "gcc -std=c99 -O2",
    "gcc -std=c99 -O3 -march=native",
    "gcc -std=c99 -O1 -DRPI_PORTABLE -fsanitize=undefined,address -fno-sanitize-recover=all",
    "g++ -std=c++17 -O2",
    "clang -std=c99 -O2 -march=native",
];

fn compilers() -> Vec<CCompiler> {
    let all = COMPILERS
        .iter()
        .map(|c| (c, CCompiler::new(&format!("{c} {WARNINGS}"))));
    let (installed, missing): (Vec<_>, Vec<_>) = all.partition(|(_, c)| c.is_installed());
    for (name, _) in missing {
        println!("SKIPPED: `{name}` is not installed");
    }
    installed
        .into_iter()
        .map(|(_, compiler)| compiler)
        .collect()
}

fn cycles() -> u64 {
    let cycles = std::env::var("RPI_C_CYCLES")
        .ok()
        .and_then(|text| text.parse().ok());
    cycles.unwrap_or(300)
}

/// Runs an image in the core and in C, with random inputs.
fn compare(image: Image, compiler: &CCompiler, seed: u64) -> Result<(), String> {
    let image = Arc::new(image);
    let bank = &mut NoDevices;
    let both = Lockstep::start(&image, bank, compiler);
    let mut both = both.map_err(|e| e.to_string())?;
    assert_eq!(both.process().self_test(), Ok(true));
    let mut random = Random(seed);
    for cycle in 0..cycles() {
        for (k, input) in image.inputs.iter().enumerate() {
            let value = random.cycle_value(cycle, input.value.ty);
            both.instance().set_input(k, &value, 0);
            // A value that may be absent is absent in every third cycle.
            let present = input.value;
            if present.present > rpi_image::image::TRUE && random.roll().is_multiple_of(3) {
                both.instance().force(present, None);
            }
        }
        let context = CycleContext {
            net_ns: 1_000_000 * cycle as i64,
            ..CycleContext::default()
        };
        if !both.cycle(bank, &context).map_err(|e| e.to_string())? {
            both.instance().reset();
        }
    }
    Ok(())
}

fn forms(prim: &Prim) -> impl Iterator<Item = Form> {
    let total = prim.total.map(|_| Form::Total);
    total
        .into_iter()
        .chain(prim.optional.map(|_| Form::Optional))
}

fn with_code() -> impl Iterator<Item = &'static Prim> {
    registry().iter().filter(|p| p.desc.role == Role::Compute)
}

/// The macro requires the C text of each primitive with code.
#[test]
fn exactly_the_primitives_with_code_have_c() {
    for prim in registry() {
        assert_eq!(
            prim.c.is_some(),
            prim.desc.role == Role::Compute,
            "{}",
            prim.desc.name
        );
    }
}

#[test]
fn every_primitive_gives_the_same_bits() {
    for compiler in compilers() {
        let mut builder = ImageBuilder::new();
        for prim in with_code().filter(|p| !p.desc.may_fault) {
            forms(prim).for_each(|form| builder.call(prim, form));
        }
        compare(builder.finish(), &compiler, 1).unwrap_or_else(|e| panic!("{compiler:?}\n{e}"));
    }
}

/// A fault hides the ones after it, so each primitive has an image of its own.
#[test]
fn every_primitive_that_may_fault_gives_the_same_bits_and_faults() {
    let compilers = compilers();
    for (k, prim) in with_code().filter(|p| p.desc.may_fault).enumerate() {
        let compiler = &compilers[k % compilers.len()];
        for form in forms(prim) {
            let mut builder = ImageBuilder::new();
            builder.call(prim, form);
            let same = compare(builder.finish(), compiler, k as u64);
            same.unwrap_or_else(|e| panic!("{} {form:?} {compiler:?}\n{e}", prim.desc.name));
        }
    }
}

/// Functions whose error depends on the argument, on arguments of all sizes.
#[test]
fn elementary_functions_give_the_same_bits_on_arguments_of_all_sizes() {
    const FUNCTIONS: &[&str] = &[
        "Core::DoubleSin",
        "Core::DoubleCos",
        "Core::DoubleTan",
        "Core::DoubleAsin",
        "Core::DoubleAcos",
        "Core::DoubleAtan2",
        "Core::DoublePower",
        "Core::DoubleSquareRoot",
        "Core::DoubleLog",
        "Core::DoubleModulo",
        "Rpi::DoubleAtan",
        "Rpi::DoubleExponential",
        "Rpi::DoubleHyperbolicTangent",
        "Rpi::DoubleFloor",
        "Rpi::DoubleCeiling",
        "Rpi::DoubleRound",
    ];
    let mut builder = ImageBuilder::new();
    for name in FUNCTIONS {
        let prim = PrimId::from_name(name).expect("it is registered").prim();
        (0..16).for_each(|_| builder.call(prim, Form::Total));
    }
    let image = builder.finish();
    for compiler in compilers() {
        compare(image.clone(), &compiler, 7).unwrap_or_else(|e| panic!("{compiler:?}\n{e}"));
    }
}
