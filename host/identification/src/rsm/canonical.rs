//! Canonical analysis: what kind of hill, valley or saddle a surface is, and where its flat point lies.
//!
//! With y = b0 + bᵀx + xᵀBx the flat point is −½·B⁻¹b; the eigenvalues of B are the curvatures along the principal
//! axes.
//! Source: G. E. P. Box, K. B. Wilson, J. R. Stat. Soc. B 13 (1951) 1.

use super::surface::Surface;
use super::term::Term;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::Serialize;

/// A curvature below this fraction of the largest is none: the surface is a ridge along that axis.
const FLAT: f64 = 1e-9;

/// The shape about the stationary point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum StationaryKind {
    /// Curved upwards along every axis.
    Minimum,
    /// Curved downwards along every axis.
    Maximum,
    /// Up along some axes, down along others.
    Saddle,
    /// Not curved along at least one axis, so there is no single flat point.
    Ridge,
}

/// A surface in its principal axes, in coded units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Canonical {
    /// The shape.
    pub kind: StationaryKind,
    /// Where all slopes vanish, one value a factor, possibly far outside −1 to +1; absent for a ridge.
    pub stationary: Option<Vec<f64>>,
    /// The response there.
    pub response: Option<f64>,
    /// Curvatures, response per squared coded unit, from the most negative to the most positive.
    pub curvatures: Vec<f64>,
    /// Unit vectors, one for each curvature.
    pub axes: Vec<Vec<f64>>,
}

/// Analyses one surface.
pub fn canonical(surface: &Surface) -> Canonical {
    let (slopes, curvature_matrix) = quadratic_form(surface);
    let eigen = SymmetricEigen::new(curvature_matrix);
    let mut order: Vec<usize> = (0..slopes.len()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let kind = kind_of(&eigen.eigenvalues, surface.coefficients().amax());
    let stationary = (kind != StationaryKind::Ridge).then(|| flat_point(&eigen, &slopes));
    Canonical {
        kind,
        response: stationary.as_ref().map(|point| surface.predict(point)),
        stationary,
        curvatures: order.iter().map(|&idx| eigen.eigenvalues[idx]).collect(),
        axes: order.iter().map(|&idx| eigen.eigenvectors.column(idx).iter().copied().collect()).collect(),
    }
}

/// The slopes b at the centre and the symmetric matrix B.
fn quadratic_form(surface: &Surface) -> (DVector<f64>, DMatrix<f64>) {
    let n_factors = surface.factors().len();
    let (mut slopes, mut curvature) = (DVector::zeros(n_factors), DMatrix::zeros(n_factors, n_factors));
    for (term, &coefficient) in surface.terms().iter().zip(surface.coefficients()) {
        match *term {
            Term::Intercept => {}
            Term::Linear(i) => slopes[i] = coefficient,
            Term::Square(i) => curvature[(i, i)] = coefficient,
            Term::Interaction(i, j) => {
                curvature[(i, j)] = 0.5 * coefficient;
                curvature[(j, i)] = 0.5 * coefficient;
            }
        }
    }
    (slopes, curvature)
}

/// `scale` is the largest coefficient: curvatures that are rounding of it are none.
fn kind_of(curvatures: &DVector<f64>, scale: f64) -> StationaryKind {
    let flat = (FLAT * curvatures.amax()).max(f64::EPSILON * 100.0 * scale);
    if curvatures.iter().any(|curvature| curvature.abs() <= flat) {
        StationaryKind::Ridge
    } else if curvatures.min() > 0.0 {
        StationaryKind::Minimum
    } else if curvatures.max() < 0.0 {
        StationaryKind::Maximum
    } else {
        StationaryKind::Saddle
    }
}

fn flat_point(eigen: &SymmetricEigen<f64, nalgebra::Dyn>, slopes: &DVector<f64>) -> Vec<f64> {
    let along_axes = eigen.eigenvectors.tr_mul(slopes).component_div(&eigen.eigenvalues);
    (&eigen.eigenvectors * along_axes * -0.5).iter().copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rsm::coding::Factor;
    use crate::rsm::design::Design;

    fn analysed(height: impl Fn(f64, f64) -> f64) -> Canonical {
        let factors = ["a", "b"].map(|name| Factor::new(name, 0.0, 1.0).unwrap());
        let design = Design::face_centred(factors.to_vec(), 1).unwrap();
        let responses: Vec<f64> = design.coded_runs().iter().map(|run| height(run[0], run[1])).collect();
        canonical(&Surface::fit(&design, &responses).unwrap())
    }

    #[test]
    fn bowls_hills_and_saddles_are_told_apart() {
        assert_eq!(analysed(|x, y| x * x + 3.0 * y * y + x * y).kind, StationaryKind::Minimum);
        assert_eq!(analysed(|x, y| -x * x - 3.0 * y * y + x * y).kind, StationaryKind::Maximum);
        assert_eq!(analysed(|x, y| x * y + 0.3 * x).kind, StationaryKind::Saddle);
    }

    #[test]
    fn the_flat_point_of_a_turned_bowl_is_found_with_its_curvatures() {
        let bowl = analysed(|x, y| 7.0 + (x + y - 0.4).powi(2) + 0.5 * (x - y + 0.2).powi(2));
        let point = bowl.stationary.unwrap();
        assert!((point[0] - 0.1).abs() < 1e-12 && (point[1] - 0.3).abs() < 1e-12);
        assert!((bowl.response.unwrap() - 7.0).abs() < 1e-12);
        assert!((bowl.curvatures[0] - 1.0).abs() < 1e-12 && (bowl.curvatures[1] - 2.0).abs() < 1e-12);
    }

    #[test]
    fn planes_and_troughs_have_no_single_flat_point() {
        for ridge in [analysed(|x, y| 1.0 + x - y), analysed(|x, y| (x + y).powi(2) + x), analysed(|_, _| 0.0)] {
            assert_eq!((ridge.kind, ridge.stationary), (StationaryKind::Ridge, None));
        }
    }
}
