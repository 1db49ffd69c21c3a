//! Evidence and flags of a measured field.

/// Correlation coefficient of a cell below which its images do not show the same texture.
pub const MIN_CORRELATION: f64 = 0.6;
/// Error of a node, in pixels, whose residual is looked for in its cells.
pub const NODE_ERROR: f64 = 0.3;
/// Distance of a residual from that of the noise alone, in standard deviations, from which it is significant.
pub const SIGNIFICANCE: f64 = 5.0;
/// Largest predicted standard deviation of a node in pixels: a third of [`NODE_ERROR`].
pub const MAX_DEVIATION: f64 = 0.1;

/// Smallest ratio of the gradient of a cell to that of the noise alone.
pub const GRADIENT_TO_NOISE: f64 = 2.0;
/// Displacement in pixels that would cause as large a residual as the difference in brightness of a cell from the correction in use:
/// from about this on, nodes are wrong by [`NODE_ERROR`].
pub const MAX_LIGHT: f64 = 0.5;

/// Evidence and flags of a measured field. Nodes are those of the mesh, cells are counted over all blocks.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Quality {
    /// Standard deviation of the noise of one image, in grey levels: the option `noise`, or estimated from the residual of the
    /// cells whose images correlate. NaN if there is none.
    pub noise: f64,
    /// Share of the area of each cell that was used, from 0 to 1.
    pub used_share: Vec<f64>,
    /// Share of the weight of each cell that robust weights keep, from 0 to 1; 1 without outliers.
    pub kept_share: Vec<f64>,
    /// Correlation coefficient of the two images over each cell; NaN without points.
    pub correlation: Vec<f64>,
    /// Residual of each cell relative to that of the noise, without its own gain and offset; NaN without points.
    pub normalized_residual: Vec<f64>,
    /// Displacement in pixels, root mean square over the cell, that would explain the residual beyond the noise; NaN without points.
    pub misfit: Vec<f64>,
    /// Bits of [`CellFlag`](crate::CellFlag) of each cell.
    pub cell_flags: Vec<u8>,
    /// Standard deviation of each node due to the noise, in pixels, in its worst direction and for neighbours without noise. A penalty
    /// is not counted.
    pub deviation: Vec<f64>,
    /// Ratio of the standard deviation in the best direction to that in the worst, from 0 to 1; NaN without points.
    pub conditioning: Vec<f64>,
    /// Bits of [`NodeFlag`](crate::NodeFlag) of each node.
    pub node_flags: Vec<u8>,
}
