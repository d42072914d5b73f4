//! How much an image has to do in a cycle at most, and where: a bound for who decides what may run together, and the places to
//! look at when a cycle took too long.

use crate::load::catalogue;
use rpi_image::image::{Image, Step};
use rpi_image::operands::{Field, Part, fields, group};
use rpi_image::{PrimDesc, Scalar, Type};

use alloc::boxed::Box;
use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

/// Fragments that are told apart: to look for the one that was at work takes no longer than this.
const HEAVIEST: usize = 16;
/// What a device may take for a set-point or a function: about an inverse kinematics.
const DEVICE: u64 = 500;
/// Cells that are moved or filled in the time of an elementary operation.
const MOVED: u64 = 4;

/// Bounds in elementary operations (a real addition is 1).
pub(crate) struct Weight {
    /// All primitives, as if all fragments were active.
    pub(crate) primitives: u64,
    /// What is done around them: devices, jumps, copies, fragments that start afresh.
    pub(crate) around: u64,
    /// The fragments with the most primitives of their own, the heaviest first; those of fragments inside are theirs.
    pub(crate) heaviest: Box<[u32]>,
}

impl Weight {
    /// Of a verified image.
    pub(crate) fn of(image: &Image) -> Weight {
        let prims = image.prims.iter().map(|used| catalogue(&used.name));
        let prims: Vec<Option<&PrimDesc>> = prims.collect();
        let own = own(image, |step| primitives(image, &prims, step));
        let steps = image.steps.iter().chain(&image.commit);
        let outside = image.sensors.len() + image.inputs.len() + image.exports.len();
        Weight {
            primitives: own.iter().fold(0, |sum, own| sum.saturating_add(*own)),
            around: steps.map(|step| around(image, step)).sum::<u64>() + outside as u64,
            heaviest: heaviest(&own),
        }
    }
}

/// What the steps of each fragment add up to.
fn own(image: &Image, work: impl Fn(&Step) -> u64) -> Vec<u64> {
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
            *own = own.saturating_add(work(step));
        }
        if let Step::Skip { unless, to } = step
            && let Some(fragment) = begins.get(unless)
        {
            open.push((*fragment, *to as usize));
        }
    }
    own
}

fn heaviest(own: &[u64]) -> Box<[u32]> {
    // Fewer than 2^32 fragments.
    let mut all: Vec<u32> = (0..own.len() as u32).collect();
    all.sort_by_key(|f| (core::cmp::Reverse(own[*f as usize]), *f));
    all.truncate(HEAVIEST);
    all.into()
}

/// The bound of a row of primitives.
fn primitives(image: &Image, prims: &[Option<&PrimDesc>], step: &Step) -> u64 {
    let Step::Run {
        prim,
        form,
        at,
        len,
    } = *step
    else {
        return 0;
    };
    let words = image.code.get(at as usize..(at as usize + len as usize));
    let (Some(Some(desc)), Some(words)) = (prims.get(usize::from(prim)), words) else {
        return 0;
    };
    let fields = fields(desc, form);
    let groups = words.chunks_exact(group(&fields).max(1));
    groups.fold(0, |sum, words| {
        sum.saturating_add(of_one(desc, &fields, words))
    })
}

/// The bound of a primitive with these operands.
fn of_one(desc: &PrimDesc, fields: &[Field], words: &[u32]) -> u64 {
    let mut words = words;
    let mut factor = 1;
    for field in fields {
        let (mine, rest) = words.split_at(field.words().min(words.len()));
        words = rest;
        factor = size(*field, mine).work_factor().max(factor);
    }
    u64::from(desc.work).saturating_mul(factor)
}

/// How large an operand is; a state is as large as it likes, since only its ends are looked at.
fn size(field: Field, words: &[u32]) -> Type {
    match (field.part, field.sizes, words) {
        (Part::State, ..) => Type::One(Scalar::Real),
        (_, 1, [_, len, ..]) => Type::Array(Scalar::Real, *len),
        (_, 2, [_, rows, cols, ..]) => Type::Matrix(*rows, *cols),
        _ => Type::One(Scalar::Real),
    }
}

/// The bound of a step that runs no primitive.
fn around(image: &Image, step: &Step) -> u64 {
    match *step {
        Step::Run { .. } => 0,
        Step::Copy { len, .. } => u64::from(len).div_ceil(MOVED),
        Step::Skip { .. } => 1,
        Step::Reset { fragment, .. } => {
            let fragment = image.fragments.get(fragment as usize);
            fragment.map_or(0, |f| u64::from(f.state.len).div_ceil(MOVED) + 1)
        }
        Step::Actuate { .. } | Step::Call { .. } => DEVICE,
    }
}
