//! From a file name to findings and an image: the pipeline that the tools share.
