//! Plain data of the flat image: value types, primitive descriptors, the image format and its verifier.
