//! Fill-reducing order of a mesh: nested dissection.
//!
//! A few nodes, the separator, cut the mesh in two halves that are not coupled; they are eliminated last, after each half
//! in the same way. The mesh lies in the plane or near it: lines across cut it well, and the best of them is found by
//! counting, along each axis, the nodes that every line would separate.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::graph::Graph;

/// Sets of at most so many nodes are not cut: the supernodes they end in are as large.
const LEAF: usize = 6;
/// Lines tried along an axis, at the most.
const LINES: usize = 1024;
/// Sets of more nodes than this are worth two tasks.
const GRAIN: usize = 2000;

/// The nodes in the order of their elimination; `points` are their coordinates.
pub(crate) fn nested_dissection(graph: &Graph, points: &[[f64; 3]]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..graph.num_nodes() as u32).collect();
    let sets: Vec<AtomicU32> = order.iter().map(|_| AtomicU32::new(0)).collect();
    Dissection { graph, points, sets: &sets }.order(&mut order, 0);
    order
}

/// What stands for the set of a node that is in a separator.
const SEPARATOR: u32 = u32::MAX;

#[derive(Clone, Copy)]
struct Dissection<'a> {
    graph: &'a Graph,
    points: &'a [[f64; 3]],
    /// The set in which each node is at present. A set of `n` nodes called `s` calls its parts by numbers from `s` to `s + n - 1`.
    sets: &'a [AtomicU32],
}

/// A line across a set: nodes in bins below `bin` along `axis` are on one side.
struct Line {
    axis: Axis,
    bin: usize,
    cost: f64,
}

/// A division of an axis into bins.
#[derive(Clone, Copy)]
struct Axis {
    direction: [f64; 3],
    low: f64,
    scale: f64,
    bins: usize,
}

impl Axis {
    fn bin(&self, point: &[f64; 3]) -> usize {
        let along: f64 = self.direction.iter().zip(point).map(|(a, b)| a * b).sum();
        (((along - self.low) * self.scale) as usize).min(self.bins - 1)
    }
}

impl Dissection<'_> {
    /// Puts the nodes of a set in order.
    fn order(self, nodes: &mut [u32], set: u32) {
        if nodes.len() <= LEAF {
            return;
        }
        let Some(line) = self.best_line(nodes, set) else { return };
        let above = self.cut(nodes, set, &line);
        nodes.sort_by_key(|&node| self.set(node));
        let first = nodes.partition_point(|&node| self.set(node) < above);
        let both = nodes.partition_point(|&node| self.set(node) < SEPARATOR);
        let (low, high) = nodes[..both].split_at_mut(first);
        if both > GRAIN {
            rayon::join(|| self.order(low, set), || self.order(high, above));
        } else {
            self.order(low, set);
            self.order(high, above);
        }
    }

    fn set(&self, node: u32) -> u32 {
        self.sets[node as usize].load(Ordering::Relaxed)
    }

    fn put(&self, node: u32, set: u32) {
        self.sets[node as usize].store(set, Ordering::Relaxed);
    }

    /// The line with the smallest separator for the balance of its halves.
    fn best_line(&self, nodes: &[u32], set: u32) -> Option<Line> {
        let along = |direction| self.best_along(nodes, set, direction);
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let (first, others) = if nodes.len() > GRAIN {
            rayon::join(|| along(x), || [along(y), along(z)])
        } else {
            (along(x), [along(y), along(z)])
        };
        [first].into_iter().chain(others).flatten().min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    fn best_along(&self, nodes: &[u32], set: u32, direction: [f64; 3]) -> Option<Line> {
        let along =
            |node: &u32| -> f64 { direction.iter().zip(&self.points[*node as usize]).map(|(a, b)| a * b).sum() };
        let (low, high) =
            nodes.iter().map(along).fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        let bins = LINES.min(nodes.len());
        let scale = (bins as f64 - 0.5) / (high - low);
        if !scale.is_finite() {
            return None;
        }
        let axis = Axis { direction, low, scale, bins };
        // Nodes in each bin, and by how much the separator grows where the line passes it.
        let mut counts = vec![0_u32; bins];
        let mut growth = vec![0_i32; bins + 1];
        for &node in nodes {
            let own = axis.bin(&self.points[node as usize]);
            counts[own] += 1;
            let mut furthest = own;
            for &other in self.graph.neighbours(node) {
                if self.set(other) == set {
                    furthest = furthest.max(axis.bin(&self.points[other as usize]));
                }
            }
            growth[own + 1] += 1;
            growth[furthest + 1] -= 1;
        }
        let (mut below, mut separator) = (0, 0);
        let mut best: Option<Line> = None;
        for bin in 1..bins {
            below += counts[bin - 1];
            separator += growth[bin];
            let smaller = below.min(nodes.len() as u32 - below);
            let cost = f64::from(separator + 1) / f64::from(smaller);
            if best.as_ref().is_none_or(|best| cost < best.cost) {
                best = Some(Line { axis, bin, cost });
            }
        }
        best
    }

    /// Gives every node of the set to a half or to the separator, and says what the half above the line is called.
    fn cut(&self, nodes: &[u32], set: u32, line: &Line) -> u32 {
        let is_above = |&&node: &&u32| line.axis.bin(&self.points[node as usize]) >= line.bin;
        let upper: Vec<u32> = nodes.iter().filter(is_above).copied().collect();
        let above = set + (nodes.len() - upper.len()) as u32;
        upper.into_iter().for_each(|node| self.put(node, above));
        let reaches = |node: u32, half: u32| self.graph.neighbours(node).iter().any(|&other| self.set(other) == half);
        let border = |half: u32, other: u32| -> Vec<u32> {
            nodes.iter().copied().filter(|&node| self.set(node) == half && reaches(node, other)).collect()
        };
        let (below_line, above_line) = (border(set, above), border(above, set));
        let separator = if below_line.len() <= above_line.len() { below_line } else { above_line };
        separator.into_iter().for_each(|node| self.put(node, SEPARATOR));
        above
    }
}
