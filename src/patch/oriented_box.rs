//! Boxes that follow a leaf's tangents.

use glam::{DVec2, DVec3, DVec4};

use super::tensor::euclidean;
use crate::math::RayFrame;

/// A parallelepiped around a leaf: the points `P` with `|rowₖ · (P − center)| ≤ 1`.
///
/// The first two coordinates follow the leaf's parameters, the third its normal, so the
/// place where a ray crosses the third coordinate's zero is a good first guess of `(s, t)`.
#[derive(Clone, Copy, Debug)]
pub struct OrientedBox {
    center: DVec3,
    rows: [DVec3; 3],
    lengths: DVec3,
}

/// What a ray does to an oriented box.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// Where along the ray it enters, in scene units from the origin.
    pub entry: f64,
    /// Where it leaves.
    pub exit: f64,
    /// The first two box coordinates where the ray crosses the middle plane, cut to `±1`.
    pub middle: DVec2,
}

impl OrientedBox {
    /// A box around control points, along a leaf's chords and normal.
    ///
    /// `noise` is how far the points may be from the true ones; no side is thinner.
    /// Directions that are degenerate are replaced by perpendicular ones.
    pub(super) fn around(net: &[DVec4], chords: [DVec3; 2], noise: f64) -> Self {
        let axes = frame(chords);
        let determinant = axes[0].cross(axes[1]).dot(axes[2]);
        let dual = [
            axes[1].cross(axes[2]) / determinant,
            axes[2].cross(axes[0]) / determinant,
            axes[0].cross(axes[1]) / determinant,
        ];
        let origin = euclidean(net[net.len() / 2]);

        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for &c in net {
            let from_origin = euclidean(c) - origin;
            let local = DVec3::from_array(dual.map(|row| row.dot(from_origin)));
            low = low.min(local);
            high = high.max(local);
        }

        let middle = 0.5 * (low + high);
        let center = origin + middle.x * axes[0] + middle.y * axes[1] + middle.z * axes[2];
        let lengths = DVec3::from_array(dual.map(DVec3::length));
        let thinnest = 4.0 * noise * lengths + f64::MIN_POSITIVE;
        let half = (0.5 * (high - low)).max(DVec3::ZERO) * (1.0 + 1e-12) + thinnest;
        let rows = [dual[0] / half.x, dual[1] / half.y, dual[2] / half.z];
        Self { center, rows, lengths: lengths / half }
    }

    /// Where the ray passes within `slack` of the box; `None` when it does not.
    ///
    /// Written so that an undefined number counts as a passage: the leaf test then decides.
    pub fn passage(&self, ray: &RayFrame, slack: f64) -> Option<Passage> {
        let offset = ray.origin - self.center;
        let mut entry = f64::NEG_INFINITY;
        let mut exit = f64::INFINITY;
        let mut start = DVec3::ZERO;
        let mut slope = DVec3::ZERO;
        for k in 0..3 {
            let (at, along) = (self.rows[k].dot(offset), self.rows[k].dot(ray.axis));
            // Rounding of `at` grows with the distance of the origin from the box.
            let reach = 1.0 + self.lengths[k] * slack + 8.0 * f64::EPSILON * at.abs();
            let (near, far) = if along.abs() > 1e-300 {
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
        Some(Passage { entry: entry - spread, exit: exit + spread, middle })
    }

    /// The half sides as vectors' dual rows, for tests and packers of wide boxes.
    pub fn rows(&self) -> (DVec3, [DVec3; 3]) {
        (self.center, self.rows)
    }
}

/// Three independent directions, the first two along the chords where they are not
/// degenerate, the third perpendicular to both.
fn frame(chords: [DVec3; 2]) -> [DVec3; 3] {
    let [mut a, mut b] = chords;
    let longest = a.length().max(b.length());
    let degenerate = longest.is_nan() || longest <= 0.0;
    if degenerate {
        return [DVec3::X, DVec3::Y, DVec3::Z];
    }
    // A chord much shorter than the other, or along it, gives no usable direction.
    let usable = 1e-3;
    if a.length() < usable * longest {
        a = b.any_orthogonal_vector().normalize() * longest;
    }
    if b.length() < usable * longest || a.cross(b).length() < usable * a.length() * b.length() {
        b = a.any_orthogonal_vector().normalize() * longest;
    }
    let n = a.cross(b);
    [a, b, n.normalize() * longest]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Ray;

    fn unit_square() -> OrientedBox {
        let corners = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)];
        let net = corners.map(|(x, y)| DVec4::new(x, y, 0.0, 1.0));
        OrientedBox::around(&net, [DVec3::X, DVec3::Y], 1e-15)
    }

    fn frame_of(origin: DVec3, direction: DVec3) -> RayFrame {
        RayFrame::new(&Ray::new(origin, direction).unwrap())
    }

    #[test]
    fn first_guess_is_where_the_ray_crosses_the_plane() {
        let ray = frame_of(DVec3::new(0.75, 0.25, 5.0), -DVec3::Z);
        let passage = unit_square().passage(&ray, 0.0).unwrap();
        assert!((passage.middle - DVec2::new(0.5, -0.5)).length() < 1e-12);
        assert!((passage.entry - 5.0).abs() < 1e-12 && (passage.exit - 5.0).abs() < 1e-12);
    }

    #[test]
    fn a_flat_box_is_met_along_its_plane_and_through_its_edges() {
        let flat = unit_square();
        for (origin, direction) in [
            (DVec3::new(-1.0, 0.5, 0.0), DVec3::X),
            (DVec3::new(-1.0, 0.0, 0.0), DVec3::X),
            (DVec3::new(1.0, 1.0, 3.0), -DVec3::Z),
            (DVec3::new(2.0, 2.0, 0.0), DVec3::new(-1.0, -1.0, 0.0)),
        ] {
            assert!(flat.passage(&frame_of(origin, direction), 1e-15).is_some(), "{origin}");
        }
        let beside = frame_of(DVec3::new(1.0 + 1e-9, 0.5, 3.0), -DVec3::Z);
        assert!(flat.passage(&beside, 1e-15).is_none());
    }
}
