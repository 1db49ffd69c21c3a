//! Meshes cut along the edges of their cells.

#![allow(clippy::panic, clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::{BTreeSet, HashMap};

use common::{Random, jittered_mesh, types_with_edge_intervals};
use fedic_mesh::{
    CellType, LineError, Locator, Mesh, MeshError, MeshSet, cell_areas, interpolate_field, rectangle_mesh,
};
use proptest::prelude::*;

/// A mesh of 4 by 3 squares of side 1, each one quadrilateral or two triangles.
fn mesh(cell: CellType) -> Mesh {
    rectangle_mesh([0.0, 0.0, 4.0, 3.0], 1.0, cell).unwrap()
}

fn line(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
    points.iter().map(|&[x, y]| [x, y, 0.0]).collect()
}

fn split(mesh: &Mesh, points: &[[f64; 2]]) -> Mesh {
    mesh.split(&line(points)).unwrap()
}

fn refusal(mesh: &Mesh, points: &[[f64; 2]]) -> LineError {
    match mesh.split(&line(points)).unwrap_err() {
        MeshError::Line(error) => error,
        other => panic!("{other}"),
    }
}

/// Nodes at a place.
fn nodes_at(mesh: &Mesh, place: [f64; 2]) -> Vec<usize> {
    (0..mesh.num_nodes()).filter(|&n| (0..2).all(|d| (mesh.points()[n][d] - place[d]).abs() < 1e-9)).collect()
}

fn centre(mesh: &Mesh, cell: usize) -> [f64; 2] {
    let points = mesh.cell_points(cell);
    let corners = mesh.cell(cell).cell_type.num_corners();
    [0, 1].map(|d| points[..corners].iter().map(|p| p[d]).sum::<f64>() / corners as f64)
}

/// Nodes of the cells whose centre is chosen.
fn nodes_of(mesh: &Mesh, chosen: impl Fn([f64; 2]) -> bool) -> BTreeSet<u32> {
    let cells = (0..mesh.num_cells()).filter(|&cell| chosen(centre(mesh, cell)));
    cells.flat_map(|cell| mesh.cell(cell).nodes.to_vec()).collect()
}

/// Number of parts that share no nodes.
fn num_parts(mesh: &Mesh) -> usize {
    let mut part: Vec<usize> = (0..mesh.num_nodes()).collect();
    loop {
        let before = part.clone();
        for cell in mesh.cells() {
            let lowest = cell.nodes.iter().map(|&n| part[n as usize]).min().unwrap();
            cell.nodes.iter().for_each(|&n| part[n as usize] = lowest);
        }
        if part == before {
            let used = mesh.used_nodes();
            return (0..part.len()).filter(|&n| used[n]).map(|n| part[n]).collect::<BTreeSet<_>>().len();
        }
    }
}

/// What holds for every cut mesh.
fn check_cut(whole: &Mesh, cut: &Mesh) {
    assert_eq!(cut.num_cells(), whole.num_cells());
    assert_eq!(cell_areas(cut), cell_areas(whole));
    assert_eq!(cut.points()[..whole.num_nodes()], *whole.points());
    assert!(cut.used_nodes()[whole.num_nodes()..].iter().all(|&used| used));
    for cell in 0..whole.num_cells() {
        assert_eq!(cut.cell(cell).cell_type, whole.cell(cell).cell_type);
        assert_eq!(cut.cell_points(cell), whole.cell_points(cell));
    }
    assert_eq!(cut.merge_nodes(0.0).unwrap(), *whole);
}

fn is_quadratic(cell: CellType) -> bool {
    cell.edge_intervals() == 2
}

#[test]
fn a_line_that_ends_inside_doubles_all_nodes_but_its_end() {
    for cell in CellType::ALL {
        let whole = mesh(cell);
        let cut = split(&whole, &[[0.0, 1.0], [2.0, 1.0]]);
        check_cut(&whole, &cut);
        let expected: &[f64] = if is_quadratic(cell) { &[0.0, 0.5, 1.0, 1.5] } else { &[0.0, 1.0] };
        let pairs = cut.coincident_nodes(Mesh::COINCIDENT);
        assert_eq!(pairs.len(), expected.len(), "{cell}");
        assert_eq!(cut.num_nodes(), whole.num_nodes() + expected.len());
        for (k, (&[old, new], &x)) in pairs.iter().zip(expected).enumerate() {
            assert_eq!(cut.points()[old as usize], [x, 1.0, 0.0], "{cell}");
            assert_eq!(new as usize, whole.num_nodes() + k, "new nodes are in the order of the line");
        }
        // To the left of the line are the cells above it.
        let (above, below) = (nodes_of(&cut, |[_, y]| y > 1.0), nodes_of(&cut, |[_, y]| y < 1.0));
        assert!(pairs.iter().all(|[old, new]| above.contains(old) && !above.contains(new)), "{cell}");
        assert!(pairs.iter().all(|[old, new]| below.contains(new) && !below.contains(old)), "{cell}");
        let shared: Vec<f64> = above.intersection(&below).map(|&n| cut.points()[n as usize][0]).collect();
        assert!(shared.contains(&2.0) && shared.iter().all(|&x| x >= 2.0), "{cell}: {shared:?}");
        assert_eq!(num_parts(&cut), 1);
    }
}

#[test]
fn the_cells_to_the_left_keep_the_nodes() {
    let whole = mesh(CellType::Quad);
    let above = |mesh: &Mesh| nodes_of(mesh, |[_, y]| y > 1.0);
    let forward = split(&whole, &[[0.0, 1.0], [4.0, 1.0]]);
    let backward = split(&whole, &[[4.0, 1.0], [0.0, 1.0]]);
    assert_eq!(above(&forward), above(&whole));
    assert_eq!(above(&backward).into_iter().filter(|&n| n as usize >= whole.num_nodes()).count(), 5);
    assert_eq!(nodes_of(&backward, |[_, y]| y < 1.0), nodes_of(&whole, |[_, y]| y < 1.0));
}

#[test]
fn a_line_from_border_to_border_makes_two_parts() {
    for cell in CellType::ALL {
        let whole = mesh(cell);
        let cut = split(&whole, &[[0.0, 1.0], [2.0, 1.0], [2.0, 2.0], [4.0, 2.0]]);
        check_cut(&whole, &cut);
        assert_eq!(num_parts(&cut), 2, "{cell}");
        assert_eq!(cut.num_nodes() - whole.num_nodes(), if is_quadratic(cell) { 11 } else { 6 }, "{cell}");
        let upper = |[x, y]: [f64; 2]| y > if x < 2.0 { 1.0 } else { 2.0 };
        let [above, below] = [nodes_of(&cut, upper), nodes_of(&cut, |at| !upper(at))];
        assert!(above.is_disjoint(&below), "{cell}");
    }
}

#[test]
fn lines_that_meet_or_cross_make_a_node_for_each_part_there() {
    for cell in CellType::ALL {
        let whole = mesh(cell);
        let once = split(&whole, &[[0.0, 1.0], [4.0, 1.0]]);
        let tee = split(&once, &[[2.0, 1.0], [2.0, 0.0]]);
        check_cut(&whole, &tee);
        assert_eq!((num_parts(&tee), nodes_at(&tee, [2.0, 1.0]).len()), (3, 3), "{cell}");
        let cross = split(&once, &[[2.0, 3.0], [2.0, 0.0]]);
        check_cut(&whole, &cross);
        assert_eq!((num_parts(&cross), nodes_at(&cross, [2.0, 1.0]).len()), (4, 4), "{cell}");
        // One line that crosses itself.
        let crossing = split(&whole, &[[0.0, 1.0], [3.0, 1.0], [3.0, 2.0], [1.0, 2.0], [1.0, 0.0]]);
        check_cut(&whole, &crossing);
        assert_eq!((num_parts(&crossing), nodes_at(&crossing, [1.0, 1.0]).len()), (3, 4), "{cell}");
    }
}

#[test]
fn a_cut_is_continued_from_its_end() {
    for cell in CellType::ALL {
        let whole = mesh(cell);
        let at_once = split(&whole, &[[0.0, 1.0], [3.0, 1.0]]);
        let in_steps = split(&split(&whole, &[[0.0, 1.0], [1.0, 1.0]]), &[[1.0, 1.0], [3.0, 1.0]]);
        assert_eq!(in_steps, at_once, "{cell}");
    }
}

#[test]
fn a_closed_line_separates_what_is_inside() {
    for cell in CellType::ALL {
        let whole = mesh(cell);
        let cut = split(&whole, &[[1.0, 1.0], [3.0, 1.0], [3.0, 2.0], [1.0, 2.0], [1.0, 1.0]]);
        check_cut(&whole, &cut);
        assert_eq!(num_parts(&cut), 2, "{cell}");
        assert_eq!(cut.num_nodes() - whole.num_nodes(), if is_quadratic(cell) { 12 } else { 6 }, "{cell}");
        // Counter-clockwise: what is inside keeps the nodes.
        let inside = |[x, y]: [f64; 2]| (1.0..3.0).contains(&x) && (1.0..2.0).contains(&y);
        assert_eq!(nodes_of(&cut, inside), nodes_of(&whole, inside), "{cell}");
    }
}

#[test]
fn a_line_through_nodes_of_the_boundary_cuts_where_it_is_inside() {
    for cell in CellType::ALL {
        let whole = mesh(cell);
        // Along the lower border, across a corner of the mesh, and back along the border.
        let cut = split(&whole, &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0], [2.0, 0.0], [4.0, 0.0]]);
        check_cut(&whole, &cut);
        assert_eq!(num_parts(&cut), 2, "{cell}");
        assert_eq!(cut.num_nodes() - whole.num_nodes(), if is_quadratic(cell) { 7 } else { 4 }, "{cell}");
    }
}

#[test]
fn one_edge_inside_opens_by_its_middle_node() {
    let inside = [[1.0, 1.0], [2.0, 1.0]];
    for cell in CellType::ALL {
        let whole = mesh(cell);
        if is_quadratic(cell) {
            let cut = split(&whole, &inside);
            check_cut(&whole, &cut);
            assert_eq!(nodes_at(&cut, [1.5, 1.0]).len(), 2, "{cell}");
            assert_eq!(cut.num_nodes(), whole.num_nodes() + 1);
        } else {
            assert_eq!(refusal(&whole, &inside), LineError::CutsNothing);
        }
    }
}

#[test]
fn a_curved_edge_is_followed_from_corner_to_corner_or_by_its_middle() {
    for middle_height in [1.0, 1.2] {
        let whole = {
            let flat = rectangle_mesh([0.0, 0.0, 1.0, 2.0], 1.0, CellType::Quad8).unwrap();
            let mut points = flat.points().to_vec();
            points[nodes_at(&flat, [0.5, 1.0])[0]][1] = middle_height;
            let nodes = flat.cells().flat_map(|cell| cell.nodes.to_vec()).map(i64::from).collect();
            Mesh::new(points, &[(CellType::Quad8, nodes)]).unwrap()
        };
        let direct = split(&whole, &[[0.0, 1.0], [1.0, 1.0]]);
        assert_eq!(num_parts(&direct), 2);
        assert_eq!(split(&whole, &[[0.0, 1.0], [0.5, middle_height], [1.0, 1.0]]), direct);
        let half = refusal(&whole, &[[0.0, 1.0], [0.5, middle_height]]);
        assert!(matches!(half, LineError::InsideEdge { .. }), "{half}");
    }
}

#[test]
fn both_sides_move_independently() {
    for cell in CellType::ALL {
        let cut = split(&mesh(cell), &[[0.0, 1.0], [4.0, 1.0]]);
        let above = |[x, y]: [f64; 2]| [0.3 + 0.02 * x, 0.5 - 0.01 * y + 0.03 * x];
        let below = |[x, y]: [f64; 2]| [-0.1 * y, 0.04 * x - 0.2];
        let upper = nodes_of(&cut, |[_, y]| y > 1.0);
        let displacement = (0..cut.num_nodes()).flat_map(|node| {
            let [x, y, _] = cut.points()[node];
            if upper.contains(&(node as u32)) { above([x, y]) } else { below([x, y]) }
        });
        let displacement: Vec<f64> = displacement.collect();
        let points: Vec<[f64; 2]> =
            (0..200).map(|k| [4.0 * (f64::from(k) * 0.618).fract(), f64::from(k % 2) + 0.5]).collect();
        let near: Vec<[f64; 2]> =
            points.iter().map(|&[x, y]| [x, if y > 1.0 { 1.0 + 1e-6 } else { 1.0 - 1e-6 }]).collect();
        for points in [points, near] {
            let found = interpolate_field(&Locator::new(&cut), &displacement, 2, &points);
            for (found, &at) in found.chunks_exact(2).zip(&points) {
                let expected = if at[1] > 1.0 { above(at) } else { below(at) };
                assert!(
                    (0..2).all(|d| (found[d] - expected[d]).abs() < 1e-9),
                    "{cell} at {at:?}: {found:?}, {expected:?}"
                );
            }
        }
        // The opening along the cut is the difference of the pairs.
        for [one, other] in cut.coincident_nodes(Mesh::COINCIDENT) {
            let [x, y, _] = cut.points()[one as usize];
            let opening = [0, 1].map(|d| displacement[2 * one as usize + d] - displacement[2 * other as usize + d]);
            let expected = [0, 1].map(|d| above([x, y])[d] - below([x, y])[d]);
            assert!((0..2).all(|d| (opening[d] - expected[d]).abs() < 1e-15), "{cell}");
        }
    }
}

#[test]
fn sets_get_the_new_nodes() {
    let whole = mesh(CellType::Quad);
    let set = |nodes: &[u32], cells: &[u32]| MeshSet { nodes: nodes.to_vec(), cells: cells.to_vec() };
    let sets = [
        ("left border", set(&[0, 5, 10, 15], &[])),
        ("lower row", set(&[], &[0, 1, 2, 3])),
        ("both", set(&[0, 5], &[0])),
        ("corner", set(&[0], &[])),
    ];
    let whole = whole.with_sets(sets.map(|(name, set)| (name.to_owned(), set))).unwrap();
    let cut = split(&whole, &[[0.0, 1.0], [4.0, 1.0]]);
    check_cut(&whole, &cut);
    assert_eq!(cut.sets()["left border"], set(&[0, 5, 10, 15, 20], &[]));
    assert_eq!(cut.sets()["lower row"], set(&[0, 1, 2, 3, 4, 20, 21, 22, 23, 24], &[0, 1, 2, 3]));
    assert_eq!(cut.sets()["both"], set(&[0, 5, 20], &[0]));
    assert_eq!(cut.sets()["corner"], set(&[0], &[]));
}

#[test]
fn a_surface_in_space_is_cut() {
    let flat = mesh(CellType::Quad9);
    let bent = |[x, y, _]: [f64; 3]| [x.sin(), y, x.cos()];
    let nodes = flat.cells().flat_map(|cell| cell.nodes.to_vec()).map(i64::from).collect();
    let whole = Mesh::new(flat.points().iter().copied().map(bent).collect(), &[(CellType::Quad9, nodes)]).unwrap();
    let around = [0.0, 1.0, 2.0, 3.0].map(|x| bent([x, 1.0, 0.0]));
    let cut = whole.split(&around).unwrap();
    check_cut(&whole, &cut);
    assert_eq!(cut.num_nodes(), whole.num_nodes() + 6);
}

#[test]
fn a_quadrilateral_that_is_a_triangle_is_cut_from_its_neighbour() {
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0]].map(|[x, y]| [x, y, 0.0]).to_vec();
    let whole = Mesh::new(points, &[(CellType::Quad, vec![0, 1, 2, 3, 1, 4, 2, 2])]).unwrap();
    let cut = split(&whole, &[[1.0, 1.0], [1.0, 0.0]]);
    assert_eq!(cut.cell(1).nodes, [1, 4, 2, 2]);
    assert_eq!(cut.cell(0).nodes, [0, 6, 5, 3]);
    check_cut(&whole, &cut);
}

#[test]
fn cells_that_touch_at_a_node_of_the_line_stay_joined_there() {
    // Two squares that share the node 2, the second of which is divided.
    let points =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 1.0], [3.0, 1.0], [1.0, 2.0], [2.0, 2.0], [3.0, 2.0]];
    let nodes = vec![0, 1, 2, 3, 2, 4, 7, 6, 4, 5, 8, 7];
    let whole = Mesh::new(points.map(|[x, y]| [x, y, 0.0]).to_vec(), &[(CellType::Quad, nodes)]).unwrap();
    assert_eq!(refusal(&whole, &[[1.0, 1.0], [2.0, 1.0]]), LineError::CutsNothing);
    let cut = split(&whole, &[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]);
    assert_eq!(nodes_at(&cut, [1.0, 1.0]), [2]);
    assert_eq!(num_parts(&cut), 2);
}

#[test]
fn points_and_nodes_may_be_one_percent_of_an_edge_off_the_line() {
    let whole = mesh(CellType::Quad8);
    let exact = split(&whole, &[[0.0, 1.0], [2.0, 1.0]]);
    assert_eq!(split(&whole, &[[0.006, 0.994], [2.0, 1.009]]), exact);
    let error = refusal(&whole, &[[0.0, 1.0], [2.0, 1.03]]);
    assert!(matches!(error, LineError::OffNodes { point: 1, .. }), "{error}");
    // Points given twice do not matter.
    assert_eq!(split(&whole, &[[0.0, 1.0], [0.0, 1.0], [2.0, 1.0], [2.0, 1.0]]), exact);
}

#[test]
fn lines_that_cannot_be_followed_are_refused_with_their_place() {
    let whole = mesh(CellType::Quad);
    let cases: &[(&[[f64; 2]], &str)] = &[
        (&[], "a line along the edges of the cells needs at least two different points"),
        (&[[1.0, 1.0]], "a line along the edges of the cells needs at least two different points"),
        (&[[1.0, 1.0], [1.0, 1.0]], "a line along the edges of the cells needs at least two different points"),
        (&[[1.0, 1.0], [f64::NAN, 1.0]], "point 1 of the line has a coordinate that is not finite"),
        (&[[f64::INFINITY, 1.0], [1.0, 1.0]], "point 0 of the line has a coordinate that is not finite"),
        (
            &[[0.0, 1.0], [2.3, 1.0]],
            "point 1 of the line, (2.3, 1), is at no node on the edges of the cells; the nearest is node 7 at (2, 1), 0.3 away",
        ),
        (
            &[[-10.0, -10.0], [-9.0, -10.0]],
            "point 0 of the line, (-10, -10), is at no node on the edges of the cells; the nearest is node 0 at (0, 0), 14.1421 away",
        ),
        (
            &[[0.0, 1.0], [1.0, 1.0], [3.0, 2.0]],
            "the line leaves the edges of the cells at node 6, (1, 1), on the way from its point 1 to the next one; edges have to \
             lie on the line, or give the nodes between as points",
        ),
        (
            &[[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]],
            "the line separates no cells: it runs along the boundary or an earlier cut, or it is a single edge inside the mesh \
             whose ends stay joined",
        ),
    ];
    for (points, message) in cases {
        assert_eq!(refusal(&whole, points).to_string(), *message);
    }
    // In a line of edges that is interrupted the place is where the edges end.
    let nodes = (0..whole.num_cells()).filter(|&cell| (centre(&whole, cell)[0] - 2.5).abs() > 0.1);
    let nodes = nodes.flat_map(|cell| whole.cell(cell).nodes.to_vec()).map(i64::from).collect();
    let interrupted = Mesh::new(whole.points().to_vec(), &[(CellType::Quad, nodes)]).unwrap();
    let error = refusal(&interrupted, &[[0.0, 1.0], [4.0, 1.0]]);
    assert_eq!(error, LineError::OffEdges { point: 0, node: 7, place: [2.0, 1.0, 0.0] });
    // A cut that is there already.
    let cut = split(&whole, &[[0.0, 1.0], [2.0, 1.0]]);
    assert_eq!(refusal(&cut, &[[0.0, 1.0], [2.0, 1.0]]), LineError::CutsNothing);
    // The node in the middle of a cell is on no edge.
    let error = refusal(&mesh(CellType::Quad9), &[[0.5, 0.5], [0.5, 1.5]]);
    assert!(matches!(error, LineError::OffNodes { point: 0, .. }), "{error}");
    // A line that turns back in the middle of an edge.
    let error = refusal(&mesh(CellType::Quad8), &[[0.0, 1.0], [1.5, 1.0], [1.0, 1.0]]);
    assert!(matches!(error, LineError::InsideEdge { place: [1.5, 1.0, 0.0], .. }), "{error}");
}

/// Corners of cells next to each corner.
fn corner_neighbours(mesh: &Mesh) -> HashMap<u32, Vec<u32>> {
    let mut neighbours: HashMap<u32, Vec<u32>> = HashMap::new();
    for cell in mesh.cells() {
        let corners = &cell.nodes[..cell.cell_type.num_corners()];
        for (k, &corner) in corners.iter().enumerate() {
            let next = corners[(k + 1) % corners.len()];
            neighbours.entry(corner).or_default().push(next);
            neighbours.entry(next).or_default().push(corner);
        }
    }
    neighbours.values_mut().for_each(|others| {
        others.sort_unstable();
        others.dedup();
    });
    neighbours
}

/// Number of nodes needed if each cell first has nodes of its own and those of shared edges that are not cut are joined.
fn nodes_needed(mesh: &Mesh, path: &[u32]) -> usize {
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    let cut: BTreeSet<[u32; 2]> = path.windows(2).map(|pair| key(pair[0], pair[1])).collect();
    let mut first = Vec::new();
    let starts: Vec<usize> = mesh
        .cells()
        .scan(0, |start, cell| {
            let own = *start;
            *start += cell.nodes.len();
            Some(own)
        })
        .collect();
    first.extend(0..starts.last().unwrap() + mesh.cell(mesh.num_cells() - 1).nodes.len());
    let mut users: HashMap<[u32; 2], Vec<Vec<(u32, usize)>>> = HashMap::new();
    for (index, cell) in mesh.cells().enumerate() {
        let (outline, intervals) = (cell.cell_type.outline(), cell.cell_type.edge_intervals());
        for edge in 0..cell.cell_type.num_corners() {
            let locals: Vec<usize> = (0..=intervals).map(|k| outline[(edge * intervals + k) % outline.len()]).collect();
            let ends = key(cell.nodes[locals[0]], cell.nodes[locals[intervals]]);
            let own = locals.iter().map(|&local| (cell.nodes[local], starts[index] + local)).collect();
            users.entry(ends).or_default().push(own);
        }
    }
    for (ends, sides) in users {
        if let ([one, other], false) = (sides.as_slice(), cut.contains(&ends)) {
            for &(node, a) in one {
                let b = other.iter().find(|(twin, _)| *twin == node).unwrap().1;
                let [a, b] = [a, b].map(|mut at| {
                    while first[at] != at {
                        at = first[at];
                    }
                    at
                });
                first[a.max(b)] = a.min(b);
            }
        }
    }
    (0..first.len()).filter(|&at| first[at] == at).count()
}

proptest! {
    #[test]
    fn any_line_along_edges_adds_a_node_for_each_fan_but_one(
        seed: u64,
        columns in 1_usize..6,
        rows in 1_usize..6,
        steps in 1_usize..14,
        quadratic: bool,
    ) {
        let mut random = Random::new(seed);
        let types = types_with_edge_intervals(if quadratic { 2 } else { 1 });
        let (whole, _) = jittered_mesh(&mut random, [columns, rows], &types, 3.0, 0.2);
        let neighbours = corner_neighbours(&whole);
        let corners: Vec<u32> = (0..whole.num_nodes() as u32).filter(|node| neighbours.contains_key(node)).collect();
        let mut path = vec![corners[random.index(corners.len())]];
        for _ in 0..steps {
            let next = &neighbours[path.last().unwrap()];
            path.push(next[random.index(next.len())]);
        }
        let points: Vec<[f64; 3]> = path.iter().map(|&node| whole.points()[node as usize]).collect();
        let needed = nodes_needed(&whole, &path);
        match whole.split(&points) {
            Ok(cut) => {
                check_cut(&whole, &cut);
                prop_assert!(cut.num_nodes() > whole.num_nodes());
                prop_assert_eq!(cut.num_nodes(), needed);
                prop_assert!(cut.coincident_nodes(Mesh::COINCIDENT).iter().all(|pair| (pair[0] as usize) < whole.num_nodes()));
            }
            Err(error) => {
                prop_assert_eq!(error, MeshError::Line(LineError::CutsNothing));
                prop_assert_eq!(needed, whole.num_nodes());
            }
        }
    }
}
