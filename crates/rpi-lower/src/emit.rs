//! Code emission: assigns memory slots to registers and writes the image.

mod cells;
mod code;
mod names;

use crate::flat::Flat;
use crate::options::LowerOptions;
use crate::slots::Slot;
use cells::Layouts;
use rpi_image::Image;
use rpi_image::image::{End, MAX_CELLS, Signal};
use rpi_net::Net;

/// Writes the image of a flat net. The error is a message: the command needs too much memory.
pub(crate) fn emit(net: &Net, flat: &Flat, options: &LowerOptions<'_>) -> Result<Image, String> {
    let layouts = Layouts::new(net, flat);
    if layouts.layout.cells > MAX_CELLS {
        let (cells, most) = (layouts.layout.cells, MAX_CELLS);
        return Err(format!(
            "memory limit exceeded: {cells} slots, at most {most} allowed"
        ));
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
    names::write(net, flat, &layouts, options, &mut image);
    Ok(image)
}

/// Writes the tables of the image, with registers replaced by memory slots.
fn tables(flat: &Flat, layouts: &Layouts, image: &mut Image) {
    let t = flat.tables.clone();
    image.sensors = t.sensors.into_iter().map(|s| s.0).collect();
    (image.fragments, image.inputs, image.exports) = (t.fragments, t.inputs, t.exports);
    (image.flows, image.end) = (t.flows, t.end);
    for (fragment, state) in image.fragments.iter_mut().zip(&layouts.states) {
        fragment.active = layouts.cell(Slot(fragment.active));
        fragment.state = *state;
    }
    let signal = |s: &mut Signal| {
        s.at = layouts.cell(Slot(s.at));
        s.present = layouts.cell(Slot(s.present));
    };
    image.sensors.iter_mut().for_each(|s| signal(&mut s.value));
    for i in &mut image.inputs {
        signal(&mut i.value);
        i.updated.iter_mut().for_each(signal);
    }
    image.exports.iter_mut().for_each(|e| signal(&mut e.value));
    image.flows.iter_mut().for_each(|f| signal(&mut f.value));
    match &mut image.end {
        End::Results(results) => results.iter_mut().for_each(|r| signal(&mut r.condition)),
        End::Ports { terminate, fail } => {
            terminate.iter_mut().chain(fail).for_each(signal);
        }
    }
}
