//! Constants, absence, choice and delay of single values.

/// `Value`, `IsNull`, `SetNull`, `Conditional` of one type.
macro_rules! scalars {
    ($prefix:literal, $t:ty) => {
        interface! {
            /// The constant `Value`.
            VALUE = concat!($prefix, "Value");
            in {}
            param { Value: $t = Neutral }
            out { outValue: $t }
            presence always work 0;
            role Role::Constant
        }

        interface! {
            /// True exactly if the value is absent in this cycle.
            IS_NULL = concat!($prefix, "IsNull");
            in { inValue: $t }
            out { outValue: bool }
            presence always work 1;
            role Role::IsAbsent
        }

        primitive! {
            /// The value, made absent while `inNull` is true or absent.
            SET_NULL = concat!($prefix, "SetNull");
            in { inValue: $t; inNull: bool }
            out { outValue: $t }
            presence maybe work 1;
            pure |(value, null)| (value.filter(|_| null == Some(false)),)
        }

        primitive! {
            /// `True` where the condition holds, else `False`. Absent without a condition or if the chosen one is absent;
            /// the other one does not matter.
            CONDITIONAL = concat!($prefix, "Conditional");
            in { inCondition: bool; inTrue: $t = True(Neutral); inFalse: $t = False(Neutral) }
            out { outValue: $t }
            presence if_all work 1;
            pure |(condition, yes, no)| (condition.and_then(|c| if c { yes } else { no }),)
        }
    };
}

/// `Pre` of one type.
macro_rules! delay {
    ($prefix:literal, $t:ty) => {
        interface! {
            /// The value of the previous cycle in which the surrounding fragment was active, absence included; absent at first.
            PRE = concat!($prefix, "Pre");
            in { inValue: $t }
            out { outValue: $t }
            presence maybe work 1;
            role Role::Delay
        }
    };
}

pub(super) use {delay, scalars};
