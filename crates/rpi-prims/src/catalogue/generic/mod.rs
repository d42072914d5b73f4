//! Operations that exist for each of the eight value types of the reference system, generated from one definition.
//! Times have the same operations (see [`time`]).

mod arrays;
mod keyed;
pub(super) mod sampled;
mod scalars;
pub(in crate::catalogue) mod time;

/// Defines all generic operations of one type in its own module.
macro_rules! operations {
    ($module:ident, $prefix:literal, $t:ty) => {
        pub(in crate::catalogue) mod $module {
            use super::arrays::arrays;
            use super::keyed::keyed;
            use super::sampled::sampled;
            use super::scalars::{delay, scalars};
            use crate::bulk::Array;
            use crate::cx::FaultCode;
            use crate::flow::{Flow, Time};
            use crate::macros::{interface, primitive};
            use crate::operand::Text;
            use crate::registry::Prim;
            use rpi_image::{Role, Shape};

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
operations!(vector, "World::Vector", crate::flow::Vector);
operations!(rotation, "World::Rotation", crate::flow::Rotation);
operations!(frame, "World::Frame", crate::flow::Pose);
operations!(twist, "World::Twist", crate::flow::Twist);
operations!(wrench, "World::Wrench", crate::flow::Wrench);
