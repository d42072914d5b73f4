//! The steps of an image with primitives resolved to function pointers.

use rpi_image::image::{Form, Image, SlotRange, Step};
use rpi_prims::{PrimId, RunFn};

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

/// A step of an image with its primitive resolved to a function pointer, ready to be executed.
#[derive(Clone, Copy)]
pub(crate) enum ExecutableStep {
    /// Calls the function `code` of a primitive several times, one call after another; `words` is the range of the
    /// operands of all calls in the image's code.
    Run { code: RunFn, words: SlotRange },
    /// Copies single slots of memory: `words` is the range of pairs (from, to) in the image's code.
    Copy { words: SlotRange },
    /// Jumps to step `to` unless one of the fragments with these guards is active; see [`Guard`].
    Skip { guards: SlotRange, to: u32 },
    /// Restores the initial state of a fragment unless slot `unless` is true.
    Reset { unless: u32, fragment: u32 },
    /// Checks the set-point for actuator number `actuator` of the image and prepares it for its device.
    Actuate { actuator: u32 },
    /// Calls device function number `function` of the image, such as the planning of a motion.
    Call { function: u32 },
}

/// Guard of a fragment: makes the program skip the fragment while it is inactive. Guards of fragments that follow one
/// another form one chain that is tested in one loop; the first true guard enters its fragment. An inactive fragment
/// thus costs one memory read and no jump.
#[derive(Clone, Copy)]
pub(crate) struct Guard {
    /// Slot of the Boolean that is true while the fragment is active.
    pub(crate) cell: u32,
    /// Index of the first step inside the fragment.
    pub(crate) inside: u32,
}

/// Executable list of steps, with the guards of its fragments.
#[derive(Clone)]
pub(crate) struct Program {
    pub(crate) ops: Box<[ExecutableStep]>,
    pub(crate) guards: Box<[Guard]>,
}

impl Program {
    /// Returns the index of the next step: inside the fragment of the first true guard, or `to` if no guard is true.
    #[inline(always)]
    pub(crate) fn next_step(&self, cells: &[u64], guards: SlotRange, to: u32) -> usize {
        let open = self.guards[guards.range()]
            .iter()
            .find(|g| cells[g.cell as usize] != 0);
        open.map_or(to, |g| g.inside) as usize
    }

    /// Translates steps of a verified image to executable steps.
    pub(crate) fn new(image: &Image, steps: &[Step]) -> Self {
        let mut program = Program {
            ops: resolve_steps(image, steps),
            guards: Box::default(),
        };
        program.chain(steps);
        program
    }

    /// Merges skips whose targets are skips into chains, which are tested in one loop. Each skip belongs to one chain.
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
                self.ops[at] = ExecutableStep::Skip {
                    guards: SlotRange { start: place, len },
                    to,
                };
            }
        }
        self.guards = guards.into();
    }
}

/// Returns the chain of skips that starts at step `pc`: each skip jumps to the next one, up to a skip that already
/// belongs to a chain. Each entry is (index of the step, slot of the guard, target step).
fn chain_from(steps: &[Step], chained: &[bool], pc: usize) -> Vec<(usize, u32, u32)> {
    let skip = |at: usize| match steps.get(at) {
        Some(Step::Skip { unless, target: to }) if !chained[at] => Some((at, *unless, *to)),
        _ => None,
    };
    core::iter::successors(skip(pc), |(_, _, to)| skip(*to as usize)).collect()
}

/// Translates steps one to one. [`Program::new`] adds the guards of skips afterwards.
fn resolve_steps(image: &Image, steps: &[Step]) -> Box<[ExecutableStep]> {
    let code = |prim: u16, form: Form| -> RunFn {
        let name = image
            .prims_used
            .get(usize::from(prim))
            .map_or("", |p| &p.name);
        let prim = PrimId::from_name(name).map(PrimId::prim);
        let code = prim.and_then(|p| match form {
            Form::Total => p.total,
            Form::Optional => p.optional,
        });
        // The verifier accepts only images whose primitives exist, so the fallback is never called.
        code.unwrap_or(|_, _| {})
    };
    let op = |step: &Step| match *step {
        Step::Run {
            prim,
            form,
            start: at,
            len,
        } => ExecutableStep::Run {
            code: code(prim, form),
            words: SlotRange { start: at, len },
        },
        Step::Copy { at, len } => ExecutableStep::Copy {
            words: SlotRange { start: at, len },
        },
        Step::Skip { target: to, .. } => ExecutableStep::Skip {
            guards: SlotRange::default(),
            to,
        },
        Step::Reset { unless, fragment } => ExecutableStep::Reset { unless, fragment },
        Step::Actuate { actuator } => ExecutableStep::Actuate { actuator },
        Step::Call { function } => ExecutableStep::Call { function },
    };
    steps.iter().map(op).collect()
}

/// Copies single slots of `cells`: `words` holds pairs (from, to) of slot indices.
pub(crate) fn copy_slots(cells: &mut [u64], words: &[u32]) {
    for pair in words.chunks_exact(2) {
        cells[pair[1] as usize] = cells[pair[0] as usize];
    }
}
