//! Arrays of one element type: construction, access, slices and absence.

use crate::aggregates::Array;
use crate::context::{Context, FaultCode, FaultValues};
use crate::value_types::FlowType;
use rpi_image::{ShapeArgs, Type};

/// Defines the primitives `Array`, `ArrayGet`, `ArraySet`, `ArraySlice`, `ArrayIsNull` and `ArraySetNull` for one
/// element type.
macro_rules! arrays {
    ($prefix:literal, $t:ty) => {
        primitive! {
            /// Array of `Size` neutral values (false, 0 or identity).
            ARRAY = concat!($prefix, "Array");
            in {}
            param { Size: i64 = Int(1) }
            out { outArray: Array<$t> }
            shape ShapeRule::FromParam("Size");
            presence strict work 8;
            c Code("NEUTRAL(outArray);");
            bulk |cx, _, (_,), (), (array,)| array.fill(cx.slots, <$t as FlowType>::neutral())
        }

        primitive! {
            /// Element at `Index`, counted from 0. An index out of range is a fault. `Size` is not used.
            ARRAY_GET = concat!($prefix, "ArrayGet");
            in { inArray: Array<$t> }
            param { Size: i64 = Int(1); Index: i64 = Int(0) }
            out { outValue: $t }
            shape ShapeRule::Computed(super::arrays::one::<$t>);
            presence strict work 1 faults;
            c Code(r"
if (Index < 0 || Index >= inArray_len) {
  rpi_fault(cx, RPI_INDEX_OUT_OF_RANGE, at);
  NEUTRAL(outValue);
} else {
  GET(outValue, inArray, Index);
}
");
            full |cx, place, (), (_, index), (array,)| (super::arrays::get(cx, place, array, index),)
        }

        primitive! {
            /// Array with the element at `Index`, counted from 0, replaced by `inValue`. `Size` is not used.
            ARRAY_SET = concat!($prefix, "ArraySet");
            in { inArray: Array<$t>; inValue: $t }
            param { Size: i64 = Int(1); Index: i64 = Int(0) }
            out { outArray: Array<$t> }
            shape ShapeRule::Computed(super::arrays::with_index);
            presence strict work 8 faults;
            c Code(r"
SLICE(outArray, inArray, 0);
if (Index < 0 || Index >= outArray_len) {
  rpi_fault(cx, RPI_INDEX_OUT_OF_RANGE, at);
} else {
  PUT(outArray, Index, inValue);
}
");
            bulk |cx, place, (_, index), (from, value), (to,)| {
                if !(to.copy(cx.slots, from, 0) && to.set(cx.slots, index, value)) {
                    super::arrays::index_fault(cx, place, index, to.len());
                }
            }
        }

        primitive! {
            /// Part of an array: `Size` elements from index `Start`, counted from 0.
            ARRAY_SLICE = concat!($prefix, "ArraySlice");
            in { inArray: Array<$t> }
            param { Size: i64 = Int(1); Start: i64 = Int(0) }
            out { outArray: Array<$t> }
            shape ShapeRule::Computed(super::arrays::slice::<$t>);
            presence strict work 8 faults;
            c Code(r"
if (Start < 0 || Start > inArray_len - outArray_len) {
  rpi_fault(cx, RPI_INDEX_OUT_OF_RANGE, at);
} else {
  SLICE(outArray, inArray, Start);
}
");
            bulk |cx, place, (_, start), (from,), (to,)| {
                if !to.copy(cx.slots, from, start) {
                    cx.fault(FaultCode::IndexOutOfRange, place);
                }
            }
        }

        interface! {
            /// True if the array is absent in this cycle.
            ARRAY_IS_NULL = concat!($prefix, "ArrayIsNull");
            in { inValue: Array<$t> }
            out { outValue: bool }
            presence always work 1;
            role Role::IsAbsent
        }

        primitive! {
            /// Passes on the array of `inValue`; absent while `inNull` is true or absent. `Size` is not used.
            ARRAY_SET_NULL = concat!($prefix, "ArraySetNull");
            in { inValue: Array<$t>; inNull: bool }
            param { Size: i64 = Int(1) }
            out { outValue: Array<$t> }
            shape ShapeRule::SameAsInput(0);
            presence maybe work 8;
            c Code(r"
*outValue_present = inValue_present && inNull_present && !inNull;
if (*outValue_present) {
  SLICE(outValue, inValue, 0);
}
");
            bulk |cx, _, (_,), (from, null), (to,)| {
                let from = from.filter(|_| null == Some(false));
                from.is_some_and(|from| to.copy(cx.slots, from, 0))
            }
        }
    };
}

pub(super) use arrays;

/// Returns the element at `index`, counted from 0; if it is out of range, raises a fault at slot `place` and returns
/// the neutral value of the type.
pub(super) fn get<T: FlowType>(cx: &mut Context<'_>, place: u32, array: Array<T>, index: i64) -> T {
    array.get(cx.slots, index).unwrap_or_else(|| {
        index_fault(cx, place, index, array.len());
        T::neutral()
    })
}

/// Raises, at slot `place`, the fault of an index that is negative or not below `length`.
#[cold]
pub(super) fn index_fault(cx: &mut Context<'_>, place: u32, index: i64, length: usize) {
    let length = i64::try_from(length).unwrap_or(i64::MAX);
    let values = FaultValues::Index { index, length };
    cx.fault_by(FaultCode::IndexOutOfRange, place, values);
}

/// Returns the type of one element of the array at in-port 0; `None` if the value of parameter 1 is no valid index of
/// that array.
pub(super) fn one<T: FlowType>(args: &ShapeArgs<'_>) -> Option<Type> {
    (args.size(1)? < args.len(0)?).then_some(Type::Scalar(T::SCALAR))
}

/// Returns the type of the array at in-port 0; `None` if the value of parameter 1 is no valid index of that array.
pub(super) fn with_index(args: &ShapeArgs<'_>) -> Option<Type> {
    (args.size(1)? < args.len(0)?).then_some(*args.inputs.first()?)?
}

/// Returns an array type with the length in parameter 0; `None` if the array at in-port 0 has fewer elements from the
/// index in parameter 1 on.
pub(super) fn slice<T: FlowType>(args: &ShapeArgs<'_>) -> Option<Type> {
    let (size, start) = (args.size(0)?, args.size(1)?);
    (start.checked_add(size)? <= args.len(0)?).then_some(Type::Array(T::SCALAR, size))
}
