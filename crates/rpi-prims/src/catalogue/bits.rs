//! Numbers as rows of Booleans, as field buses carry them. Element 0 is the lowest bit.

use crate::bulk::Array;
use crate::cx::{Cx, FaultCode};
use crate::macros::primitive;
use crate::registry::Prim;
use rpi_image::Shape;

pub(super) const ALL: &[Prim] = &[BIN_TO_DEC, DEC_TO_BIN, BCD_TO_DEC, DEC_TO_BCD];

primitive! {
    /// The number whose `amountBits` binary digits are the first elements; with `signBit` in two's complement. At most 63 bits
    /// count.
    BIN_TO_DEC = "Core::BinToDec";
    in { inArray: Array<bool> }
    param { amountBits: i64 = Int(8); signBit: bool = Bool(false) }
    out { outValue: i64 }
    presence strict work 64;
    full |cx, _, _, (bits, signed), (array,)| {
        let bits = width(array, bits);
        let value = number(cx.cells, array, 0, bits);
        let negative = signed && bits > 0 && value >> (bits - 1) == 1;
        (if negative { value - (1 << bits) } else { value },)
    }
}

primitive! {
    /// The `amountBits` lowest binary digits of a number; with `signBit` in two's complement. The overflow bit is true if it
    /// needs more.
    DEC_TO_BIN = "Core::DecToBin";
    in { inValue: i64 }
    param { amountBits: i64 = Int(8); signBit: bool = Bool(false) }
    out { outArray: Array<bool>; overflowBit: bool }
    shape Shape::Size("amountBits");
    presence strict work 64;
    mixed |cx, _, (_, signed), (value,), (array, _)| {
        let bits = array.len().min(63);
        for k in 0..array.len() {
            array.set(cx.cells, k as i64, (value >> k.min(63)) & 1 == 1);
        }
        let (least, beyond) = if signed { (-((1 << bits) >> 1), (1 << bits) >> 1) } else { (0, 1 << bits) };
        (array, !(least..beyond).contains(&value))
    }
}

primitive! {
    /// The number whose binary coded decimal digits, four bits each, are the first `amountBits` elements; with `signBit` the
    /// last of these is its sign. A digit above 9 is a fault.
    BCD_TO_DEC = "Core::BCDToDec";
    in { inArray: Array<bool> }
    param { amountBits: i64 = Int(16); signBit: bool = Bool(true) }
    out { outValue: i64 }
    presence strict work 64 faults;
    full |cx, place, _, (bits, signed), (array,)| {
        let bits = width(array, bits);
        let digits = bits - usize::from(signed && bits > 0);
        let value = decimal(cx, place, array, digits);
        let negative = digits < bits && array.get(cx.cells, digits as i64) == Some(true);
        (if negative { -value } else { value },)
    }
}

primitive! {
    /// A number as binary coded decimal digits, four bits each, in `amountBits` elements; with `signBit` the last of these is
    /// its sign. The overflow bit is true if it does not fit.
    DEC_TO_BCD = "Core::DecToBCD";
    in { inValue: i64 }
    param { amountBits: i64 = Int(16); signBit: bool = Bool(true) }
    out { outArray: Array<bool>; overflowBit: bool }
    shape Shape::Size("amountBits");
    presence strict work 64;
    mixed |cx, _, (_, signed), (value,), (array, _)| {
        let digits = array.len() - usize::from(signed && !array.is_empty());
        let mut rest = value.unsigned_abs();
        for first in (0..digits).step_by(4) {
            for k in first..digits.min(first + 4) {
                array.set(cx.cells, k as i64, ((rest % 10) >> (k - first)) & 1 == 1);
            }
            let room = 1 << (digits - first).min(4);
            rest = if rest % 10 < room { rest / 10 } else { u64::MAX };
        }
        array.set(cx.cells, digits as i64, value < 0);
        (array, rest > 0 || (value < 0 && digits == array.len()))
    }
}

/// How many elements carry the number.
fn width(array: Array<bool>, bits: i64) -> usize {
    usize::try_from(bits).unwrap_or(0).min(array.len()).min(63)
}

fn number(cells: &[u64], array: Array<bool>, first: usize, bits: usize) -> i64 {
    let bit = |k: usize| i64::from(array.get(cells, (first + k) as i64) == Some(true)) << k;
    (0..bits).map(bit).sum()
}

fn decimal(cx: &mut Cx<'_>, place: u32, array: Array<bool>, bits: usize) -> i64 {
    let mut value = 0;
    for first in (0..bits).step_by(4).rev() {
        let digit = number(cx.cells, array, first, (bits - first).min(4));
        if digit > 9 {
            cx.fault(FaultCode::LossyConversion, place);
        }
        value = value * 10 + digit.min(9);
    }
    value
}
