//! From a line to the nodes that it passes along the edges of the cells.

use std::collections::HashMap;

use super::LineError;
use crate::Mesh;

/// Distance, relative to the shortest edge there, up to which a point of the line is at a node, and a node on the line.
const ON_LINE: f64 = 1e-2;

/// An edge as seen from one of its nodes: its other end, and the node in between.
#[derive(Clone, Copy, PartialEq)]
struct Way {
    end: u32,
    middle: Option<u32>,
}

/// The edges of a mesh. Nodes at one place are one here, the lowest of them.
pub(super) struct EdgeNetwork<'a> {
    mesh: &'a Mesh,
    ways: HashMap<u32, Vec<Way>>,
    /// Largest distance from the line of a node on it.
    reach: HashMap<u32, f64>,
}

impl<'a> EdgeNetwork<'a> {
    /// Collects the edges. `places` holds the lowest node at the place of each node.
    pub(super) fn new(mesh: &'a Mesh, places: &[u32]) -> Self {
        let place = |node: u32| places[node as usize];
        let mut network = Self { mesh, ways: HashMap::new(), reach: HashMap::new() };
        for edge in (0..mesh.num_cells()).flat_map(|cell| mesh.edges(cell)) {
            let [a, b] = edge.corners.map(place);
            let middle = edge.middle.map(place);
            network.add_way(a, Way { end: b, middle });
            network.add_way(b, Way { end: a, middle });
            if let Some(middle) = middle {
                network.add_way(middle, Way { end: a, middle: None });
                network.add_way(middle, Way { end: b, middle: None });
            }
            for node in edge.nodes() {
                let reach = network.reach.entry(place(node)).or_insert(f64::INFINITY);
                *reach = reach.min(ON_LINE * mesh.distance(a, b));
            }
        }
        network
    }

    fn add_way(&mut self, from: u32, way: Way) {
        let ways = self.ways.entry(from).or_default();
        if !ways.contains(&way) {
            ways.push(way);
        }
    }

    /// The nodes that a line passes, in its order, those in the middle of edges included.
    pub(super) fn path(&self, line: &[[f64; 3]]) -> Result<Vec<u32>, LineError> {
        if let Some(point) = line.iter().position(|point| !point.iter().all(|c| c.is_finite())) {
            return Err(LineError::NonFinite { point });
        }
        let stops = self.stops(line)?;
        let mut path: Vec<u32> = stops.iter().take(1).copied().collect();
        for (point, stop) in stops.windows(2).enumerate() {
            self.follow([stop[0], stop[1]], &mut path).map_err(|node| LineError::OffEdges {
                point,
                node: node as usize,
                place: self.place(node),
            })?;
        }
        if path.len() < 2 { Err(LineError::TooShort) } else { Ok(path) }
    }

    /// The node at each point of a line.
    fn stops(&self, line: &[[f64; 3]]) -> Result<Vec<u32>, LineError> {
        let along = self.mesh.sorting_coordinates();
        let mut nodes: Vec<u32> = self.ways.keys().copied().collect();
        nodes.sort_unstable_by(|&a, &b| along[a as usize].total_cmp(&along[b as usize]).then(a.cmp(&b)));
        let widest = self.reach.values().copied().fold(0.0, f64::max);
        let stop = |(point, place): (usize, &[f64; 3])| {
            let distance = |&node: &u32| norm(difference(self.place(node), *place));
            let nearer = |a: &u32, b: &u32| distance(a).total_cmp(&distance(b)).then(a.cmp(b));
            let at = Mesh::sorting_coordinate(place);
            let start = nodes.partition_point(|&node| along[node as usize] < at - widest);
            let near = nodes[start..].iter().copied().take_while(|&node| along[node as usize] <= at + widest);
            let found = near.filter(|node| distance(node) <= self.reach[node]).min_by(nearer);
            found.ok_or_else(|| {
                let nearest = nodes.iter().copied().min_by(nearer).unwrap_or_default();
                LineError::OffNodes {
                    point,
                    place: *place,
                    nearest: nearest as usize,
                    node_place: self.place(nearest),
                    distance: distance(&nearest),
                }
            })
        };
        line.iter().enumerate().map(stop).collect()
    }

    /// Appends the nodes from one to another, along the edge between them or along edges on the straight line.
    ///
    /// # Errors
    ///
    /// The node from which no edge continues.
    fn follow(&self, [from, to]: [u32; 2], path: &mut Vec<u32>) -> Result<(), u32> {
        let start = self.place(from);
        let direction = difference(self.place(to), start);
        let length = norm(direction);
        // Position along the line, and distance from it.
        let position = |node: u32| {
            let relative = difference(self.place(node), start);
            let along = dot(relative, direction) / length;
            let across = [0, 1, 2].map(|d| relative[d] - along * direction[d] / length);
            (along, norm(across))
        };
        let mut at = from;
        while at != to {
            let (reached, _) = position(at);
            let is_ahead = |way: &Way| {
                let (along, across) = position(way.end);
                along > reached && along < length && across <= self.reach[&way.end]
            };
            let ways = &self.ways[&at];
            let direct = ways.iter().find(|way| way.end == to || way.middle == Some(to));
            let shorter = |a: &&Way, b: &&Way| position(a.end).0.total_cmp(&position(b.end).0);
            let way = direct.or_else(|| ways.iter().filter(|way| is_ahead(way)).min_by(shorter)).ok_or(at)?;
            if way.middle == Some(to) {
                path.push(to);
                break;
            }
            path.extend(way.middle);
            path.push(way.end);
            at = way.end;
        }
        Ok(())
    }

    fn place(&self, node: u32) -> [f64; 3] {
        self.mesh.points()[node as usize]
    }
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|d| a[d] - b[d])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
