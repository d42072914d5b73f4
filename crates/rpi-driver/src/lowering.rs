//! Lowering of checked nets to images.

use rpi_image::Image;
pub use rpi_lower::LowerError;
use rpi_lower::LowerOptions;

use crate::analysed_net::AnalysedNet;

/// Lowers a checked net for execution: only the outputs of the command can be observed.
///
/// # Errors
/// If the net is too large.
pub fn lower_for_execution(net: &AnalysedNet, period_ns: u64) -> Result<Image, LowerError> {
    lower(net, &LowerOptions::running(period_ns))
}

/// Like [`lower_for_execution`], and also returns the work bound of a cycle in elementary operations. Of mutually exclusive
/// fragments only the most expensive counts.
///
/// # Errors
/// As [`lower_for_execution`].
pub fn lower_with_work(net: &AnalysedNet, period_ns: u64) -> Result<(Image, u64), LowerError> {
    lower_for_tick(net, period_ns, period_ns)
}

/// Like [`lower_with_work`] for a core whose tick, in ns, is shorter than the period.
///
/// # Errors
/// As [`lower_for_execution`].
pub fn lower_for_tick(
    net: &AnalysedNet,
    period_ns: u64,
    tick_ns: u64,
) -> Result<(Image, u64), LowerError> {
    let options = LowerOptions::running(period_ns).with_tick(tick_ns);
    lower(net, &options).map(|image| (image, net.work_bound()))
}

/// Lowers a checked net for observation: every port can be observed.
///
/// # Errors
/// If the net is too large.
pub fn lower_for_observation(net: &AnalysedNet, period_ns: u64) -> Result<Image, LowerError> {
    lower(net, &LowerOptions::observed(period_ns))
}

/// Lowers a checked net.
pub(crate) fn lower(net: &AnalysedNet, options: &LowerOptions<'_>) -> Result<Image, LowerError> {
    rpi_lower::lower(net, &net.plan(), options)
}
