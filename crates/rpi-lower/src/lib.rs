//! From a scheduled net to the flat image.
