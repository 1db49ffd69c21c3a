//! Benchmarks live in this folder's  files.
