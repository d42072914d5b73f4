//! Proof that the real-time crates do not need `std`: `cargo check -p rpi-nostd --features proof`.
//!
//! With the feature, this crate defines its own panic handler. If one of its dependencies links `std`, there are two
//! panic handlers, and compilation fails with error E0152, "found duplicate lang item `panic_impl`", which names the
//! crate responsible. The feature is off in a build of the whole workspace, where cargo unifies the features of all
//! crates and test tools need `std`.

#![no_std]

#[cfg(feature = "proof")]
mod proof {
    extern crate rpi_core as _;
    extern crate rpi_device as _;
    extern crate rpi_image as _;
    extern crate rpi_kin as _;
    extern crate rpi_prims as _;

    /// Panic handler that loops forever: without `std`, no code can report the panic.
    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {
            core::hint::spin_loop();
        }
    }
}
