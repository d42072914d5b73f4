//! Loops that run one primitive on each group of operand words. There is one dispatch per step, not per group.

use crate::cx::Cx;
use crate::operand::{Memory, Operand, Row};

/// Runs pure code on present values. This is the hot path.
#[inline(always)]
pub(crate) fn pure<I: Operand, O: Operand>(cx: &mut Cx<'_>, words: &[u32], code: impl Fn(I) -> O) {
    let cells = &mut *cx.cells;
    for w in words.chunks_exact(I::WORDS + O::WORDS) {
        code(I::get(cells, w)).put(cells, &w[I::WORDS..]);
    }
}

/// Runs code with state, parameters, clocks or faults. The order of words is inputs, parameters, outputs, state.
#[inline(always)]
pub(crate) fn full<I: Operand, P: Operand, O: Operand, S: Memory>(
    cx: &mut Cx<'_>,
    words: &[u32],
    code: impl Fn(&mut Cx<'_>, u32, &mut S, P, I) -> O,
) {
    let (params, outputs) = (I::WORDS, I::WORDS + P::WORDS);
    let state = outputs + O::WORDS;
    for w in words.chunks_exact(state + S::WORDS) {
        let (input, param) = (I::get(cx.cells, w), P::get(cx.cells, &w[params..]));
        let mut memory = S::load(cx.cells, &w[state..]);
        let place = w.get(outputs).copied().unwrap_or(0);
        let output = code(cx, place, &mut memory, param, input);
        memory.store(cx.cells, &w[state..]);
        output.put(cx.cells, &w[outputs..]);
    }
}

/// Runs code with options as arguments and results on ports that are always present. See [`full`].
#[inline(always)]
pub(crate) fn full_present<I: Row, P: Operand, O: Row, S: Memory>(
    cx: &mut Cx<'_>,
    words: &[u32],
    code: impl Fn(&mut Cx<'_>, u32, &mut S, P, I::Maybe) -> O::Maybe,
) {
    full::<I, P, O, S>(cx, words, |cx, place, s, p, i| {
        O::expect(code(cx, place, s, p, i.present()))
    });
}

/// Runs pure code with options as arguments and results on ports that are always present. See [`pure`].
#[inline(always)]
pub(crate) fn pure_present<I: Row, O: Row>(
    cx: &mut Cx<'_>,
    words: &[u32],
    code: impl Fn(I::Maybe) -> O::Maybe,
) {
    pure::<I, O>(cx, words, |i| O::expect(code(i.present())));
}

/// Runs code that writes its array outputs itself.
#[inline(always)]
pub(crate) fn bulk<I: Operand, P: Operand, O: Operand>(
    cx: &mut Cx<'_>,
    words: &[u32],
    code: impl Fn(&mut Cx<'_>, u32, P, I, O),
) {
    let (params, outputs) = (I::WORDS, I::WORDS + P::WORDS);
    for w in words.chunks_exact(outputs + O::WORDS) {
        let (input, param) = (I::get(cx.cells, w), P::get(cx.cells, &w[params..]));
        let output = O::get(cx.cells, &w[outputs..]);
        code(cx, w[outputs], param, input, output);
    }
}

/// Runs code that writes its array outputs itself and returns the single values among the outputs.
#[inline(always)]
pub(crate) fn mixed<I: Operand, P: Operand, O: Operand>(
    cx: &mut Cx<'_>,
    words: &[u32],
    code: impl Fn(&mut Cx<'_>, u32, P, I, O) -> O,
) {
    let (params, outputs) = (I::WORDS, I::WORDS + P::WORDS);
    for w in words.chunks_exact(outputs + O::WORDS) {
        let (input, param) = (I::get(cx.cells, w), P::get(cx.cells, &w[params..]));
        let output = O::get(cx.cells, &w[outputs..]);
        code(cx, w[outputs], param, input, output).put(cx.cells, &w[outputs..]);
    }
}

/// Runs code that writes one array output and returns whether it is present. See [`bulk`].
#[inline(always)]
pub(crate) fn bulk_maybe<I: Operand, P: Operand, O: Operand>(
    cx: &mut Cx<'_>,
    words: &[u32],
    code: impl Fn(&mut Cx<'_>, u32, P, I, O) -> bool,
) {
    let (params, outputs) = (I::WORDS, I::WORDS + P::WORDS);
    let presence = outputs + O::WORDS;
    for w in words.chunks_exact(presence + 1) {
        let (input, param) = (I::get(cx.cells, w), P::get(cx.cells, &w[params..]));
        let output = O::get(cx.cells, &w[outputs..]);
        let present = code(cx, w[outputs], param, input, output);
        cx.cells[w[presence] as usize] = u64::from(present);
    }
}
