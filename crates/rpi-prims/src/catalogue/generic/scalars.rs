//! Constants, absence, selection and delay of single values.

/// Defines the primitives `Value`, `IsNull`, `SetNull` and `Conditional` for one value type.
macro_rules! scalars {
    ($prefix:literal, $t:ty) => {
        interface! {
            /// Outputs the constant in the parameter `Value` in every cycle.
            VALUE = concat!($prefix, "Value");
            in {}
            param { Value: $t = Neutral }
            out { outValue: $t }
            presence always work 0;
            role Role::Constant
        }

        interface! {
            /// True if the value is absent in this cycle.
            IS_NULL = concat!($prefix, "IsNull");
            in { inValue: $t }
            out { outValue: bool }
            presence always work 1;
            role Role::IsAbsent
        }

        primitive! {
            /// Passes on the value of `inValue`; absent while `inNull` is true or absent.
            SET_NULL = concat!($prefix, "SetNull");
            in { inValue: $t; inNull: bool }
            out { outValue: $t }
            presence maybe work 1;
            c Code(r"
*outValue_present = inValue_present && inNull_present && !inNull;
if (*outValue_present) {
  COPY(outValue, inValue);
}
");
            pure |(value, null)| (value.filter(|_| null == Some(false)),)
        }

        primitive! {
            /// `inTrue` if the condition is true, else `inFalse`. Absent if the condition or the selected value is
            /// absent; the other value has no effect.
            CONDITIONAL = concat!($prefix, "Conditional");
            in { inCondition: bool; inTrue: $t = True(Neutral); inFalse: $t = False(Neutral) }
            out { outValue: $t }
            presence if_all work 1;
            c Both("inCondition ? inTrue : inFalse", r"
*outValue_present = inCondition_present && (inCondition ? inTrue_present : inFalse_present);
if (*outValue_present) {
  COPY(outValue, inCondition ? inTrue : inFalse);
}
");
            pure |(condition, yes, no)| (condition.and_then(|c| if c { yes } else { no }),)
        }
    };
}

/// Defines the primitive `Pre`, a delay by one cycle, for one value type.
macro_rules! delay {
    ($prefix:literal, $t:ty) => {
        interface! {
            /// Delay: value of `inValue` in the previous cycle in which the enclosing fragment was active; absent if it
            /// was absent then. Absent in the first cycle.
            PRE = concat!($prefix, "Pre");
            in { inValue: $t }
            out { outValue: $t }
            presence maybe work 1;
            role Role::Delay
        }
    };
}

pub(super) use {delay, scalars};
