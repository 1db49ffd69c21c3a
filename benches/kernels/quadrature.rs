//! Preparing a reference image of one megapixel, per quadrature point: smoothing, quadrature points, grey levels and
//! gradients, Hessian and its factorisation.

#![allow(clippy::unwrap_used, missing_docs)]

use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fedic::{Camera, CellType, Correlator, ImageFrame, Mesh, Options, Quadrature, Rule};
use fedic_benches::{Picture, criterion, lens, pinhole, pixel_mesh, world_mesh};

const SIZE: [usize; 2] = [1024, 1024];

type Specimen = (Mesh, Arc<dyn Camera>);

fn quadrature(c: &mut Criterion) {
    let picture = Arc::new(Picture::new(SIZE, [0.0; 2]));
    let edges = Quadrature::default();
    let diameter = Quadrature::Mesh { rule: Rule::Diameter, density: 1.0 };
    let drawn = |cell_type| -> Specimen { (pixel_mesh(SIZE, cell_type), Arc::new(ImageFrame)) };
    let seen: Specimen = (world_mesh(SIZE, CellType::Quad), Arc::new(pinhole(SIZE).with_distortion(lens())));
    let cases: [(&str, Specimen, Quadrature); 6] = [
        ("quad/edges", drawn(CellType::Quad), edges),
        ("quad/diameter", drawn(CellType::Quad), diameter),
        ("quad/pixel", drawn(CellType::Quad), Quadrature::Pixel),
        ("quad/edges/pinhole", seen, edges),
        ("triangle/edges", drawn(CellType::Triangle), edges),
        ("quad9/edges", drawn(CellType::Quad9), edges),
    ];
    let mut group = c.benchmark_group("quadrature");
    for (name, (mesh, camera), quadrature) in cases {
        let prepare = || {
            let options = Options::default().quadrature(quadrature);
            Correlator::new(picture.clone(), &mesh, Arc::clone(&camera), options).unwrap()
        };
        group.throughput(Throughput::Elements(prepare().num_points() as u64));
        group.bench_function(name, |b| b.iter(prepare));
    }
    group.finish();
}

criterion_group! { name = benches; config = criterion(); targets = quadrature }
criterion_main!(benches);
