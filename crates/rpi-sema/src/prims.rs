//! Primitives by their registered names, looked up by the compiler of this crate.

/// The primitive of a registered name; one that is not registered does not compile.
macro_rules! prim {
    ($name:literal) => {
        const {
            match rpi_prims::PrimId::of($name) {
                Some(prim) => prim,
                None => panic!("no primitive of this name is registered"),
            }
        }
    };
}

pub(crate) use prim;
