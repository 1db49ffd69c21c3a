//! Penalty on the equilibrium gap: fields in equilibrium cost nothing, shear waves of the stated length lose half of their amplitude,
//! and noise is lowered.

#![allow(clippy::unwrap_used)]

mod fields;
mod noise;
mod scene;
mod waves;
