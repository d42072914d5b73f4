//! Arrays of one type: building, reading, slicing, absence.

use crate::bulk::Array;
use crate::cx::{Cx, FaultCode};
use crate::flow::Flow;
use rpi_image::{ShapeArgs, Type};

/// `Array`, `ArrayGet`, `ArraySet`, `ArraySlice`, `ArrayIsNull`, `ArraySetNull` of one type.
macro_rules! arrays {
    ($prefix:literal, $t:ty) => {
        primitive! {
            /// A new array of `Size` neutral values (false, 0, identity).
            ARRAY = concat!($prefix, "Array");
            in {}
            param { Size: i64 = Int(1) }
            out { outArray: Array<$t> }
            shape Shape::Size("Size");
            presence strict work 8;
            bulk |cx, _, (_,), (), (array,)| array.fill(cx.cells, <$t as Flow>::neutral())
        }

        primitive! {
            /// The value at `Index`, counted from 0. `Size` is not needed here.
            ARRAY_GET = concat!($prefix, "ArrayGet");
            in { inArray: Array<$t> }
            param { Size: i64 = Int(1); Index: i64 = Int(0) }
            out { outValue: $t }
            shape Shape::Of(super::arrays::one::<$t>);
            presence strict work 1 faults;
            full |cx, place, (), (_, index), (array,)| (super::arrays::get(cx, place, array, index),)
        }

        primitive! {
            /// The array with the value at `Index`, counted from 0, replaced. `Size` is not needed here.
            ARRAY_SET = concat!($prefix, "ArraySet");
            in { inArray: Array<$t>; inValue: $t }
            param { Size: i64 = Int(1); Index: i64 = Int(0) }
            out { outArray: Array<$t> }
            shape Shape::Of(super::arrays::with_index);
            presence strict work 8 faults;
            bulk |cx, place, (_, index), (from, value), (to,)| {
                if !(to.copy(cx.cells, from, 0) && to.set(cx.cells, index, value)) {
                    cx.fault(FaultCode::IndexOutOfRange, place);
                }
            }
        }

        primitive! {
            /// `Size` values of the array from index `Start` on, counted from 0.
            ARRAY_SLICE = concat!($prefix, "ArraySlice");
            in { inArray: Array<$t> }
            param { Size: i64 = Int(1); Start: i64 = Int(0) }
            out { outArray: Array<$t> }
            shape Shape::Of(super::arrays::slice::<$t>);
            presence strict work 8 faults;
            bulk |cx, place, (_, start), (from,), (to,)| {
                if !to.copy(cx.cells, from, start) {
                    cx.fault(FaultCode::IndexOutOfRange, place);
                }
            }
        }

        interface! {
            /// True exactly if the array is absent in this cycle.
            ARRAY_IS_NULL = concat!($prefix, "ArrayIsNull");
            in { inValue: Array<$t> }
            out { outValue: bool }
            presence always work 1;
            role Role::IsAbsent
        }

        primitive! {
            /// The array, made absent while `inNull` is true or absent. `Size` is not needed here.
            ARRAY_SET_NULL = concat!($prefix, "ArraySetNull");
            in { inValue: Array<$t>; inNull: bool }
            param { Size: i64 = Int(1) }
            out { outValue: Array<$t> }
            shape Shape::Like(0);
            presence maybe work 8;
            bulk |cx, _, (_,), (from, null), (to,)| {
                let from = from.filter(|_| null == Some(false));
                from.is_some_and(|from| to.copy(cx.cells, from, 0))
            }
        }
    };
}

pub(super) use arrays;

/// The value at `index`; a fault and the neutral value outside.
pub(super) fn get<T: Flow>(cx: &mut Cx<'_>, place: u32, array: Array<T>, index: i64) -> T {
    array.get(cx.cells, index).unwrap_or_else(|| {
        cx.fault(FaultCode::IndexOutOfRange, place);
        T::neutral()
    })
}

/// One value, if parameter 1 is an index of input 0.
pub(super) fn one<T: Flow>(args: &ShapeArgs<'_>) -> Option<Type> {
    (args.size(1)? < args.len(0)?).then_some(Type::One(T::SCALAR))
}

/// As long as input 0, if parameter 1 is an index of it.
pub(super) fn with_index(args: &ShapeArgs<'_>) -> Option<Type> {
    (args.size(1)? < args.len(0)?).then_some(*args.inputs.first()?)?
}

/// As long as parameter 0 says, if that many follow the start in parameter 1.
pub(super) fn slice<T: Flow>(args: &ShapeArgs<'_>) -> Option<Type> {
    let (size, start) = (args.size(0)?, args.size(1)?);
    (start.checked_add(size)? <= args.len(0)?).then_some(Type::Array(T::SCALAR, size))
}
