//! Merges sensors that read the same device port.

use super::substitution::Substitution;
use crate::flat_net::FlatNet;
use crate::registers::Register;
use rpi_image::image::{DevicePort, SensorPort};
use rpi_prims::CycleTime;
use rustc_hash::FxHashMap;

pub(super) fn merge_sensors(flat: &mut FlatNet, _: CycleTime) {
    let mut renames = Substitution::new(flat);
    let mut known: FxHashMap<(String, String, u32), Vec<SensorPort>> = FxHashMap::default();
    let sensors = std::mem::take(&mut flat.tables.sensors);
    for (sensor, node) in sensors {
        let same = known.entry(key(&sensor.port)).or_default();
        let alike = |s: &&SensorPort| s.port == sensor.port && is_total(s) == is_total(&sensor);
        if let Some(first) = same.iter().find(alike) {
            renames.set(Register(sensor.value.start), Register(first.value.start));
            renames.set(
                Register(sensor.value.present),
                Register(first.value.present),
            );
            continue;
        }
        same.push(sensor.clone());
        flat.tables.sensors.push((sensor, node));
    }
    renames.apply(flat);
}

fn key(port: &DevicePort) -> (String, String, u32) {
    (port.device.clone(), port.port.clone(), port.index)
}

/// Returns true if the sensor must have a sample in every cycle, so that a missing sample is a fault.
fn is_total(sensor: &SensorPort) -> bool {
    sensor.value.present == Register::TRUE.0
}
