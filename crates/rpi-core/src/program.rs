//! The steps of an image with names resolved to code: what a machine walks through.

use rpi_image::image::{Cells, Form, Image, Step};
use rpi_prims::{PrimId, RunFn};

use alloc::boxed::Box;

/// A step, ready to run.
#[derive(Clone, Copy)]
pub(crate) enum Op {
    /// A row of equal primitives.
    Run { code: RunFn, words: Cells },
    /// Pairs of cells (from, to).
    Copy { words: Cells },
    /// A jump unless the cell is true.
    Skip { unless: u32, to: u32 },
    /// Initial state for a fragment unless the cell is true.
    Reset { unless: u32, fragment: u32 },
    /// A set-point.
    Actuate { actuator: u32 },
    /// A device function.
    Call { function: u32 },
}

/// The step lists of a verified image.
pub(crate) fn resolve(image: &Image, steps: &[Step]) -> Box<[Op]> {
    let code = |prim: u16, form: Form| -> RunFn {
        let name = image.prims.get(usize::from(prim)).map_or("", |p| &p.name);
        let prim = PrimId::of(name).map(PrimId::prim);
        let code = prim.and_then(|p| match form {
            Form::Total => p.total,
            Form::Optional => p.optional,
        });
        // The verifier has found every primitive; without code there is nothing to run.
        code.unwrap_or(|_, _| {})
    };
    let op = |step: &Step| match *step {
        Step::Run {
            prim,
            form,
            at,
            len,
        } => Op::Run {
            code: code(prim, form),
            words: Cells { at, len },
        },
        Step::Copy { at, len } => Op::Copy {
            words: Cells { at, len },
        },
        Step::Skip { unless, to } => Op::Skip { unless, to },
        Step::Reset { unless, fragment } => Op::Reset { unless, fragment },
        Step::Actuate { actuator } => Op::Actuate { actuator },
        Step::Call { function } => Op::Call { function },
    };
    steps.iter().map(op).collect()
}

/// Copies single cells: pairs (from, to).
pub(crate) fn copy(cells: &mut [u64], words: &[u32]) {
    for pair in words.chunks_exact(2) {
        cells[pair[1] as usize] = cells[pair[0] as usize];
    }
}
