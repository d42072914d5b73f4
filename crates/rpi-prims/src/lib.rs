//! Every primitive, each declared in one place.
