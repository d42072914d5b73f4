//! Operations that exist for each of the eight value types of the reference system, generated from one definition.
//! Times have the same operations (see [`time`]).

mod arrays;
mod keyed;
pub(super) mod sampled;
mod scalars;
pub(in crate::catalogue) mod time;

/// Defines all generic operations (constants, absence, delays, arrays, sampling, keyed values) for one value type, in a
/// module of their own.
macro_rules! operations {
    ($module:ident, $prefix:literal, $t:ty) => {
        pub(in crate::catalogue) mod $module {
            use super::arrays::arrays;
            use super::keyed::keyed;
            use super::sampled::sampled;
            use super::scalars::{delay, scalars};
            use crate::aggregates::Array;
            use crate::context::FaultCode;
            use crate::macros::{interface, primitive};
            use crate::operand::Text;
            use crate::registry::Prim;
            use crate::value_types::{FlowType, Time};
            use rpi_image::{Role, ShapeRule};

            scalars!($prefix, $t);
            delay!($prefix, $t);
            sampled!($prefix, $t);
            arrays!($prefix, $t);
            keyed!($prefix, $t);

            pub(in crate::catalogue) const ALL: &[Prim] = &[
                VALUE,
                IS_NULL,
                SET_NULL,
                CONDITIONAL,
                PRE,
                SNAPSHOT,
                AT_TIME,
                ARRAY,
                ARRAY_GET,
                ARRAY_SET,
                ARRAY_SLICE,
                ARRAY_IS_NULL,
                ARRAY_SET_NULL,
                NETCOMM_IN,
                NETCOMM_OUT,
                ARRAY_NETCOMM_IN,
                ARRAY_NETCOMM_OUT,
                INTER_NETCOMM_IN,
                INTER_NETCOMM_OUT,
                ARRAY_INTER_NETCOMM_IN,
                ARRAY_INTER_NETCOMM_OUT,
            ];
        }
    };
}

operations!(boolean, "Core::Boolean", bool);
operations!(int, "Core::Int", i64);
operations!(double, "Core::Double", f64);
operations!(vector, "World::Vector", crate::value_types::Vector);
operations!(rotation, "World::Rotation", crate::value_types::Rotation);
operations!(frame, "World::Frame", crate::value_types::Pose);
operations!(twist, "World::Twist", crate::value_types::Twist);
operations!(wrench, "World::Wrench", crate::value_types::Wrench);
