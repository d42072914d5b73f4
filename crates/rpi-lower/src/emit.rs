//! Code emission: assigns memory slots to registers and writes the image.

mod code;
mod debug_info;
mod layout;

use crate::flat_net::FlatNet;
use crate::lower_error::LowerError;
use crate::options::LowerOptions;
use crate::registers::Register;
use layout::MemoryLayout;
use rpi_image::Image;
use rpi_image::image::{CommandEnd, MAX_SLOTS, Signal};
use rpi_net::Net;

/// Writes the image, the executable form of a command, of a flat net.
///
/// # Errors
/// Returns an error if the command needs more than [`MAX_SLOTS`] memory slots.
pub(crate) fn emit(
    net: &Net,
    flat: &FlatNet,
    options: &LowerOptions<'_>,
) -> Result<Image, LowerError> {
    let layouts = MemoryLayout::new(net, flat);
    if layouts.layout.end > MAX_SLOTS {
        return Err(LowerError::MemoryLimit {
            slots: layouts.layout.end,
            limit: MAX_SLOTS,
        });
    }
    let mut image = Image {
        name: net.name.clone(),
        period_ns: options.period_ns,
        tick_ns: options.tick_ns,
        layout: layouts.layout,
        init: layouts.init(flat),
        ..Image::default()
    };
    code::write(flat, &layouts, options, &mut image);
    tables(flat, &layouts, &mut image);
    debug_info::write(net, flat, &layouts, options, &mut image);
    Ok(image)
}

/// Copies the tables of the flat net, such as sensors and exports, to the image. Replaces registers by their memory
/// slots.
fn tables(flat: &FlatNet, layouts: &MemoryLayout, image: &mut Image) {
    let t = flat.tables.clone();
    image.sensors = t.sensors.into_iter().map(|s| s.0).collect();
    (image.fragments, image.inputs, image.exports) = (t.fragments, t.inputs, t.exports);
    (image.flows, image.end) = (t.flows, t.end);
    for (fragment, state) in image.fragments.iter_mut().zip(&layouts.states) {
        fragment.active = layouts.slot(Register(fragment.active));
        fragment.state = *state;
    }
    let signal = |s: &mut Signal| {
        s.start = layouts.slot(Register(s.start));
        s.present = layouts.slot(Register(s.present));
    };
    image.sensors.iter_mut().for_each(|s| signal(&mut s.value));
    for i in &mut image.inputs {
        signal(&mut i.value);
        i.last_updated.iter_mut().for_each(signal);
    }
    image.exports.iter_mut().for_each(|e| signal(&mut e.value));
    image.flows.iter_mut().for_each(|f| signal(&mut f.value));
    match &mut image.end {
        CommandEnd::Results(results) => results.iter_mut().for_each(|r| signal(&mut r.condition)),
        CommandEnd::Ports { terminate, fail } => {
            terminate.iter_mut().chain(fail).for_each(signal);
        }
    }
}
