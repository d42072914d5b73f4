//! The net: primitives joined by typed links in a tree of fragments; its passes and its text form.
