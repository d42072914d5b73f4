//! Conversion between numbers and arrays of bits, as used by field buses. Element 0 is the least significant bit.

use crate::aggregates::Array;
use crate::context::{Context, FaultCode};
use crate::macros::primitive;
use crate::registry::Prim;
use rpi_image::ShapeRule;

pub(super) const ALL: &[Prim] = &[BIN_TO_DEC, DEC_TO_BIN, BCD_TO_DEC, DEC_TO_BCD];

primitive! {
    /// Number from its binary digits, the first `amountBits` elements (at most 63); element 0 is the least significant
    /// bit. With `signBit`, the digits are in two's complement.
    BIN_TO_DEC = "Core::BinToDec";
    in { inArray: Array<bool> }
    param { amountBits: i64 = Int(8); signBit: bool = Bool(false) }
    out { outValue: i64 }
    presence strict work 64;
    c Code(r"
const int32_t count = rpi_digit_count(amountBits, inArray_len);
const int64_t value = rpi_number(inArray, count);
if (signBit && count > 0 && inArray[count - 1]) {
  *outValue = rpi_integer((uint64_t)value - (UINT64_C(1) << count));
} else {
  *outValue = value;
}
");
    full |cx, _, _, (bits, signed), (array,)| {
        let bits = width(array, bits);
        let value = number(cx.slots, array, 0, bits);
        let negative = signed && bits > 0 && value >> (bits - 1) == 1;
        (if negative { value - (1 << bits) } else { value },)
    }
}

primitive! {
    /// The `amountBits` least significant binary digits of a number; element 0 is the least significant bit. With
    /// `signBit`, the digits are in two's complement. `overflowBit` is true if the number does not fit.
    DEC_TO_BIN = "Core::DecToBin";
    in { inValue: i64 }
    param { amountBits: i64 = Int(8); signBit: bool = Bool(false) }
    out { outArray: Array<bool>; overflowBit: bool }
    shape ShapeRule::FromParam("amountBits");
    presence strict work 64;
    c Code(r"
const int32_t count = outArray_len < 63 ? outArray_len : 63;
int32_t k;
for (k = 0; k < outArray_len; k += 1) {
  outArray[k] = (rpi_shift_right(inValue, k, -64) & 1) != 0;
}
if (count > 62) {
  *overflowBit = true;
} else {
  const int64_t beyond = (INT64_C(1) << count) >> (signBit ? 1 : 0);
  const int64_t least = signBit ? -beyond : 0;
  *overflowBit = inValue < least || inValue >= beyond;
}
");
    mixed |cx, _, (_, signed), (value,), (array, _)| {
        let bits = array.len().min(63);
        for k in 0..array.len() {
            array.set(cx.slots, k as i64, (value >> k.min(63)) & 1 == 1);
        }
        let (least, beyond) = if signed { (-((1 << bits) >> 1), (1 << bits) >> 1) } else { (0, 1 << bits) };
        (array, !(least..beyond).contains(&value))
    }
}

primitive! {
    /// Number from its binary coded decimal digits (BCD), four bits each, in the first `amountBits` elements (at most
    /// 63). With `signBit`, the last of these elements is the sign (true: negative). A digit above 9 is a fault.
    BCD_TO_DEC = "Core::BCDToDec";
    in { inArray: Array<bool> }
    param { amountBits: i64 = Int(16); signBit: bool = Bool(true) }
    out { outValue: i64 }
    presence strict work 64 faults;
    c Code(r"
const int32_t count = rpi_digit_count(amountBits, inArray_len);
const int32_t digits = signBit && count > 0 ? count - 1 : count;
const int64_t value = rpi_decimal(cx, at, inArray, digits);
*outValue = digits < count && inArray[digits] ? -value : value;
");
    full |cx, place, _, (bits, signed), (array,)| {
        let bits = width(array, bits);
        let digits = bits - usize::from(signed && bits > 0);
        let value = decimal(cx, place, array, digits);
        let negative = digits < bits && array.get(cx.slots, digits as i64) == Some(true);
        (if negative { -value } else { value },)
    }
}

primitive! {
    /// Number as binary coded decimal digits (BCD), four bits each, in `amountBits` elements. With `signBit`, the last
    /// element is the sign (true: negative). `overflowBit` is true if the number does not fit.
    DEC_TO_BCD = "Core::DecToBCD";
    in { inValue: i64 }
    param { amountBits: i64 = Int(16); signBit: bool = Bool(true) }
    out { outArray: Array<bool>; overflowBit: bool }
    shape ShapeRule::FromParam("amountBits");
    presence strict work 64;
    c Code("*overflowBit = rpi_to_decimal(inValue, signBit, outArray, outArray_len);");
    mixed |cx, _, (_, signed), (value,), (array, _)| {
        let digits = array.len() - usize::from(signed && !array.is_empty());
        let mut rest = value.unsigned_abs();
        for first in (0..digits).step_by(4) {
            for k in first..digits.min(first + 4) {
                array.set(cx.slots, k as i64, ((rest % 10) >> (k - first)) & 1 == 1);
            }
            let room = 1 << (digits - first).min(4);
            // A digit that does not fit leaves a rest above 0, which sets the overflow bit.
            rest = if rest % 10 < room { rest / 10 } else { u64::MAX };
        }
        array.set(cx.slots, digits as i64, value < 0);
        (array, rest > 0 || (value < 0 && digits == array.len()))
    }
}

/// Returns the number of elements of a digit array to use: `bits`, limited to the length of the array.
fn width(array: Array<bool>, bits: i64) -> usize {
    usize::try_from(bits).unwrap_or(0).min(array.len()).min(63)
}

fn number(cells: &[u64], array: Array<bool>, first: usize, bits: usize) -> i64 {
    let bit = |k: usize| i64::from(array.get(cells, (first + k) as i64) == Some(true)) << k;
    (0..bits).map(bit).sum()
}

fn decimal(cx: &mut Context<'_>, place: u32, array: Array<bool>, bits: usize) -> i64 {
    let mut value = 0;
    for first in (0..bits).step_by(4).rev() {
        let digit = number(cx.slots, array, first, (bits - first).min(4));
        if digit > 9 {
            cx.fault(FaultCode::LossyConversion, place);
        }
        value = value * 10 + digit.min(9);
    }
    value
}
