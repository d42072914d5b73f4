//! Proof that the real-time side does without `std`: `cargo check -p rpi-nostd --features proof`.
//!
//! With the feature this crate brings its own panic handler. If anything that it is built on brings
//! `std` along, there are two of them, and it does not compile: error E0152, "found duplicate lang
//! item `panic_impl`", with the name of the crate that did it. The feature is off in a build of the
//! whole workspace, where cargo joins the features of all crates and test tools want `std`.

#![no_std]

#[cfg(feature = "proof")]
mod proof {
    extern crate rpi_core as _;
    extern crate rpi_device as _;
    extern crate rpi_image as _;
    extern crate rpi_kin as _;
    extern crate rpi_prims as _;

    /// There is nobody to panic to.
    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {
            core::hint::spin_loop();
        }
    }
}
