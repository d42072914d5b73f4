//! Merges sensors that read the same device port.

use super::rename::Renames;
use crate::flat::Flat;
use crate::slots::Slot;
use rpi_image::image::{DevicePort, Sensor};
use rpi_prims::Clock;
use rustc_hash::FxHashMap;

pub(super) fn share(flat: &mut Flat, _: Clock) {
    let mut renames = Renames::new(flat);
    let mut known: FxHashMap<(String, String, u32), Vec<Sensor>> = FxHashMap::default();
    let sensors = std::mem::take(&mut flat.tables.sensors);
    for (sensor, node) in sensors {
        let same = known.entry(key(&sensor.port)).or_default();
        let alike = |s: &&Sensor| s.port == sensor.port && sure(s) == sure(&sensor);
        if let Some(first) = same.iter().find(alike) {
            renames.set(Slot(sensor.value.at), Slot(first.value.at));
            renames.set(Slot(sensor.value.present), Slot(first.value.present));
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

/// True if the sensor must always have a sample. A missing sample is then a fault.
fn sure(sensor: &Sensor) -> bool {
    sensor.value.present == Slot::TRUE.0
}
