//! Packed storage of the columns of a supernode.

use faer::Mat;
use fedic_memory::Pod;
use pulp::Simd;

use crate::symbolic::Shape;

/// Largest number of `f64` lanes of a SIMD vector.
const MAX_LANES: usize = 8;

/// Storage type of the factor; all arithmetic is in double precision.
pub(crate) trait StoredFloat: Pod + Send + Sync {
    fn store(value: f64) -> Self;
    fn load(self) -> f64;
    /// Loads the first values, one per lane.
    fn load_vector<S: Simd>(values: &[Self]) -> S::f64s;
}

impl StoredFloat for f64 {
    fn store(value: f64) -> Self {
        value
    }
    fn load(self) -> f64 {
        self
    }
    #[inline(always)]
    fn load_vector<S: Simd>(values: &[Self]) -> S::f64s {
        S::as_simd_f64s(&values[..S::F64_LANES]).0[0]
    }
}

impl StoredFloat for f32 {
    fn store(value: f64) -> Self {
        value as f32
    }
    fn load(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn load_vector<S: Simd>(values: &[Self]) -> S::f64s {
        let mut vector = [0.0; MAX_LANES];
        vector.iter_mut().zip(&values[..S::F64_LANES]).for_each(|(to, &from)| *to = from.load());
        f64::load_vector::<S>(&vector)
    }
}

/// The columns of a supernode, one after the other, each from the diagonal down.
#[derive(Clone, Copy)]
pub(crate) struct PackedColumns<'a, T> {
    pub(crate) values: &'a [T],
    pub(crate) shape: Shape,
}

impl<'a, T: StoredFloat> PackedColumns<'a, T> {
    /// One column, from the diagonal down.
    #[inline(always)]
    pub(crate) fn column(&self, j: usize) -> &'a [T] {
        let start = self.shape.packed_start(j);
        &self.values[start..start + self.shape.rows - j]
    }

    /// All rows of the columns, zero above the diagonal.
    pub(crate) fn to_dense(self) -> Mat<f64> {
        let mut dense = Mat::zeros(self.shape.rows, self.shape.columns);
        for j in 0..self.shape.columns {
            for (i, value) in (j..).zip(self.column(j)) {
                dense[(i, j)] = value.load();
            }
        }
        dense
    }
}

/// Packs dense columns of `rows` rows.
pub(super) fn pack<T: StoredFloat>(columns: &[f64], rows: usize, mut packed: &mut [T]) {
    for (j, column) in columns.chunks_exact(rows).enumerate() {
        let (own, others) = packed.split_at_mut(rows - j);
        own.iter_mut().zip(&column[j..]).for_each(|(packed, &value)| *packed = T::store(value));
        packed = others;
    }
}
