//! Text to tokens to syntax tree, and back to formatted text.
