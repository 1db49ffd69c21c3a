//! Energy of waves, summed over the parts of a mesh.

/// Energies of the waves of both kinds over the parts of a mesh, those inside the mesh apart.
#[derive(Default)]
pub(crate) struct Energies {
    inside: Sum,
    all: Sum,
}

#[derive(Default)]
struct Sum {
    energies: [f64; 2],
    area: f64,
}

impl Energies {
    /// Adds the energies of a part.
    pub(crate) fn add(&mut self, area: f64, energies: [f64; 2], is_inside: bool) {
        self.all.add(area, energies);
        if is_inside {
            self.inside.add(area, energies);
        }
    }

    /// Energies for an area of the mesh, from the parts inside if there are any: at the edges of a mesh a penalty differs.
    pub(crate) fn over(&self, area: f64) -> [f64; 2] {
        let sum = if self.inside.area > 0.0 { &self.inside } else { &self.all };
        sum.energies.map(|energy| energy * area / sum.area)
    }

    /// Area of all parts.
    pub(crate) fn area(&self) -> f64 {
        self.all.area
    }
}

impl Sum {
    fn add(&mut self, area: f64, energies: [f64; 2]) {
        self.area += area;
        self.energies.iter_mut().zip(energies).for_each(|(sum, energy)| *sum += energy);
    }
}
