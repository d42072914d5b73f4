//! Values exchanged by key with the application and with other nets.

/// Defines the primitives `NetcommIn`, `NetcommOut`, `InterNetcommIn` and `InterNetcommOut` of one value type, for
/// single values and for arrays.
macro_rules! keyed {
    ($prefix:literal, $t:ty) => {
        super::keyed::ports!($prefix, $t, NETCOMM_IN NETCOMM_OUT INTER_NETCOMM_IN INTER_NETCOMM_OUT, ShapeRule::Fixed);
        super::keyed::ports!(concat!($prefix, "Array"), Array<$t>,
            ARRAY_NETCOMM_IN ARRAY_NETCOMM_OUT ARRAY_INTER_NETCOMM_IN ARRAY_INTER_NETCOMM_OUT, ShapeRule::SameAsParam("Value"));
    };
}

macro_rules! ports {
    ($prefix:expr, $t:ty, $in:ident $out:ident $inter_in:ident $inter_out:ident, $shape:expr) => {
        interface! {
            /// Value that the application sets by `Key` between cycles; `Value` before the first update.
            /// `outLastUpdated` is the logical time of the last update, absent before the first update.
            $in = concat!($prefix, "NetcommIn");
            in {}
            param { Key: Text = Str(""); Value: $t = Neutral }
            out { outValue: $t; outLastUpdated: Time maybe }
            shape $shape;
            presence always work 1;
            role Role::Input
        }

        interface! {
            /// Publishes the value of `inValue` by `Key` after each cycle. Booleans can be used in rules. If `Report`
            /// is false, the value is not reported to the application.
            $out = concat!($prefix, "NetcommOut");
            in { inValue: $t = Value(Neutral) }
            param { Key: Text = Str(""); Report: bool = Bool(true) }
            out {}
            presence always work 1;
            role Role::Export
        }

        interface! {
            /// Value that the net `RemoteNet` of the control core `RemoteRCC` (empty: this one) publishes by
            /// `RemoteKey`; absent before the first update. `outLastUpdated` is the logical time of the last update.
            $inter_in = concat!($prefix, "InterNetcommIn");
            in {}
            param {
                RemoteRCC: Text = Str("");
                RemoteNet: Text = Str("");
                RemoteKey: Text = Str("");
                Value: $t = Neutral
            }
            out { outValue: $t; outLastUpdated: Time }
            shape $shape;
            presence maybe work 1;
            role Role::Input
        }

        interface! {
            /// Sets the value that the net `RemoteNet` of the control core `RemoteRCC` (empty: this one) reads by
            /// `RemoteKey`.
            $inter_out = concat!($prefix, "InterNetcommOut");
            in { inValue: $t = Value(Neutral) }
            param {
                RemoteRCC: Text = Str("");
                RemoteNet: Text = Str("");
                RemoteKey: Text = Str("")
            }
            out {}
            presence always work 1;
            role Role::Export
        }
    };
}

pub(super) use {keyed, ports};
