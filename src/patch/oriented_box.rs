//! Boxes that follow a leaf's tangents.

use glam::{DVec2, DVec3, DVec4};

use super::ScaledFrame;
use super::pieces::tensor::euclidean;
use crate::math::RayFrame;

/// A ray whose component along a row is smaller than this runs along the slab: nothing can be
/// divided by it.
const LEAST_ALONG: f64 = 1e-300;

/// A chord shorter than this fraction of the other is of no use as a direction: it may be all
/// rounding error.
const SHORTEST_CHORD: f64 = 1e-6;

/// A chord whose angle to the other has a smaller sine than this is of no use either.
const APART: f64 = 1e-3;

/// A parallelepiped around a leaf: the points `P`, in scaled coordinates, with
/// `|rowₖ · P − offsetₖ| ≤ 1`.
///
/// The first two coordinates follow the leaf's parameters, the third its normal, so the
/// place where a ray crosses the third coordinate's zero is a good first guess of `(s, t)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrientedBox {
    /// Each row with its offset.
    pub rows: [[f32; 4]; 3],
}

/// Three independent directions to measure a leaf in: the first two along its chords, the third
/// perpendicular to both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    pub(super) axes: [DVec3; 3],
    /// `dualⱼ · axisₖ` is 1 for `j = k`, else 0.
    pub(super) dual: [DVec3; 3],
}

/// Where a ray passes an oriented box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    /// Where along the ray it enters, in scene units from the origin.
    pub entry: f64,
    /// Where it leaves.
    pub exit: f64,
    /// The first two box coordinates where the ray crosses the middle plane, cut to `±1`.
    pub middle: DVec2,
}

impl OrientedBox {
    /// Boxes are grown by this length in scaled coordinates: it covers the rounding of rows,
    /// origins and directions to f32, and of what is computed from them, over the distances a ray
    /// has inside the scene. (The roundings are counted where these are known, in
    /// `intersect/f32_reach`.)
    pub(crate) const GROWTH: f64 = 5e-6;

    /// A box around control points.
    ///
    /// `noise` is the error bound of the points; no side is thinner.
    pub(super) fn around(net: &[DVec4], axes: &Axes, noise: f64, frame: &ScaledFrame) -> Self {
        let Axes { axes, dual } = axes;
        let [a, b, n] = *dual;
        let origin = euclidean(net[net.len() / 2]);
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for &c in net {
            let from_origin = euclidean(c) - origin;
            let local = DVec3::new(a.dot(from_origin), b.dot(from_origin), n.dot(from_origin));
            low = low.min(local);
            high = high.max(local);
        }

        let middle = 0.5 * (low + high);
        let center = origin + middle.x * axes[0] + middle.y * axes[1] + middle.z * axes[2];
        let center = frame.scaled(center);
        let lengths = DVec3::from_array(dual.map(DVec3::length));
        let thinnest = 4.0 * noise * lengths + f64::MIN_POSITIVE;
        let half = (0.5 * (high - low)).max(DVec3::ZERO) * (1.0 + 1e-12) + thinnest;
        let rows = [0, 1, 2].map(|k| {
            // In scaled coordinates lengths are larger by `scale`, rows smaller; then grown.
            let row = dual[k] / (half[k] * frame.scale);
            let row = row / (1.0 + OrientedBox::GROWTH * row.length());
            let offset = row.dot(center);
            [row.x as f32, row.y as f32, row.z as f32, offset as f32]
        });
        Self { rows }
    }

    /// The rows, without their offsets.
    #[inline(always)]
    pub(crate) fn directions(&self) -> [DVec3; 3] {
        self.rows.map(|[x, y, z, _]| DVec3::new(x.into(), y.into(), z.into()))
    }

    /// Unit vectors along the leaf's two chords and its normal.
    #[inline(always)]
    pub(crate) fn unit_axes(&self) -> [DVec3; 3] {
        let [a, b, n] = self.directions();
        [b.cross(n).normalize(), n.cross(a).normalize(), n.normalize()]
    }

    /// The largest distance from a point, in scene units, of rays that are found in f32 to meet the
    /// box; NaN where the box has no size.
    pub(super) fn farthest_from(&self, point: DVec3, frame: &ScaledFrame) -> f64 {
        let [a, b, c] = self.directions();
        let volume = a.dot(b.cross(c));
        let mut half = [b.cross(c) / volume, c.cross(a) / volume, a.cross(b) / volume];
        let middle: DVec3 = (0..3).map(|k| f64::from(self.rows[k][3]) * half[k]).sum();
        let from_middle = (frame.scaled(point) - middle).length();
        // The test of each pair of planes has a tolerance for the rounding of f32, and so have the
        // ray's ends: each is no more than the box was grown by.
        for (half, row) in half.iter_mut().zip([a, b, c]) {
            *half *= 1.0 + 2.0 * OrientedBox::GROWTH * row.length();
        }
        let corner = |[s, t]: [f64; 2]| (half[2] + s * half[0] + t * half[1]).length();
        let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(corner);
        let most = from_middle + corners.into_iter().fold(0.0, f64::max);
        most * (1.0 + 1e-6) / frame.scale
    }

    /// Where the ray passes within `slack` of the box; `None` when it does not.
    ///
    /// Written so that NaN counts as a passage: the leaf test then decides.
    pub(crate) fn passage(
        &self,
        ray: &RayFrame,
        frame: &ScaledFrame,
        slack: f64,
    ) -> Option<Passage> {
        let origin = frame.scaled(ray.origin);
        let rows = self.directions();
        let mut entry = f64::NEG_INFINITY;
        let mut exit = f64::INFINITY;
        let mut start = DVec3::ZERO;
        let mut slope = DVec3::ZERO;
        for k in 0..3 {
            let at = rows[k].dot(origin) - f64::from(self.rows[k][3]);
            let along = rows[k].dot(ray.axis);
            // Rounding grows with the distance of the origin from the scene.
            let rounding = 8.0 * f64::EPSILON * (origin.abs().max_element() + 1.0);
            let reach = 1.0 + rows[k].length() * (slack * frame.scale + rounding);
            let (near, far) = if along.abs() > LEAST_ALONG {
                let (a, b) = ((-reach - at) / along, (reach - at) / along);
                (a.min(b), a.max(b))
            } else if at.abs() > reach {
                return None;
            } else {
                (f64::NEG_INFINITY, f64::INFINITY)
            };
            entry = entry.max(near);
            exit = exit.min(far);
            (start[k], slope[k]) = (at, along);
        }
        let spread = 8.0 * f64::EPSILON * (entry.abs() + exit.abs());
        if entry > exit + spread {
            return None;
        }
        let cross = -start.z / slope.z;
        let z = if cross.is_finite() { cross.clamp(entry, exit.max(entry)) } else { entry };
        let middle = DVec2::new(start.x + z * slope.x, start.y + z * slope.y);
        let middle = middle.clamp(DVec2::splat(-1.0), DVec2::splat(1.0));
        let [entry, exit] = [entry - spread, exit + spread].map(|z| z / frame.scale);
        Some(Passage { entry, exit, middle })
    }
}

impl Axes {
    /// Along the chords; directions that are degenerate are replaced by perpendicular ones.
    pub(super) fn along(chords: [DVec3; 2]) -> Self {
        let axes = independent(chords);
        let determinant = axes[0].cross(axes[1]).dot(axes[2]);
        let dual = [
            axes[1].cross(axes[2]) / determinant,
            axes[2].cross(axes[0]) / determinant,
            axes[0].cross(axes[1]) / determinant,
        ];
        Self { axes, dual }
    }
}

/// Three independent directions, the first two along the chords where they are not
/// degenerate, the third perpendicular to both.
fn independent(chords: [DVec3; 2]) -> [DVec3; 3] {
    let [mut a, mut b] = chords;
    let longest = a.length().max(b.length());
    let degenerate = longest.is_nan() || longest <= 0.0;
    if degenerate {
        return [DVec3::X, DVec3::Y, DVec3::Z];
    }
    if a.length() < SHORTEST_CHORD * longest {
        a = b.any_orthogonal_vector().normalize() * longest;
    }
    if b.length() < SHORTEST_CHORD * longest
        || a.cross(b).length() < APART * a.length() * b.length()
    {
        b = a.any_orthogonal_vector().normalize() * longest;
    }
    let n = a.cross(b);
    [a, b, n.normalize() * longest]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Aabb, Ray};

    fn unit_square() -> (OrientedBox, ScaledFrame) {
        let corners = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)];
        let net = corners.map(|(x, y)| DVec4::new(x, y, 0.0, 1.0));
        let frame = ScaledFrame::around(&Aabb::around(net.map(euclidean)));
        (OrientedBox::around(&net, &Axes::along([DVec3::X, DVec3::Y]), 1e-15, &frame), frame)
    }

    fn passage(origin: DVec3, direction: DVec3) -> Option<Passage> {
        let (unit_square, frame) = unit_square();
        let ray = RayFrame::new(&Ray::new(origin, direction).unwrap());
        unit_square.passage(&ray, &frame, 1e-15)
    }

    #[test]
    fn first_guess_is_where_the_ray_crosses_the_plane() {
        let passage = passage(DVec3::new(0.75, 0.25, 5.0), -DVec3::Z).unwrap();
        assert!((passage.middle - DVec2::new(0.5, -0.5)).length() < 4.0 * OrientedBox::GROWTH);
        let grown = 2.0 * OrientedBox::GROWTH;
        assert!((passage.entry - 5.0).abs() < grown && (passage.exit - 5.0).abs() < grown);
    }

    #[test]
    fn a_flat_box_is_met_along_its_plane_and_through_its_edges() {
        for (origin, direction) in [
            (DVec3::new(-1.0, 0.5, 0.0), DVec3::X),
            (DVec3::new(-1.0, 0.0, 0.0), DVec3::X),
            (DVec3::new(1.0, 1.0, 3.0), -DVec3::Z),
            (DVec3::new(2.0, 2.0, 0.0), DVec3::new(-1.0, -1.0, 0.0)),
        ] {
            assert!(passage(origin, direction).is_some(), "{origin}");
        }
        assert!(
            passage(DVec3::new(1.0 + 2.0 * OrientedBox::GROWTH, 0.5, 3.0), -DVec3::Z).is_none()
        );
    }

    /// Rays that f32 finds to meet a small box between planes that nearly coincide: the farthest is
    /// no farther from its middle than `farthest_from` says, and not much nearer.
    #[test]
    fn rays_that_meet_a_slanted_box_are_near() {
        let frame = ScaledFrame { center: DVec3::ZERO, scale: 1.0 };
        let mut closest = f64::INFINITY;
        for size in [1e-2, 1e-3, 1e-4, 1e-5] {
            let middle = DVec3::new(0.3, -0.2, 0.1);
            let chords = [size * DVec3::X, size * DVec3::new(1.0, 1.1e-3, 0.0)];
            let net = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]
                .map(|[s, t]| (middle + (s - 0.5) * chords[0] + (t - 0.5) * chords[1]).extend(1.0));
            let oriented = OrientedBox::around(&net, &Axes::along(chords), 1e-15, &frame);
            let reach = oriented.farthest_from(middle, &frame);
            for k in 0..20_000 {
                let x = (1e-4 * f64::from(k) - 1.0) * 3.0 * (size + 0.01);
                let (mut entry, mut exit) = (f32::MIN, f32::MAX);
                for [row_x, row_y, row_z, offset] in oriented.rows {
                    let origin = [(middle.x + x) as f32, 0.9, middle.z as f32];
                    let at = row_x * origin[0] + row_y * origin[1] + row_z * origin[2] - offset;
                    let (middle, half) = (at / row_y, (1.0 / row_y).abs());
                    if row_y.abs() > 1e-6 {
                        (entry, exit) = (entry.max(middle - half), exit.min(middle + half));
                    } else if at.abs() > 1.0 {
                        exit = f32::MIN;
                    }
                }
                if entry <= exit + OrientedBox::GROWTH as f32 {
                    assert!(x.abs() <= reach, "{x} of {reach}, size {size}");
                    closest = closest.min(reach / x.abs());
                }
            }
        }
        assert!(closest < 2.0, "{closest}");
    }

    #[test]
    fn axes_are_those_of_the_net() {
        let [a, b, n] = unit_square().0.unit_axes();
        assert!((a - DVec3::X).length() + (b - DVec3::Y).length() + (n - DVec3::Z).length() < 1e-6);
    }
}
