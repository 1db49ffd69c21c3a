//! Fill-reducing ordering of the nodes. Imports the pattern alone.

mod dissection;
mod graph;

pub(crate) use dissection::nested_dissection;
pub(crate) use graph::Graph;
