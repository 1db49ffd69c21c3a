//! Geometric nested dissection.
//!
//! A separator, a small set of nodes, splits the mesh into two halves without coupling. The halves are ordered
//! recursively and the separator is eliminated last. Meshes are planar or nearly so, and planes normal to a coordinate
//! axis separate them well. The best plane is found by counting the separator of every candidate along each axis.

use std::sync::atomic::{AtomicU32, Ordering};

use super::graph::Graph;

/// Sets of at most this many nodes are not split; they become supernodes of about this size.
const MIN_SPLIT_SET: usize = 6;
/// Largest number of candidate planes along an axis.
const MAX_PLANES: usize = 1024;
/// Sets of more nodes are processed by two tasks.
const PARALLEL_SET: usize = 2000;
/// Label of the nodes of a separator.
const SEPARATOR: u32 = u32::MAX;

/// Returns the nodes in the order of their elimination; `points` are their coordinates.
///
/// Any coordinates give a valid ordering; those of the mesh give one with little fill.
pub(crate) fn nested_dissection(graph: &Graph, points: &[[f64; 3]]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..graph.num_nodes() as u32).collect();
    let labels: Vec<AtomicU32> = order.iter().map(|_| AtomicU32::new(0)).collect();
    Dissection { graph, points, labels: &labels }.order(&mut order, 0);
    order
}

#[derive(Clone, Copy)]
struct Dissection<'a> {
    graph: &'a Graph,
    points: &'a [[f64; 3]],
    /// Label of the set of each node. The subsets of a set of `n` nodes labelled `s` have labels from `s` to `s + n - 1`.
    labels: &'a [AtomicU32],
}

/// A plane that splits a set: nodes in bins below `bin` along `axis` are on the lower side.
struct Plane {
    axis: Axis,
    bin: usize,
    cost: f64,
}

/// An axis divided into bins of equal width.
#[derive(Clone, Copy)]
struct Axis {
    direction: [f64; 3],
    low: f64,
    scale: f64,
    bins: usize,
}

impl Axis {
    fn bin(&self, point: &[f64; 3]) -> usize {
        (((coordinate(&self.direction, point) - self.low) * self.scale) as usize).min(self.bins - 1)
    }
}

fn coordinate(direction: &[f64; 3], point: &[f64; 3]) -> f64 {
    direction.iter().zip(point).map(|(a, b)| a * b).sum()
}

impl Dissection<'_> {
    /// Orders the nodes of the set labelled `label`.
    fn order(self, nodes: &mut [u32], label: u32) {
        if nodes.len() <= MIN_SPLIT_SET {
            return;
        }
        let Some(plane) = self.best_plane(nodes, label) else { return };
        let upper_label = self.split(nodes, label, &plane);
        nodes.sort_by_key(|&node| self.label(node));
        let middle = nodes.partition_point(|&node| self.label(node) < upper_label);
        let end = nodes.partition_point(|&node| self.label(node) < SEPARATOR);
        let (lower, upper) = nodes[..end].split_at_mut(middle);
        if end > PARALLEL_SET {
            rayon::join(|| self.order(lower, label), || self.order(upper, upper_label));
        } else {
            self.order(lower, label);
            self.order(upper, upper_label);
        }
    }

    fn label(&self, node: u32) -> u32 {
        self.labels[node as usize].load(Ordering::Relaxed)
    }

    fn set_label(&self, node: u32, label: u32) {
        self.labels[node as usize].store(label, Ordering::Relaxed);
    }

    /// The plane with the smallest separator relative to the smaller half, or `None` if all nodes coincide.
    fn best_plane(&self, nodes: &[u32], label: u32) -> Option<Plane> {
        let along = |direction| self.best_plane_along(nodes, label, direction);
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let (first, others) = if nodes.len() > PARALLEL_SET {
            rayon::join(|| along(x), || [along(y), along(z)])
        } else {
            (along(x), [along(y), along(z)])
        };
        [first].into_iter().chain(others).flatten().min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    fn best_plane_along(&self, nodes: &[u32], label: u32, direction: [f64; 3]) -> Option<Plane> {
        let (low, high) = nodes
            .iter()
            .map(|&node| coordinate(&direction, &self.points[node as usize]))
            .fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        let bins = MAX_PLANES.min(nodes.len());
        let scale = (bins as f64 - 0.5) / (high - low);
        if !scale.is_finite() {
            return None;
        }
        let axis = Axis { direction, low, scale, bins };
        // Number of nodes in each bin, and change of the separator's size as the plane passes the bin.
        let mut counts = vec![0_u32; bins];
        let mut growth = vec![0_i32; bins + 1];
        for &node in nodes {
            let own = axis.bin(&self.points[node as usize]);
            counts[own] += 1;
            let mut furthest = own;
            for &other in self.graph.neighbours(node) {
                if self.label(other) == label {
                    furthest = furthest.max(axis.bin(&self.points[other as usize]));
                }
            }
            growth[own + 1] += 1;
            growth[furthest + 1] -= 1;
        }
        let (mut lower, mut separator) = (0, 0);
        let mut best: Option<Plane> = None;
        for bin in 1..bins {
            lower += counts[bin - 1];
            separator += growth[bin];
            let smaller = lower.min(nodes.len() as u32 - lower);
            let cost = f64::from(separator + 1) / f64::from(smaller);
            if best.as_ref().is_none_or(|best| cost < best.cost) {
                best = Some(Plane { axis, bin, cost });
            }
        }
        best
    }

    /// Labels every node of a set as lower half, upper half or separator, and returns the label of the upper half.
    fn split(&self, nodes: &[u32], label: u32, plane: &Plane) -> u32 {
        let is_upper = |&&node: &&u32| plane.axis.bin(&self.points[node as usize]) >= plane.bin;
        let upper: Vec<u32> = nodes.iter().filter(is_upper).copied().collect();
        let upper_label = label + (nodes.len() - upper.len()) as u32;
        upper.into_iter().for_each(|node| self.set_label(node, upper_label));
        let touches = |node: u32, half: u32| self.graph.neighbours(node).iter().any(|&other| self.label(other) == half);
        let border = |half: u32, other: u32| -> Vec<u32> {
            nodes.iter().copied().filter(|&node| self.label(node) == half && touches(node, other)).collect()
        };
        let (lower_border, upper_border) = (border(label, upper_label), border(upper_label, label));
        let separator = if lower_border.len() <= upper_border.len() { lower_border } else { upper_border };
        separator.into_iter().for_each(|node| self.set_label(node, SEPARATOR));
        upper_label
    }
}
