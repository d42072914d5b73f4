//! The steps of an image with names resolved to code: what a machine walks through.

use rpi_image::image::{Cells, Form, Image, Step};
use rpi_prims::{PrimId, RunFn};

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

/// A step, ready to run.
#[derive(Clone, Copy)]
pub(crate) enum Op {
    /// A row of equal primitives.
    Run { code: RunFn, words: Cells },
    /// Pairs of cells (from, to).
    Copy { words: Cells },
    /// Jumps over what is inactive: see [`Guard`].
    Skip { guards: Cells, to: u32 },
    /// Initial state for a fragment unless the cell is true.
    Reset { unless: u32, fragment: u32 },
    /// A set-point.
    Actuate { actuator: u32 },
    /// A device function.
    Call { function: u32 },
}

/// A skip of the image. Where one lands on another, as fragments side by side do, they are asked in one go: the first
/// whose cell is true tells where to go on. So a fragment that is inactive costs one look at its cell and no jump.
#[derive(Clone, Copy)]
pub(crate) struct Guard {
    /// A Boolean cell.
    pub(crate) cell: u32,
    /// The step behind the skip.
    pub(crate) inside: u32,
}

/// A step list, ready to run.
pub(crate) struct Program {
    pub(crate) ops: Box<[Op]>,
    pub(crate) guards: Box<[Guard]>,
}

impl Program {
    /// Where to go on: inside of the first of these guards that is true, or behind them all.
    #[inline(always)]
    pub(crate) fn pass(&self, cells: &[u64], guards: Cells, to: u32) -> usize {
        let open = self.guards[guards.range()]
            .iter()
            .find(|g| cells[g.cell as usize] != 0);
        open.map_or(to, |g| g.inside) as usize
    }

    /// Resolves the steps of a verified image.
    pub(crate) fn new(image: &Image, steps: &[Step]) -> Self {
        let mut program = Program {
            ops: resolve(image, steps),
            guards: Box::default(),
        };
        program.chain(steps);
        program
    }

    /// Joins skips that land on skips; each belongs to one chain.
    fn chain(&mut self, steps: &[Step]) {
        let mut guards = Vec::new();
        let mut chained = vec![false; steps.len()];
        for pc in 0..steps.len() {
            if chained[pc] {
                continue;
            }
            let chain = chain_from(steps, &chained, pc);
            let first = guards.len() as u32;
            let end = first + chain.len() as u32;
            let to = chain.last().map_or(0, |last| last.2);
            for (place, (at, cell, _)) in (first..).zip(chain) {
                chained[at] = true;
                let inside = at as u32 + 1;
                guards.push(Guard { cell, inside });
                let len = end - place;
                self.ops[at] = Op::Skip {
                    guards: Cells { at: place, len },
                    to,
                };
            }
        }
        self.guards = guards.into();
    }
}

/// The skip at `pc` and all on which it and its followers land, up to one that has its chain: place, cell, target.
fn chain_from(steps: &[Step], chained: &[bool], pc: usize) -> Vec<(usize, u32, u32)> {
    let skip = |at: usize| match steps.get(at) {
        Some(Step::Skip { unless, to }) if !chained[at] => Some((at, *unless, *to)),
        _ => None,
    };
    core::iter::successors(skip(pc), |(_, _, to)| skip(*to as usize)).collect()
}

/// The steps one by one; skips get their guards later.
fn resolve(image: &Image, steps: &[Step]) -> Box<[Op]> {
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
        Step::Skip { to, .. } => Op::Skip {
            guards: Cells::default(),
            to,
        },
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
