//! What the benchmarks share: a synthetic picture, a camera and a mesh of the size of a measurement, and the settings of
//! criterion. Nothing here is timed.

#![allow(clippy::unwrap_used)]

use std::time::Duration;

use criterion::Criterion;
use fedic::{
    BrownDistortion, CellType, ImageSource, ImageView, Mesh, Pinhole, Pixels, rectangle_mesh, rotation_from_vector,
};
use fedic_synthetic::Speckle;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Columns and rows of a 5-megapixel sensor.
pub const SENSOR: [usize; 2] = [2448, 2048];
/// Pixels between the border of the image and the mesh.
pub const MARGIN: f64 = 100.0;
/// Size of the elements, in pixels.
pub const ELEMENT: f64 = 20.0;
/// Distance of the specimen from the camera of [`pinhole`].
pub const DISTANCE: f64 = 1630.0;
/// Focal length of the camera of [`pinhole`], in pixels.
pub const FOCAL: f64 = 8381.24;

/// Few and short samples: the benchmarks watch for changes of a few percent, and all of them together last two minutes.
pub fn criterion() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .nresamples(5_000)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800))
}

/// A pool of `num_threads` threads.
pub fn pool(num_threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(num_threads).build().unwrap()
}

/// An 8-bit picture of a speckle, row after row.
#[derive(Debug)]
pub struct Picture {
    size: [usize; 2],
    grey: Vec<u8>,
}

impl Picture {
    /// A picture of `size = [width, height]` whose texture moved by `shift` pixels.
    pub fn new(size: [usize; 2], shift: [f64; 2]) -> Self {
        let speckle = Speckle::new(5.0, 0.5, 1).unwrap();
        let grey = (0..size[0] * size[1]).into_par_iter().map(|index| {
            let (u, v) = ((index % size[0]) as f64, (index / size[0]) as f64);
            (25.0 + 205.0 * speckle.value([u - shift[0], v - shift[1]])).round() as u8
        });
        Self { size, grey: grey.collect() }
    }

    /// The picture as fedic reads it.
    pub fn view(&self) -> ImageView<'_> {
        ImageView::new(self.size[0], self.size[1], Pixels::U8(&self.grey)).unwrap()
    }

    /// Number of pixels.
    pub fn len(&self) -> u64 {
        self.grey.len() as u64
    }

    /// Whether it has no pixel.
    pub fn is_empty(&self) -> bool {
        self.grey.is_empty()
    }
}

impl ImageSource for Picture {
    fn with_view(&self, use_view: &mut (dyn FnMut(ImageView<'_>) + Send)) -> Result<(), String> {
        use_view(self.view());
        Ok(())
    }
}

/// A lens of radial distortion alone, as most calibrations find it.
pub fn lens() -> BrownDistortion {
    BrownDistortion::new([-0.032_125_3, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap()
}

/// A camera without distortion in front of the plane `Z = 0`, whose origin it sees at the centre of an image of `size`.
pub fn pinhole(size: [usize; 2]) -> Pinhole {
    let centre = size.map(|pixels| 0.5 * (pixels as f64 - 1.0));
    let upright = rotation_from_vector([std::f64::consts::PI, 0.0, 0.0]);
    Pinhole::new([FOCAL; 2], centre, upright, [0.0, 0.0, DISTANCE]).unwrap()
}

/// Mesh drawn in the pixels of an image of `size`.
pub fn pixel_mesh(size: [usize; 2], cell_type: CellType) -> Mesh {
    let [width, height] = size.map(|pixels| pixels as f64 - MARGIN);
    rectangle_mesh([MARGIN, MARGIN, width, height], ELEMENT, cell_type).unwrap()
}

/// Mesh of the same region in the world of [`pinhole`].
pub fn world_mesh(size: [usize; 2], cell_type: CellType) -> Mesh {
    let unit = DISTANCE / FOCAL;
    let [x, y] = size.map(|pixels| (0.5 * pixels as f64 - MARGIN) * unit);
    rectangle_mesh([-x, -y, x, y], ELEMENT * unit, cell_type).unwrap()
}

/// `count` numbers between -0.5 and 0.5 without order, always the same.
pub fn jitter(count: usize) -> impl Iterator<Item = f64> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    (0..count).map(|index| (index as f64 * GOLDEN).fract() - 0.5)
}
