//! Loops that run one primitive on each group of operand words. There is one dispatch per step, not per group.

use crate::context::Context;
use crate::operand::{Operand, PortTuple, PrimState};

/// Runs the code of a primitive without state, once per group of operand words, on values that are all present. Most
/// steps of a cycle run here.
#[inline(always)]
pub(crate) fn pure<I: Operand, O: Operand>(
    cx: &mut Context<'_>,
    words: &[u32],
    code: impl Fn(I) -> O,
) {
    let cells = &mut *cx.slots;
    // With `chunks_exact` the length of a group is a constant, so the compiler can remove its bounds checks.
    for w in words.chunks_exact(I::WORDS + O::WORDS) {
        code(I::read(cells, w)).write(cells, &w[I::WORDS..]);
    }
}

/// Runs the code of a primitive with state, parameters, times or faults, once per group of operand words. The order of
/// the words in a group is inputs, parameters, outputs, state.
#[inline(always)]
pub(crate) fn with_context<I: Operand, P: Operand, O: Operand, S: PrimState>(
    cx: &mut Context<'_>,
    words: &[u32],
    code: impl Fn(&mut Context<'_>, u32, &mut S, P, I) -> O,
) {
    let (params, outputs) = (I::WORDS, I::WORDS + P::WORDS);
    let state = outputs + O::WORDS;
    for w in words.chunks_exact(state + S::WORDS) {
        let (input, param) = (I::read(cx.slots, w), P::read(cx.slots, &w[params..]));
        let mut memory = S::load(cx.slots, &w[state..]);
        let place = w.get(outputs).copied().unwrap_or(0);
        let output = code(cx, place, &mut memory, param, input);
        memory.store(cx.slots, &w[state..]);
        output.write(cx.slots, &w[outputs..]);
    }
}

/// Runs the code of a primitive whose ports may be absent, with state, parameters, times or faults, on ports that are
/// always present.
#[inline(always)]
pub(crate) fn full_present<I: PortTuple, P: Operand, O: PortTuple, S: PrimState>(
    cx: &mut Context<'_>,
    words: &[u32],
    code: impl Fn(&mut Context<'_>, u32, &mut S, P, I::Options) -> O::Options,
) {
    with_context::<I, P, O, S>(cx, words, |cx, place, s, p, i| {
        O::unwrap_or_neutral(code(cx, place, s, p, i.into_options()))
    });
}

/// Runs the code of a primitive without state whose ports may be absent, on ports that are always present.
#[inline(always)]
pub(crate) fn pure_present<I: PortTuple, O: PortTuple>(
    cx: &mut Context<'_>,
    words: &[u32],
    code: impl Fn(I::Options) -> O::Options,
) {
    pure::<I, O>(cx, words, |i| O::unwrap_or_neutral(code(i.into_options())));
}

/// Runs the code of a primitive all of whose outputs are arrays or matrices, which the code writes itself.
#[inline(always)]
pub(crate) fn bulk<I: Operand, P: Operand, O: Operand>(
    cx: &mut Context<'_>,
    words: &[u32],
    code: impl Fn(&mut Context<'_>, u32, P, I, O),
) {
    let (params, outputs) = (I::WORDS, I::WORDS + P::WORDS);
    for w in words.chunks_exact(outputs + O::WORDS) {
        let (input, param) = (I::read(cx.slots, w), P::read(cx.slots, &w[params..]));
        let output = O::read(cx.slots, &w[outputs..]);
        code(cx, w[outputs], param, input, output);
    }
}

/// Runs the code of a primitive that writes its array outputs itself and returns the single values among its outputs.
#[inline(always)]
pub(crate) fn mixed<I: Operand, P: Operand, O: Operand>(
    cx: &mut Context<'_>,
    words: &[u32],
    code: impl Fn(&mut Context<'_>, u32, P, I, O) -> O,
) {
    let (params, outputs) = (I::WORDS, I::WORDS + P::WORDS);
    for w in words.chunks_exact(outputs + O::WORDS) {
        let (input, param) = (I::read(cx.slots, w), P::read(cx.slots, &w[params..]));
        let output = O::read(cx.slots, &w[outputs..]);
        code(cx, w[outputs], param, input, output).write(cx.slots, &w[outputs..]);
    }
}

/// Runs the code of a primitive that writes one array output itself and returns whether the output is present.
#[inline(always)]
pub(crate) fn bulk_maybe<I: Operand, P: Operand, O: Operand>(
    cx: &mut Context<'_>,
    words: &[u32],
    code: impl Fn(&mut Context<'_>, u32, P, I, O) -> bool,
) {
    let (params, outputs) = (I::WORDS, I::WORDS + P::WORDS);
    let presence = outputs + O::WORDS;
    for w in words.chunks_exact(presence + 1) {
        let (input, param) = (I::read(cx.slots, w), P::read(cx.slots, &w[params..]));
        let output = O::read(cx.slots, &w[outputs..]);
        let present = code(cx, w[outputs], param, input, output);
        cx.slots[w[presence] as usize] = u64::from(present);
    }
}
