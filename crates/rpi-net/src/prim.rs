//! Primitives by their names, where the compiler makes or looks for certain ones.

/// The [`PrimId`](crate::PrimId) of a registered name, as a constant; a name that is not registered does not compile.
#[macro_export]
macro_rules! prim {
    ($name:literal) => {
        const {
            match $crate::PrimId::of($name) {
                Some(prim) => prim,
                None => panic!("no primitive of this name is registered"),
            }
        }
    };
}
