//! Cycle time on this machine, measured with the cold caches that a cycle meets when it runs once per millisecond.

use std::hint::black_box;
use std::time::Instant;

use rpi_core::{CycleContext, Instance};
use rpi_device::NoDevices;
use rpi_image::Image;

use crate::ImageLoadError;

/// Number of bytes written between two measured cycles. It exceeds the cache size of a core, so every cycle starts with
/// cold caches.
const CACHE_FLUSH_BYTES: usize = 32 << 20;

/// Length of a cache line in bytes.
const CACHE_LINE_BYTES: usize = 64;

/// Returns the median time of a cycle of the image in nanoseconds, measured over `cycles` cycles that all start with
/// cold caches.
///
/// The median excludes most delays caused by other programs on the machine.
///
/// # Errors
/// Returns the load errors if the image cannot be loaded.
pub fn cold_cycle_ns(image: Image, cycles: usize) -> Result<u64, ImageLoadError> {
    let mut machine = Instance::load(image, &mut NoDevices).map_err(ImageLoadError)?;
    let mut flushed = vec![0_u8; CACHE_FLUSH_BYTES];
    let mut times: Vec<u64> = (0..cycles.max(1))
        .map(|_| {
            flushed
                .iter_mut()
                .step_by(CACHE_LINE_BYTES)
                .for_each(|byte| *byte = byte.wrapping_add(1));
            // Without it the compiler could remove the writes, and the caches would stay warm.
            black_box(&flushed);
            time_cycle(&mut machine)
        })
        .collect();
    times.sort_unstable();
    // The median: an interrupted cycle can take a hundred times as long and would dominate the mean.
    Ok(times[times.len() / 2])
}

fn time_cycle(machine: &mut Instance) -> u64 {
    let start = Instant::now();
    let bank = &mut NoDevices;
    machine.read(bank, &CycleContext::default());
    machine.evaluate(bank);
    machine.commit();
    machine.hand_over(bank);
    u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
}
