//! What the tests share: the allocation trap, the data beside the project, small helpers.
