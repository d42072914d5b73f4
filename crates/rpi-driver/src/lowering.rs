//! Lowering of checked nets to images.

use rpi_image::Image;
pub use rpi_lower::LowerError;
use rpi_lower::LowerOptions;

use crate::analysed_net::AnalysedNet;

/// Lowers a net to an image for execution: only its exports can be observed. `period_ns` is the period of a cycle in
/// nanoseconds.
///
/// # Errors
/// If the net is too large.
pub fn lower_for_execution(net: &AnalysedNet, period_ns: u64) -> Result<Image, LowerError> {
    lower(net, &LowerOptions::running(period_ns))
}

/// Lowers a net to an image for execution: only its exports can be observed. `period_ns` is the period of a cycle in
/// nanoseconds. Also returns the upper bound on the work of a cycle in elementary operations; of mutually exclusive
/// fragments only the most expensive counts.
///
/// # Errors
/// If the net is too large.
pub fn lower_with_work(net: &AnalysedNet, period_ns: u64) -> Result<(Image, u64), LowerError> {
    lower_for_tick(net, period_ns, period_ns)
}

/// Lowers a net to an image for execution on a core whose tick (`tick_ns`) may be shorter than the period of the
/// command (`period_ns`), both in nanoseconds. Also returns the upper bound on the work of a cycle in elementary
/// operations.
///
/// # Errors
/// If the net is too large.
pub fn lower_for_tick(
    net: &AnalysedNet,
    period_ns: u64,
    tick_ns: u64,
) -> Result<(Image, u64), LowerError> {
    let options = LowerOptions::running(period_ns).with_tick(tick_ns);
    lower(net, &options).map(|image| (image, net.work_bound()))
}

/// Lowers a net to an image in which every port can be observed. `period_ns` is the period of a cycle in nanoseconds.
///
/// # Errors
/// If the net is too large.
pub fn lower_for_observation(net: &AnalysedNet, period_ns: u64) -> Result<Image, LowerError> {
    lower(net, &LowerOptions::observed(period_ns))
}

/// Lowers a net to an image in which every port can be observed, for a core whose tick (`tick_ns`) may be shorter than the period of
/// the command (`period_ns`), both in nanoseconds.
///
/// # Errors
/// If the net is too large.
pub fn lower_for_observation_in_tick(
    net: &AnalysedNet,
    period_ns: u64,
    tick_ns: u64,
) -> Result<Image, LowerError> {
    lower(net, &LowerOptions::observed(period_ns).with_tick(tick_ns))
}

/// Lowers a net to an image. `options` set the period, the tick and the ports that can be observed.
pub(crate) fn lower(net: &AnalysedNet, options: &LowerOptions<'_>) -> Result<Image, LowerError> {
    rpi_lower::lower(net, &net.plan(), options)
}
