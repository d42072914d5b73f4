//! Device samples and final device states of a run.

use rpi_device::{DeviceBank, ErrorCode, PortKind, PortQuery};
use rpi_image::{Scalar, Type};
use rpi_sim::cell::DeviceKind;
use rpi_sim::{Cell, Report, SimBank};

use super::cycle::DeviceTap;
use super::outcome::{DeviceEnd, DeviceProblem, ProblemPlace};
use super::samples::{Channel, Source};
use super::usage::AxisEnd;

/// Maximum number of distinct problems that are listed per device in the outcome of a run.
const MAX_PROBLEMS: usize = 32;

/// Returns the ports of a device that are sampled in every tick: name, number of instances (such as joints) and type.
fn sampled_ports(kind: &DeviceKind) -> Vec<(&'static str, usize, Scalar)> {
    match kind {
        DeviceKind::Arm(arm) => vec![
            ("joint.commanded_position", arm.joints.len(), Scalar::Real),
            ("tcp.commanded_position", 1, Scalar::Pose),
        ],
        DeviceKind::Io(io) => vec![
            ("in.bool", io.digital.inputs.len(), Scalar::Bool),
            ("out.bool", io.digital.outputs.len(), Scalar::Bool),
            ("in.real", io.analogue.inputs.len(), Scalar::Real),
            ("out.real", io.analogue.outputs.len(), Scalar::Real),
        ],
        DeviceKind::Base(_) | DeviceKind::Small(_) => Vec::new(),
    }
}

/// Returns the device ports of a cell that are sampled in every tick, and their channels. The channels of devices are
/// the first channels of a run.
pub(super) fn taps(cell: &Cell, bank: &mut SimBank) -> (Box<[DeviceTap]>, Vec<Channel>) {
    let (mut taps, mut channels) = (Vec::new(), Vec::new());
    for device in &cell.devices {
        for (port, count, scalar) in sampled_ports(&device.kind) {
            for index in 0..count {
                let name = PortQuery {
                    device: &device.name,
                    port,
                    index: u32::try_from(index).unwrap_or(u32::MAX),
                    kind: PortKind::Sensor,
                    ty: Type::Scalar(scalar),
                };
                let Ok(found) = bank.resolve(&name) else {
                    continue;
                };
                taps.push(DeviceTap {
                    port: found,
                    channel: channels.len(),
                    value: vec![0; scalar.slots() as usize].into(),
                });
                channels.push(Channel {
                    name: channel_name(&device.name, port, index, count),
                    ty: Type::Scalar(scalar),
                    source: Source::Device {
                        device: device.name.clone(),
                        port,
                        index,
                    },
                });
            }
        }
    }
    (taps.into(), channels)
}

/// Returns the channels of the device ports of a cell that are sampled in every tick, in the order of their indices in
/// a tick log. `tick_ns` is the tick length in nanoseconds.
#[must_use]
pub fn sampled_channels(cell: &Cell, tick_ns: u64) -> Vec<Channel> {
    taps(cell, &mut SimBank::new(cell, tick_ns as f64 * 1e-9)).1
}

fn channel_name(device: &str, port: &str, index: usize, count: usize) -> String {
    match count {
        1 => format!("{device}.{port}"),
        _ => format!("{device}.{port}[{index}]"),
    }
}

/// Reads a device port after the devices have moved, and passes the index of its channel and its memory words to
/// `take`; `None` if the port has no sample.
pub(super) fn sample(
    tap: &mut DeviceTap,
    bank: &mut SimBank,
    mut take: impl FnMut(usize, Option<&[u64]>),
) {
    let there = bank.read(tap.port, &mut tap.value);
    take(tap.channel, there.then_some(&*tap.value));
}

/// Returns the final states of the devices, with the problems that they have reported.
pub(super) fn device_ends(bank: &mut SimBank) -> Vec<DeviceEnd> {
    bank.finish();
    let mut ends: Vec<DeviceEnd> = bank
        .status()
        .map(|status| DeviceEnd {
            name: status.name.to_owned(),
            condition: status.code.to_string(),
            moving: status.moving,
            troubles: Vec::new(),
            axes: Vec::new(),
        })
        .collect();
    bank.limit_usage(|name, axis| {
        if let Some(end) = ends.iter_mut().find(|end| end.name == name) {
            end.axes.extend(AxisEnd::of(axis));
        }
    });
    bank.reports(|name, report| {
        if let Some(end) = ends.iter_mut().find(|end| end.name == name) {
            count_problem(&mut end.troubles, &report);
        }
    });
    ends
}

fn count_problem(troubles: &mut Vec<DeviceProblem>, report: &Report) {
    let what = report.code.to_string();
    let known = troubles
        .iter()
        .position(|t| t.what == what && t.axis == report.axis);
    match known {
        Some(k) => troubles[k].times += 1,
        None if troubles.len() < MAX_PROBLEMS => troubles.push(DeviceProblem {
            what,
            is_refusal: !report.code.is_failure() && report.code != ErrorCode::EVENT_MISSED,
            place: ProblemPlace::of(report.code),
            axis: report.axis,
            times: 1,
            first: report.time,
            value: report.value,
            limit: report.limit,
        }),
        None => {}
    }
}
