//! Static bounds of the work per cycle, for deciding which commands fit into a tick, and the candidates for the place
//! of an overrun.

use crate::load::prim_desc;
use rpi_image::image::{Image, Step};
use rpi_image::operands::{Operand, OperandRole, group_words, operand_layout};
use rpi_image::{PrimDesc, Scalar, Type};

use alloc::boxed::Box;
use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

/// Number of fragments that are considered as the place of an overrun. It bounds the search for the heaviest active
/// one.
const MAX_CANDIDATES: usize = 16;
/// Assumed work of a device for one set-point, in elementary operations (a real addition is 1): about that of one
/// inverse kinematics.
const DEVICE_WORK: u64 = 500;
/// Assumed number of slots that are copied or filled in the time of one elementary operation (a real addition).
const SLOTS_PER_OPERATION: u64 = 4;

/// Bounds of the work per cycle, in elementary operations (a real addition is 1).
#[derive(Clone)]
pub(crate) struct WorkBound {
    /// Work of all primitives (basic operations) while all fragments are active.
    pub(crate) primitives: u64,
    /// Work of everything except primitives: devices, jumps, copies, resets of fragments.
    pub(crate) overhead: u64,
    /// Indices of the fragments whose own steps have the most work, heaviest first. Nested fragments count separately.
    pub(crate) heaviest: Box<[u32]>,
}

impl WorkBound {
    /// Computes the bounds of the work of a verified image.
    pub(crate) fn for_image(image: &Image) -> WorkBound {
        let prims = image.prims_used.iter().map(|used| prim_desc(&used.name));
        let prims: Vec<Option<&PrimDesc>> = prims.collect();
        let own = own_work(image, |step| row_work(image, &prims, step));
        let steps = image.steps.iter().chain(&image.commit);
        let outside = image.sensors.len() + image.inputs.len() + image.exports.len();
        WorkBound {
            primitives: own.iter().fold(0, |sum, own| sum.saturating_add(*own)),
            overhead: steps.map(|step| overhead(image, step)).sum::<u64>() + outside as u64,
            heaviest: heaviest(&own),
        }
    }
}

/// Returns, for each fragment, the sum of the work of its own steps, without nested fragments.
fn own_work(image: &Image, work: impl Fn(&Step) -> u64) -> Vec<u64> {
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
        if let Step::Skip { unless, target: to } = step
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
    all.truncate(MAX_CANDIDATES);
    all.into()
}

/// Returns the work of a step that calls the same primitive several times; 0 for other steps.
fn row_work(image: &Image, prims: &[Option<&PrimDesc>], step: &Step) -> u64 {
    let Step::Run {
        prim,
        form,
        start: at,
        len,
    } = *step
    else {
        return 0;
    };
    let words = image.code.get(at as usize..(at as usize + len as usize));
    let (Some(Some(desc)), Some(words)) = (prims.get(usize::from(prim)), words) else {
        return 0;
    };
    let fields = operand_layout(desc, form);
    let groups = words.chunks_exact(group_words(&fields).max(1));
    groups.fold(0, |sum, words| {
        sum.saturating_add(call_work(desc, &fields, words))
    })
}

/// Returns the work of one call of a primitive with the operands in `words`, laid out as in `fields`.
fn call_work(desc: &PrimDesc, fields: &[Operand], words: &[u32]) -> u64 {
    let mut words = words;
    let mut factor = 1;
    for field in fields {
        let (mine, rest) = words.split_at(field.words().min(words.len()));
        words = rest;
        factor = operand_type(*field, mine).work_factor().max(factor);
    }
    u64::from(desc.work).saturating_mul(factor)
}

/// Returns type and size of an operand. A state counts as one scalar whatever its size, since a primitive only touches
/// its ends.
fn operand_type(field: Operand, words: &[u32]) -> Type {
    match (field.role, field.size_words, words) {
        (OperandRole::State, ..) => Type::Scalar(Scalar::Real),
        (_, 1, [_, len, ..]) => Type::Array(Scalar::Real, *len),
        (_, 2, [_, rows, cols, ..]) => Type::Matrix(*rows, *cols),
        _ => Type::Scalar(Scalar::Real),
    }
}

/// Returns the work of a step that runs no primitive: copy, skip, reset, set-point or device call.
fn overhead(image: &Image, step: &Step) -> u64 {
    match *step {
        Step::Run { .. } => 0,
        Step::Copy { len, .. } => u64::from(len).div_ceil(SLOTS_PER_OPERATION),
        Step::Skip { .. } => 1,
        Step::Reset { fragment, .. } => {
            let fragment = image.fragments.get(fragment as usize);
            fragment.map_or(0, |f| {
                u64::from(f.state.len).div_ceil(SLOTS_PER_OPERATION) + 1
            })
        }
        Step::Actuate { .. } => DEVICE_WORK,
        Step::Call { function } => {
            let function = image.functions.get(function as usize);
            function.map_or(DEVICE_WORK, |f| u64::from(f.work))
        }
    }
}
