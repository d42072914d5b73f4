//! The control core: loading, the cycle, commands that follow one another without a gap.
