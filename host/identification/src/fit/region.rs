//! The region of a design: a box along axes of its own.
//!
//! Parameters that make up for each other (more Mw and less Mc, more Ms and less DV) leave a long, narrow valley of
//! small error, and a box along the parameters holds either its length or its width. The next design therefore lies
//! along the canonical axes of the last surface.
//! Source: G. E. P. Box, K. B. Wilson, J. R. Stat. Soc. B 13 (1951) 1.

use super::problem::Unknown;
use super::proposal::{curvature, positive};
use super::ranges::Ranges;
use crate::rsm::Surface;
use nalgebra::{DMatrix, DVector};

/// A region shrinks to this share of its width where its surface can't be believed.
const SHRINK: f64 = 0.5;

/// A believed region may grow by what another one shrinks …
const GROW: f64 = 1.0 / SHRINK;

/// … and shrink to this share of its width along each axis. Half and twice were not tried.
const STRONGEST_SHRINK: f64 = 0.15;

/// A region reaches this many standard deviations around its optimum: the truth is inside, whatever the next window
/// says.
const BOX_STDS: f64 = 5.0;

/// Beyond this share of the way to a face, the optimum lies on it.
const INSIDE: f64 = 0.9;

/// Narrower than this, relative to a value or its scale, differences drown in rounding.
const NARROWEST: f64 = 1e-6;

/// A box in the space of the unknowns: where its centre lies, and a column for each axis, from centre to face.
#[derive(Clone, Debug)]
pub struct Region {
    centre: DVector<f64>,
    reach: DMatrix<f64>,
}

impl Region {
    /// A box along the parameters.
    pub fn of_ranges(ranges: &Ranges) -> Self {
        let centre = ranges.0.iter().map(|(low, high)| 0.5 * (low + high));
        let half = ranges.0.iter().map(|(low, high)| 0.5 * (high - low));
        Self {
            centre: DVector::from_iterator(ranges.0.len(), centre),
            reach: DMatrix::from_diagonal(&DVector::from_iterator(ranges.0.len(), half)),
        }
    }

    /// How much each parameter changes from the centre to the face of an axis.
    pub fn axis(&self, axis: usize) -> Vec<f64> {
        self.reach.column(axis).iter().copied().collect()
    }

    /// How far the box reaches along each parameter.
    pub fn ranges(&self) -> Ranges {
        let half = self.half_widths();
        Ranges(self.centre.iter().zip(&half).map(|(centre, half)| (centre - half, centre + half)).collect())
    }

    fn half_widths(&self) -> Vec<f64> {
        self.reach.row_iter().map(|row| row.iter().map(|x| x.abs()).sum()).collect()
    }

    /// The same box around a guess, moved (not cut) to stay within the limits of the unknowns where it fits.
    pub fn around(&self, values: &[f64], unknowns: &[Unknown]) -> Self {
        let mut moved = Self { centre: DVector::from_column_slice(values), reach: self.reach.clone() };
        for (j, unknown) in unknowns.iter().enumerate() {
            let widest = 0.5 * (unknown.high - unknown.low);
            let too_wide = moved.half_widths()[j] / widest;
            if too_wide > 1.0 {
                moved.reach.row_mut(j).scale_mut(too_wide.recip());
            }
            let half = moved.half_widths()[j].min(widest);
            let wanted = moved.centre[j].clamp(unknown.low + half, unknown.high - half);
            moved.slide(j, wanted - moved.centre[j]);
        }
        moved
    }

    /// Moves the centre along the valley until one of its values has changed by so much.
    fn slide(&mut self, j: usize, change: f64) {
        let row = self.reach.row(j).transpose();
        let square = row.norm_squared();
        if change != 0.0 && square > 0.0 {
            self.centre += &self.reach * row * (change / square);
        }
    }

    /// Is the box too narrow to learn from?
    pub fn is_spent(&self, unknowns: &[Unknown]) -> bool {
        let narrow = |(j, half): (usize, f64)| half < NARROWEST * self.centre[j].abs().max(unknowns[j].scale);
        self.half_widths().into_iter().enumerate().all(narrow)
    }

    /// The values at a point of the box, within the limits of the unknowns.
    pub fn natural(&self, coded: &[f64], unknowns: &[Unknown]) -> Vec<f64> {
        let values = &self.centre + &self.reach * DVector::from_column_slice(coded);
        values.iter().zip(unknowns).map(|(value, unknown)| value.clamp(unknown.low, unknown.high)).collect()
    }

    /// Where values lie in the box; its centre if that can't be told.
    pub fn coded(&self, values: &[f64]) -> Vec<f64> {
        let coded = self.reach.clone().lu().solve(&(DVector::from_column_slice(values) - &self.centre));
        coded.map_or_else(|| vec![0.0; values.len()], |coded| coded.as_slice().to_vec())
    }

    /// All sides halved, when the surface can't be believed.
    pub fn halved(&self) -> Self {
        Self { centre: self.centre.clone(), reach: SHRINK * &self.reach }
    }

    /// The box along the canonical axes of a believed surface of mean square errors: along each it reaches a few
    /// standard deviations of the optimum; it grows where the chosen values lie on a face.
    ///
    /// The standard deviations come from the noise (n·mse is the sum of squares, so its curvature is twice JᵀJ) and
    /// from the surface's own error, which tilts it.
    pub fn canonical(&self, error: &Surface, values: &[f64], mse: f64, n_samples: f64) -> Self {
        let eigen = positive(&curvature(error)).symmetric_eigen();
        let chosen = DVector::from_vec(self.coded(values));
        let tilt = error.residual_standard_error().unwrap_or(0.0);
        let mut axes = eigen.eigenvectors;
        for (mut axis, curvature) in axes.column_iter_mut().zip(&eigen.eigenvalues) {
            let std = (2.0 * mse / n_samples / curvature + (tilt / curvature).powi(2)).sqrt();
            let is_inside = axis.dot(&chosen).abs() < INSIDE * axis.abs().sum();
            let half = if is_inside { (BOX_STDS * std).clamp(STRONGEST_SHRINK, GROW) } else { GROW };
            axis.scale_mut(half);
        }
        Self { centre: self.centre.clone(), reach: &self.reach * axes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_along_the_parameters_has_their_ranges() {
        let ranges = Ranges(vec![(-1.0, 3.0), (10.0, 11.0)]);
        let region = Region::of_ranges(&ranges);
        assert_eq!(region.ranges(), ranges);
        assert_eq!([region.axis(0), region.axis(1)], [[2.0, 0.0], [0.0, 0.5]]);
        assert_eq!(region.coded(&[3.0, 10.25]), [1.0, -0.5]);
    }
}
