//! Macro for primitives with a name that is known at compile time.

/// Constant [`PrimId`](crate::PrimId) of the primitive with this registered name. An unregistered name is a
/// compile-time error.
#[macro_export]
macro_rules! prim {
    ($name:literal) => {
        const {
            match $crate::PrimId::from_name($name) {
                Some(prim) => prim,
                None => panic!("no primitive of this name is registered"),
            }
        }
    };
}
