//! Operators that exist for each value type, generated from one definition.

use super::devices::ports;
use crate::macros::{interface, primitive};
use crate::operand::Text;
use crate::registry::Prim;
use rpi_image::Role;

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

            ports!($name, $t);

            pub(in crate::catalogue) const ALL: &[Prim] =
                &[COALESCE, HOLD, PRE, READ, SAMPLE, WRITE];
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
