//! Values that cross a net's border by key: from and to the application, and between nets.

/// `NetcommIn`, `NetcommOut`, `InterNetcommIn`, `InterNetcommOut` of one type, single and as arrays.
macro_rules! keyed {
    ($prefix:literal, $t:ty) => {
        super::keyed::ports!($prefix, $t, NETCOMM_IN NETCOMM_OUT INTER_NETCOMM_IN INTER_NETCOMM_OUT, Shape::Fixed);
        super::keyed::ports!(concat!($prefix, "Array"), Array<$t>,
            ARRAY_NETCOMM_IN ARRAY_NETCOMM_OUT ARRAY_INTER_NETCOMM_IN ARRAY_INTER_NETCOMM_OUT, Shape::LikeParam("Value"));
    };
}

macro_rules! ports {
    ($prefix:expr, $t:ty, $in:ident $out:ident $inter_in:ident $inter_out:ident, $shape:expr) => {
        interface! {
            /// A value that the application sets by `Key` between cycles; `Value` until then. `outLastUpdated` is the net time
            /// of the last update, absent before the first.
            $in = concat!($prefix, "NetcommIn");
            in {}
            param { Key: Text = Str(""); Value: $t = Neutral }
            out { outValue: $t; outLastUpdated: Time maybe }
            shape $shape;
            presence always work 1;
            role Role::Input
        }

        interface! {
            /// Publishes the value after each cycle by `Key`; Booleans are visible to rules. `Report` false keeps it from the
            /// application.
            $out = concat!($prefix, "NetcommOut");
            in { inValue: $t = Value(Neutral) }
            param { Key: Text = Str(""); Report: bool = Bool(true) }
            out {}
            presence always work 1;
            role Role::Export
        }

        interface! {
            /// The value that the net `RemoteNet` (of the control core `RemoteRCC`, empty for this one) publishes by `RemoteKey`;
            /// absent until it has. `outLastUpdated` is the net time of its last update.
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
            /// Sets the value that the net `RemoteNet` (of the control core `RemoteRCC`, empty for this one) reads by `RemoteKey`.
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
