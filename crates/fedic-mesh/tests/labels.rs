//! Labels of nodes and cells.

#![allow(clippy::unwrap_used, missing_docs)]

use std::f64::consts::PI;

use fedic_mesh::{CellType, Mesh, MeshError, rectangle_mesh};

/// Two cells of four nodes each, side by side, with labels.
fn labelled() -> Mesh {
    let points =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [9.0, 9.0]];
    let mesh = Mesh::new(points.map(|[x, y]| [x, y, 0.0]).to_vec(), &[(CellType::Quad, (0..8).collect())]).unwrap();
    mesh.with_labels(Some(vec![10, 20, 30, 40, 15, 25, 35, 45, 7]), Some(vec![200, 100])).unwrap()
}

#[test]
fn transformations_keep_the_labels() {
    let mesh = labelled();
    let turned = mesh.rotated([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]], [0.0; 3]).unwrap();
    let moved = mesh.translated([1.0, 2.0, PI]).unwrap().scaled(3.0).unwrap();
    for other in [&turned, &moved, &mesh.collapsed_as_triangles(), &mesh.clone().with_sets([]).unwrap()] {
        assert_eq!((other.node_labels(), other.cell_labels()), (mesh.node_labels(), mesh.cell_labels()));
    }
    let (compact, _) = mesh.compact();
    assert_eq!(compact.node_labels().unwrap(), [10, 20, 30, 40, 15, 25, 35, 45]);
    assert_eq!(compact.cell_labels().unwrap(), [200, 100]);
}

#[test]
fn joined_nodes_have_the_label_of_the_one_that_is_kept() {
    let joined = labelled().merge_nodes(1e-9).unwrap();
    assert_eq!(joined.node_labels().unwrap(), [10, 20, 30, 40, 25, 35, 7]);
    assert_eq!(joined.cell_labels().unwrap(), [200, 100]);
}

#[test]
fn new_nodes_of_a_cut_have_labels_after_the_largest() {
    let mesh = labelled().merge_nodes(1e-9).unwrap();
    let line = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    let cut = mesh.split(&line).unwrap();
    assert_eq!(cut.node_labels().unwrap(), [10, 20, 30, 40, 25, 35, 7, 41, 42]);
    assert_eq!(cut.cell_labels().unwrap(), [200, 100]);
    let largest = vec![1, 2, 3, 4, 5, 6, Mesh::MAX_LABEL - 1];
    assert_eq!(mesh.clone().with_labels(Some(largest), None).unwrap().split(&line).unwrap().node_labels(), None);
    let none = mesh.with_labels(None, None).unwrap().split(&line).unwrap();
    assert_eq!((none.node_labels(), none.cell_labels()), (None, None));
}

#[test]
fn labels_that_do_not_tell_nodes_and_cells_apart_are_refused() {
    let mesh = rectangle_mesh([0.0, 0.0, 2.0, 1.0], 1.0, CellType::Quad).unwrap();
    let refused =
        |nodes: Option<Vec<i64>>, cells: Option<Vec<i64>>| mesh.clone().with_labels(nodes, cells).unwrap_err();
    let count = refused(Some(vec![1, 2]), None);
    assert_eq!(count, MeshError::LabelCount { kind: "node", expected: 6, found: 2 });
    assert_eq!(count.to_string(), "a mesh of 6 nodes has as many node labels; 2 were given");
    for label in [0, -3, Mesh::MAX_LABEL + 1] {
        let invalid = refused(None, Some(vec![5, label]));
        assert_eq!(invalid, MeshError::InvalidLabel { kind: "cell", index: 1, label });
    }
    let repeated = refused(Some(vec![4, 9, 3, 9, 5, 6]), None);
    assert_eq!(repeated, MeshError::RepeatedLabel { kind: "node", indices: [1, 3], label: 9 });
    assert_eq!(repeated.to_string(), "nodes 1 and 3 have the same label 9; labels tell nodes apart");
}
