//! Static bounds of the work per cycle, for deciding which commands fit into a tick, and the candidates for the place
//! of an overrun.

use crate::load::catalogue;
use rpi_image::image::{Image, Step};
use rpi_image::operands::{Field, Part, fields, group};
use rpi_image::{PrimDesc, Scalar, Type};

use alloc::boxed::Box;
use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

/// Number of fragments kept as candidates for the place of an overrun. Bounds the search.
const HEAVIEST: usize = 16;
/// Assumed work of a device for a set-point or a function call: about one inverse kinematics.
const DEVICE: u64 = 500;
/// Number of slots that are copied or filled in the time of one elementary operation.
const MOVED: u64 = 4;

/// Bounds of the work per cycle, in elementary operations (a real addition is 1).
pub(crate) struct Weight {
    /// Work of all primitives, as if all fragments were active.
    pub(crate) primitives: u64,
    /// Work besides primitives: devices, jumps, copies, resets of fragments.
    pub(crate) around: u64,
    /// The fragments with the most work of their own, heaviest first. Nested fragments count separately.
    pub(crate) heaviest: Box<[u32]>,
}

impl Weight {
    /// Computes the bounds of a verified image.
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

/// Sum of the work of each fragment's own steps, without nested fragments.
fn own(image: &Image, work: impl Fn(&Step) -> u64) -> Vec<u64> {
    let mut own = vec![0_u64; image.fragments.len()];
    let begins = image.fragments.iter().map(|f| f.active).zip(0_usize..);
    let begins: BTreeMap<u32, usize> = begins.collect();
    // Fragments that enclose the current step, each with its last step (exclusive).
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
    // There are fewer than 2^32 fragments.
    let mut all: Vec<u32> = (0..own.len() as u32).collect();
    all.sort_by_key(|f| (core::cmp::Reverse(own[*f as usize]), *f));
    all.truncate(HEAVIEST);
    all.into()
}

/// Work of a row of primitive calls.
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

/// Work of one primitive call with these operands.
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

/// Type and size of an operand. A state counts as one scalar whatever its size, since a primitive only touches its
/// ends.
fn size(field: Field, words: &[u32]) -> Type {
    match (field.part, field.sizes, words) {
        (Part::State, ..) => Type::One(Scalar::Real),
        (_, 1, [_, len, ..]) => Type::Array(Scalar::Real, *len),
        (_, 2, [_, rows, cols, ..]) => Type::Matrix(*rows, *cols),
        _ => Type::One(Scalar::Real),
    }
}

/// Work of a step that runs no primitive.
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
