//! Operators that exist for each value type, generated from one definition.

use super::devices::ports;
use crate::aggregates::Array;
use crate::macros::{interface, primitive};
use crate::operand::Text;
use crate::registry::Prim;
use crate::value_types::FlowType;
use rpi_image::{Role, ShapeArgs, ShapeRule, Type};

/// Defines the primitives `Coalesce`, `Hold`, `Pre` and the device ports for one value type.
macro_rules! operators {
    ($module:ident, $name:literal, $t:ty) => {
        pub(in crate::catalogue) mod $module {
            use super::*;

            primitive! {
                                        /// `first ?? second`: `inFirst` if it is present, else `inSecond`.
                                        COALESCE = concat!("Rpi::", $name, "Coalesce");
                                        in { inFirst: $t; inSecond: $t }
                                        out { outValue: $t }
                                        presence if_any work 1;
                                        c Both("inFirst", r"
*outValue_present = inFirst_present || inSecond_present;
if (*outValue_present) {
  COPY(outValue, inFirst_present ? inFirst : inSecond);
}
");
                                        pure |(first, second)| (first.or(second),)
                                    }

            primitive! {
                                        /// `hold(x, init)`: last present value of `inValue`; `inInitial` before the first present value.
                                        HOLD = concat!("Rpi::", $name, "Hold");
                                        in { inValue: $t; inInitial: $t }
                                        out { outValue: $t }
                                        state { bool, $t }
                                        presence if_any work 2;
                                        c Code(r"
if (inValue_present) {
  *s0 = true;
  COPY(s1, inValue);
}
*outValue_present = *s0 || inInitial_present;
if (*s0) {
  COPY(outValue, s1);
} else if (inInitial_present) {
  COPY(outValue, inInitial);
}
");
                                        full |_, _, (seen, last), (), (value, initial)| {
                                            if let Some(value) = value {
                                                (*seen, *last) = (true, value);
                                            }
                                            (if *seen { Some(*last) } else { initial },)
                                        }
                                    }

            interface! {
                /// Delay: value of `inValue` in the previous cycle in which the enclosing fragment was active. The
                /// initial value is neutral and is never used, as proved by the compiler.
                PRE = concat!("Rpi::", $name, "Pre");
                in { inValue: $t }
                out { outValue: $t }
                presence if_all work 1;
                role Role::Delay
            }

            interface! {
                /// Outputs the constant array in the parameter `Value` in every cycle.
                ARRAY_VALUE = concat!("Rpi::", $name, "ArrayValue");
                in {}
                param { Value: Array<$t> = Required }
                out { outValue: Array<$t> }
                shape ShapeRule::SameAsParam("Value");
                presence always work 0;
                role Role::Constant
            }

            primitive! {
                /// Array with the elements of `inFirst`, followed by those of `inSecond`.
                ARRAY_CONCATENATE = concat!("Rpi::", $name, "ArrayConcatenate");
                in { inFirst: Array<$t>; inSecond: Array<$t> }
                out { outArray: Array<$t> }
                shape ShapeRule::Computed(super::concatenated::<$t>);
                presence strict work 8;
                c Code(r"
memcpy(outArray, inFirst, (size_t)inFirst_len * SLOTS(outArray) * sizeof outArray[0]);
memcpy(outArray + (size_t)inFirst_len * SLOTS(outArray), inSecond, (size_t)inSecond_len * SLOTS(outArray) * sizeof outArray[0]);
");
                bulk |cx, _, (), (first, second), (to,)| {
                    let (head, tail) = to.split_at(first.len());
                    head.copy(cx.slots, first, 0);
                    tail.copy(cx.slots, second, 0);
                }
            }

            ports!($name, $t);

            pub(in crate::catalogue) const ALL: &[Prim] =
                &[ARRAY_CONCATENATE, ARRAY_VALUE, COALESCE, HOLD, PRE, READ, SAMPLE, WRITE];
        }
    };
}

operators!(boolean, "Boolean", bool);
operators!(int, "Int", i64);
operators!(double, "Double", f64);
operators!(time, "Time", crate::value_types::Time);
operators!(vector, "Vector", crate::value_types::Vector);
operators!(rotation, "Rotation", crate::value_types::Rotation);
operators!(frame, "Frame", crate::value_types::Pose);
operators!(twist, "Twist", crate::value_types::Twist);
operators!(wrench, "Wrench", crate::value_types::Wrench);

/// Returns the type of the array with the elements of both array in-ports; `None` if its length has no 32 bits.
fn concatenated<T: FlowType>(args: &ShapeArgs<'_>) -> Option<Type> {
    let length = args.len(0)?.checked_add(args.len(1)?)?;
    Some(Type::Array(T::SCALAR, length))
}
