//! Measures the displacement between two images: `cargo run --release --example correlate_pair -- REF DEF [SIZE]`.
//!
//! The mesh is a rectangle of quads of SIZE pixels (20 unless given) that covers the image but for a margin; the result
//! is printed, and written beside the deformed image as a table `x, y, u, v` in pixels.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use fedic::{CellType, Correlator, Image, ImageFrame, ImageView, Options, Pixels, Start, rectangle_mesh};

const MARGIN: f64 = 0.1;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.as_slice() {
        [reference, deformed] => run(reference, deformed, 20.0),
        [reference, deformed, size] => match size.parse() {
            Ok(size) => run(reference, deformed, size),
            Err(_) => Err(format!("SIZE must be a number of pixels, got {size}").into()),
        },
        _ => Err("usage: correlate_pair REF DEF [SIZE]".into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(reference: &str, deformed: &str, size: f64) -> Result<(), Box<dyn Error>> {
    let (f, g) = (read(reference)?, read(deformed)?);
    let start = Instant::now();
    let [width, height] = [f.width(), f.height()].map(f64::from);
    let margin = MARGIN * width.min(height);
    let mesh = rectangle_mesh([margin, margin, width - margin, height - margin], size, CellType::Quad)?;

    let pixels = f.as_raw().iter().copied().map(f32::from).collect();
    let reference = Image::new(f.width() as usize, f.height() as usize, pixels)?;
    let correlator = Correlator::new(Arc::new(reference), &mesh, Arc::new(ImageFrame), Options::default())?;
    let solution = correlator.correlate(view(&g)?, Start::Pyramid)?;

    println!(
        "{} nodes, {} quadrature points: {} after {} iterations, residual {:.3} grey levels, {:.2} s",
        mesh.num_nodes(),
        solution.num_points,
        if solution.converged { "converged" } else { "NOT converged" },
        solution.iterations,
        solution.residual_rms,
        start.elapsed().as_secs_f64()
    );
    let count = mesh.num_nodes() as f64;
    for (c, name) in ["u", "v"].into_iter().enumerate() {
        let values = solution.displacement.iter().map(|u| u[c]);
        let mean = values.clone().sum::<f64>() / count;
        let std = (values.map(|u| (u - mean).powi(2)).sum::<f64>() / count).sqrt();
        println!("{name}: mean {mean:+.4} px, standard deviation over the nodes {std:.4} px");
    }

    let mut table = String::from("x,y,u,v\n");
    for (point, u) in mesh.points().iter().zip(&solution.displacement) {
        writeln!(table, "{},{},{},{}", point[0], point[1], u[0], u[1])?;
    }
    let path = Path::new(deformed).with_extension("csv");
    std::fs::write(&path, table)?;
    println!("wrote {}", path.display());
    Ok(())
}

fn read(path: &str) -> Result<image::ImageBuffer<image::Luma<u16>, Vec<u16>>, Box<dyn Error>> {
    let image = image::open(path).map_err(|error| format!("{path}: {error}"))?;
    // 8-bit images keep their own grey levels.
    Ok(match image {
        image::DynamicImage::ImageLuma16(_) | image::DynamicImage::ImageRgb16(_) => image.into_luma16(),
        other => {
            let eight = other.into_luma8();
            image::ImageBuffer::from_fn(eight.width(), eight.height(), |u, v| {
                image::Luma([u16::from(eight.get_pixel(u, v).0[0])])
            })
        }
    })
}

fn view(image: &image::ImageBuffer<image::Luma<u16>, Vec<u16>>) -> Result<ImageView<'_>, fedic::ImageError> {
    ImageView::new(image.width() as usize, image.height() as usize, Pixels::U16(image.as_raw()))
}
