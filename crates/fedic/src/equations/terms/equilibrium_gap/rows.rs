//! Rows of the stiffness matrix of a mesh.

use nalgebra::Matrix3;

use super::stiffness::CellStiffness;
use crate::equations::dofs::Dofs;
use crate::parallel::for_each_in_order;
use crate::{Error, Monitor, OptionError, PLANE};

/// The rows of the stiffness matrix that give the internal force at each node, from the displacement of its star.
pub(super) struct ForceRows<'a> {
    /// Nodes of the star of each node.
    stars: &'a [Vec<u32>],
    /// Entries of the rows of each node, one row for each component.
    rows: Vec<[Vec<f64>; PLANE]>,
    /// Area that each node stands for.
    areas: Vec<f64>,
}

impl<'a> ForceRows<'a> {
    /// Assembles the rows for a law, on a mesh whose stars are coupled.
    ///
    /// # Errors
    ///
    /// [`OptionError::Invalid`] if a cell is parallel to `z` somewhere; [`Error::Cancelled`] if `monitor` asks to stop.
    pub(super) fn new(dofs: &'a Dofs<PLANE>, law: &Matrix3<f64>, monitor: &dyn Monitor) -> Result<Self, Error> {
        let (mesh, stars) = (&dofs.mesh, dofs.groups.as_slice());
        let empty = |star: &Vec<u32>| [0; PLANE].map(|_| vec![0.0; PLANE * star.len()]);
        let mut rows: Vec<[Vec<f64>; PLANE]> = stars.iter().map(empty).collect();
        let mut areas = vec![0.0; stars.len()];
        let mut parallel = None;
        for_each_in_order(
            0..mesh.num_cells(),
            monitor,
            |(): &mut (), _, cell| CellStiffness::new(mesh, cell, law),
            |cell, stiffness| {
                let Some(CellStiffness { matrix, areas: parts }) = stiffness else {
                    parallel = parallel.or(Some(cell));
                    return;
                };
                let nodes = mesh.cell(cell).nodes;
                for (a, &node) in nodes.iter().enumerate() {
                    areas[node as usize] += parts[a];
                    let star = &stars[node as usize];
                    for (b, other) in nodes.iter().enumerate() {
                        let Ok(place) = star.binary_search(other) else { continue };
                        for (c, row) in rows[node as usize].iter_mut().enumerate() {
                            (0..PLANE).for_each(|d| row[PLANE * place + d] += matrix[(PLANE * a + c, PLANE * b + d)]);
                        }
                    }
                }
            },
        )?;
        match parallel {
            None => Ok(Self { stars, rows, areas }),
            Some(cell) => {
                let expected = "\"smooth\" where cells are parallel to the z axis: the stresses of the equilibrium gap are in \
                                the plane of x and y";
                Err(OptionError::invalid("regularization", expected, &format!("the equilibrium gap and cell {cell}"))
                    .into())
            }
        }
    }

    /// Area that a node stands for.
    pub(super) fn area(&self, node: usize) -> f64 {
        self.areas[node]
    }

    /// Matrix of the squared force at a node, divided by its area, in the unknowns of its star.
    pub(super) fn squared(&self, node: usize) -> Vec<f64> {
        let width = PLANE * self.stars[node].len();
        let mut entries = vec![0.0; width * width];
        for row in &self.rows[node] {
            for (line, &a) in entries.chunks_exact_mut(width).zip(row) {
                line.iter_mut().zip(row).for_each(|(entry, &b)| *entry += a * b / self.areas[node]);
            }
        }
        entries
    }

    /// Mean over some fields of the squared force at a node, divided by its area; zero without fields.
    pub(super) fn mean_square(&self, node: usize, fields: &[Vec<[f64; PLANE]>]) -> f64 {
        let star = &self.stars[node];
        let force = |row: &Vec<f64>, field: &Vec<[f64; PLANE]>| -> f64 {
            let displacements = star.iter().flat_map(|&node| field[node as usize]);
            row.iter().zip(displacements).map(|(entry, u)| entry * u).sum()
        };
        let square = |field| self.rows[node].iter().map(|row| force(row, field).powi(2)).sum::<f64>();
        fields.iter().map(square).sum::<f64>() / fields.len().max(1) as f64 / self.areas[node]
    }
}
