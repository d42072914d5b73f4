//! Entry point for compiled images: the loader.

use rpi_core::{CycleContext, Instance, prim_desc};
use rpi_image::text::print;
use rpi_image::{Image, rpib, verify};
use rpi_sim::{Cell, SimBank};

/// Number of cycles for which an image that the verifier accepts is run.
const CYCLES: usize = 8;

/// Entry point of the fuzzer for image files: reads an image, once unchanged and once with a corrected checksum, and
/// runs it if the verifier accepts it.
pub(crate) fn load(input: &[u8]) {
    let _ = Image::from_bytes(input);
    let mut sealed = input.to_vec();
    rpib::update_checksum(&mut sealed);
    if let Ok(image) = Image::from_bytes(&sealed) {
        let again = Image::from_bytes(&image.to_bytes());
        assert_eq!(again.as_ref(), Ok(&image), "written and read again");
        if verify(&image, &prim_desc).is_ok() {
            assert!(!print(&image, &prim_desc).is_empty());
            run(image);
        }
    }
}

/// Runs a verified image for some cycles. The run may end with a fault, but must not panic or hang.
fn run(image: Image) {
    let Ok(cell) = Cell::parse("cell.toml", "") else {
        return;
    };
    let mut bank = SimBank::new(&cell, 1e-3);
    let Ok(mut machine) = Instance::load(image, &mut bank) else {
        return;
    };
    for _ in 0..CYCLES {
        machine.read(&mut bank, &CycleContext::default());
        machine.evaluate(&mut bank);
        machine.commit();
        machine.hand_over(&mut bank);
        let _ = machine.verdict(&[]);
    }
}
