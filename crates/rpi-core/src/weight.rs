//! How much the fragments of an image have to do: where a cycle that took too long was most likely at work.

use crate::load::catalogue;
use rpi_image::image::{Image, Step};
use rpi_image::operands::{fields, group};

use alloc::boxed::Box;
use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

/// Fragments that are told apart: to look for the one that was at work takes no longer than this.
const HEAVIEST: usize = 16;

/// The fragments with the most work of their own, in elementary operations and the heaviest first; that of fragments inside is theirs.
pub(crate) fn heaviest(image: &Image) -> Box<[u32]> {
    let mut own = vec![0_u64; image.fragments.len()];
    let begins = image.fragments.iter().map(|f| f.active).zip(0_usize..);
    let begins: BTreeMap<u32, usize> = begins.collect();
    // Fragments that enclose the present step, with the step at which they end.
    let mut open: Vec<(usize, usize)> = Vec::new();
    for (at, step) in image.steps.iter().enumerate() {
        while open.last().is_some_and(|(_, end)| *end <= at) {
            open.pop();
        }
        let fragment = open.last().map_or(0, |(fragment, _)| *fragment);
        if let Some(own) = own.get_mut(fragment) {
            *own += work(image, step);
        }
        if let Step::Skip { unless, to } = step
            && let Some(fragment) = begins.get(unless)
        {
            open.push((*fragment, *to as usize));
        }
    }
    // Fewer than 2^32 fragments.
    let mut all: Vec<u32> = (0..own.len() as u32).collect();
    all.sort_by_key(|f| (core::cmp::Reverse(own[*f as usize]), *f));
    all.truncate(HEAVIEST);
    all.into()
}

/// The bound of a step in elementary operations.
fn work(image: &Image, step: &Step) -> u64 {
    match *step {
        Step::Run {
            prim, form, len, ..
        } => {
            let desc = image.prims.get(usize::from(prim));
            let desc = desc.and_then(|prim| catalogue(&prim.name));
            desc.map_or(0, |desc| {
                let words = group(&fields(desc, form)).max(1);
                u64::from(desc.work) * (len as usize / words) as u64
            })
        }
        Step::Copy { len, .. } => u64::from(len) / 2,
        Step::Skip { .. } | Step::Reset { .. } => 1,
        Step::Actuate { .. } | Step::Call { .. } => DEVICE,
    }
}

/// What a device may take for a set-point or a function: about an inverse kinematics.
const DEVICE: u64 = 200;
