//! Points that are the same up to rounding.

use std::collections::HashMap;

use glam::DVec3;

/// Points are the same if they are no farther apart than this fraction of the largest coordinate. A
/// point of a curve on a surface results from about a hundred operations, each with an error of
/// half an ulp of the weighted coordinates; and two things this near to each other look like one.
pub(super) const SAME: f64 = 4096.0 * f64::EPSILON;

/// Assigns numbers to places: one number to all points that are the same up to rounding.
///
/// Points are stored in the cells of a grid several tolerances wide, and looked up in the cells to
/// which they are near: mostly one, at most eight. Of several places near a point, the first is
/// chosen.
#[derive(Debug)]
pub(super) struct Places {
    tolerance: f64,
    points: Vec<DVec3>,
    cells: HashMap<[i64; 3], Vec<usize>>,
}

/// The width of a cell in tolerances: any number for which most points are near one cell only.
const CELL: f64 = 16.0;

impl Places {
    /// An empty set of places, for points with coordinates of up to this magnitude.
    pub(super) fn new(magnitude: f64) -> Self {
        Self { tolerance: SAME * magnitude, points: Vec::new(), cells: HashMap::new() }
    }

    /// The distance up to which points are the same.
    pub(super) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The number of the place of a point; adds a new place if there is none.
    pub(super) fn find_or_add(&mut self, point: DVec3) -> usize {
        let cell = |at: DVec3| {
            // Shifted, so that round numbers do not lie on the grid's planes.
            (at / (CELL * self.tolerance) + 0.3).floor().to_array().map(|x| x as i64)
        };
        let reach = DVec3::splat(self.tolerance);
        let (low, high) = (cell(point - reach), cell(point + reach));
        let mut found: Option<usize> = None;
        for x in low[0]..=high[0] {
            for (y, z) in (low[1]..=high[1]).flat_map(|y| (low[2]..=high[2]).map(move |z| (y, z))) {
                let there = self.cells.get(&[x, y, z]).into_iter().flatten();
                let near = |index: &&usize| self.points[**index].distance(point) <= self.tolerance;
                found = there.filter(near).copied().chain(found).min();
            }
        }
        found.unwrap_or_else(|| {
            self.cells.entry(cell(point)).or_default().push(self.points.len());
            self.points.push(point);
            self.points.len() - 1
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wherever a point lies in its cell, points within the tolerance are found, and no others.
    #[test]
    fn points_are_one_to_within_the_tolerance() {
        for magnitude in [1e-8, 1.0, 1e8] {
            let step = SAME * magnitude;
            for k in 0..200 {
                let at = DVec3::new(0.1, -0.7, 0.3) * magnitude + step * 0.37 * f64::from(k);
                let mut places = Places::new(magnitude);
                assert_eq!(places.find_or_add(at), 0);
                for (index, axis) in DVec3::AXES.into_iter().enumerate() {
                    assert_eq!(places.find_or_add(at + 0.9 * step * axis), 0, "{k}");
                    assert_eq!(places.find_or_add(at - 0.9 * step * axis), 0, "{k}");
                    assert_eq!(places.find_or_add(at + 1.2 * step * axis), index + 1, "{k}");
                }
            }
        }
    }
}
