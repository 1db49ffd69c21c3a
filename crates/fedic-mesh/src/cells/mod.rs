//! The cell types, under meshio's names and in its node order.
//!
//! Each type is one file with all its data ([`CellData`]) and its shape functions, and one line in the list below, which
//! makes the variants of [`CellType`] and every dispatch over them.

mod data;
mod domain;
mod shape;

use std::fmt;

pub use data::{CellData, GmshElement};
pub use domain::ReferenceDomain;
pub use shape::{shape_gradients, shape_values, shape_values_batch};

/// Declares the cell types: for each one its module, which holds `DATA`, `values` and `gradients`, and its variant.
macro_rules! cell_types {
    ($($(#[$doc:meta])* $module:ident::$variant:ident,)+) => {
        $(mod $module;)+

        /// Type of a surface cell.
        ///
        /// Corners come first, then the nodes of the edges (the first edge is the one between corners 0 and 1), then the
        /// nodes inside.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum CellType {
            $($(#[$doc])* $variant,)+
        }

        impl CellType {
            /// Every cell type, in the order of the variants.
            pub const ALL: [Self; [$(stringify!($variant)),+].len()] = [$(Self::$variant),+];

            /// Data of the cell type.
            pub const fn data(self) -> &'static CellData {
                match self {
                    $(Self::$variant => &$module::DATA,)+
                }
            }

            /// Calls a visitor with the number of nodes of the cell type as a compile-time constant.
            ///
            /// # Examples
            ///
            /// ```
            /// use fedic_mesh::{CellType, CellVisitor};
            ///
            /// /// Mean of the nodes of a cell, the loop unrolled for each number of nodes.
            /// struct Mean<'a>(&'a [f64]);
            ///
            /// impl CellVisitor for Mean<'_> {
            ///     type Output = f64;
            ///
            ///     fn visit<const N: usize>(self) -> f64 {
            ///         self.0[..N].iter().sum::<f64>() / N as f64
            ///     }
            /// }
            ///
            /// assert_eq!(CellType::Quad.visit(Mean(&[1.0, 2.0, 3.0, 4.0])), 2.5);
            /// ```
            #[inline]
            pub fn visit<V: CellVisitor>(self, visitor: V) -> V::Output {
                match self {
                    $(Self::$variant => visitor.visit::<{ $module::DATA.reference_nodes.len() }>(),)+
                }
            }

            fn padded_values(self, [xi, eta]: [f64; 2]) -> [f64; MAX_NODES] {
                match self {
                    $(Self::$variant => shape::padded($module::values(xi, eta)),)+
                }
            }

            fn padded_gradients(self, [xi, eta]: [f64; 2]) -> [[f64; 2]; MAX_NODES] {
                match self {
                    $(Self::$variant => shape::padded($module::gradients(xi, eta)),)+
                }
            }

            fn batch_values(self, xi: &[f64], eta: &[f64], out: &mut [f64]) {
                match self {
                    $(Self::$variant => shape::batch($module::values, xi, eta, out),)+
                }
            }
        }
    };
}

cell_types! {
    /// Three-node triangle, linear.
    triangle::Triangle,
    /// Six-node triangle, quadratic.
    triangle6::Triangle6,
    /// Four-node quadrilateral, bilinear.
    quad::Quad,
    /// Eight-node quadrilateral, quadratic serendipity.
    quad8::Quad8,
    /// Nine-node quadrilateral, biquadratic.
    quad9::Quad9,
}

/// Largest number of nodes of a cell.
pub const MAX_NODES: usize = {
    let (mut largest, mut index) = (0, 0);
    while index < CellType::ALL.len() {
        let nodes = CellType::ALL[index].num_nodes();
        if nodes > largest {
            largest = nodes;
        }
        index += 1;
    }
    largest
};

/// A computation that is compiled once for each number of nodes; see [`CellType::visit`].
pub trait CellVisitor {
    /// Result of the computation.
    type Output;

    /// Runs the computation for a cell of `N` nodes.
    fn visit<const N: usize>(self) -> Self::Output;
}

impl CellType {
    /// Number of nodes.
    pub const fn num_nodes(self) -> usize {
        self.data().reference_nodes.len()
    }

    /// Whether the cell is a triangle (three corners) or a quadrilateral (four).
    pub const fn is_triangle(self) -> bool {
        matches!(self.data().domain, ReferenceDomain::Triangle)
    }

    /// Number of corners, 3 or 4.
    pub const fn num_corners(self) -> usize {
        self.data().domain.corners().len()
    }

    /// Number of intervals into which the nodes of an edge divide it: 1 for linear cells, 2 for quadratic ones.
    pub const fn edge_intervals(self) -> usize {
        self.outline().len() / self.num_corners()
    }

    /// Area of the reference domain: 1/2 or 4.
    pub const fn reference_area(self) -> f64 {
        self.data().domain.area()
    }

    /// Centre of the reference domain.
    pub const fn reference_centre(self) -> [f64; 2] {
        self.data().domain.centre()
    }

    /// Nodes in the reference domain, `(xi, eta)` each.
    pub const fn reference_nodes(self) -> &'static [[f64; 2]] {
        self.data().reference_nodes
    }

    /// Local indices of the nodes around the cell, counter-clockwise from the first corner.
    pub const fn outline(self) -> &'static [usize] {
        self.data().outline
    }

    /// Local indices that list the nodes clockwise, from the first corner.
    pub(crate) const fn reversed(self) -> &'static [usize] {
        self.data().reversed
    }

    /// meshio's name of the cell type.
    pub const fn name(self) -> &'static str {
        self.data().name
    }

    /// Names of all cell types for a sentence: "triangle, triangle6, quad, quad8 and quad9" if `conjunction` is "and".
    pub(crate) fn names(conjunction: &str) -> String {
        let [first @ .., last] = Self::ALL;
        format!("{} {conjunction} {last}", first.map(Self::name).join(", "))
    }
}

impl fmt::Display for CellType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
