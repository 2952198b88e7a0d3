//! Apexes: points to which sides of a surface are collapsed, such as the apex of a cone or of a
//! pyramid.
//!
//! At a pole, such as that of a sphere, the normals from all sides have one limit. At an apex they
//! have several, perhaps on several pieces, and the surface has no normal there.

use glam::DVec3;

use super::chart_grid::ChartGrid;
use super::piece::HALF_THE_DIGITS;
use crate::geometry::RectSide;
use crate::patch::Piece;

/// Finds the apexes of a chart's pieces, judging by a few normals along each collapsed side.
pub(in crate::patch) fn mark(pieces: &mut [Piece], grid: &ChartGrid) {
    let ChartGrid { first, rows, columns } = *grid;
    for side in RectSide::ALL {
        // Sides of constant `s` follow each other from column to column, the others from row to
        // row.
        let (fixed, size) = (side.fixed(), [rows, columns]);
        let (lines, length) = (size[fixed], size[side.along()]);
        for line in 0..lines {
            let place = |k: usize| {
                let [row, column] = fixed.pair(line, k);
                first + row * columns + column
            };
            let mut start = 0;
            while start < length {
                let run = (start..length).take_while(|&k| pieces[place(k)].is_collapsed(side));
                let end = start + run.count();
                if !has_one_limit((start..end).map(|k| &pieces[place(k)]), side) {
                    (start..end).for_each(|k| pieces[place(k)].make_apex(side));
                }
                start = end + 1;
            }
        }
    }
}

/// Whether the normals along a collapsed side of some pieces, one after another, have one limit.
fn has_one_limit<'a>(mut pieces: impl Iterator<Item = &'a Piece>, side: RectSide) -> bool {
    // Places without a limit say nothing.
    let mut one: Option<DVec3> = None;
    pieces.all(|piece| {
        piece
            .limits_along(side)
            .all(|limit| limit.distance(*one.get_or_insert(limit)) <= HALF_THE_DIGITS)
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface, shapes};
    use crate::patch::PatchSet;

    fn apexes(surface: &NurbsSurface) -> Vec<bool> {
        let (set, _) = PatchSet::new(std::slice::from_ref(surface)).unwrap();
        let ends = set.pieces().iter().map(|piece| piece.is_apex(piece.patch.point(DVec2::Y)));
        ends.collect()
    }

    #[test]
    fn cones_and_pyramids_have_apexes_and_spheres_have_none() {
        let base = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)];
        let apex = DVec3::new(0.2, 0.1, 1.0);
        let net = base.iter().flat_map(|&(x, y)| [DVec3::new(x, y, 0.0), apex]).collect();
        let knots = |n| KnotVector::clamped_uniform(1, n).unwrap();
        let pyramid = NurbsSurface::new(knots(5), knots(2), net, None).unwrap();
        assert_eq!(apexes(&pyramid), [true; 4]);
        assert_eq!(apexes(&shapes::cone(1.0, 1.0).unwrap()), [true; 4]);

        // A fan in a plane has a normal everywhere.
        let flat = base.iter().flat_map(|&(x, y)| [DVec3::new(x, y, 0.0), DVec3::ZERO]).collect();
        let flat = NurbsSurface::new(knots(5), knots(2), flat, None).unwrap();
        assert_eq!(apexes(&flat), [false; 4]);
        let sphere = shapes::sphere(1.0).unwrap();
        assert!(apexes(&sphere).iter().all(|is_apex| !is_apex));
    }
}
