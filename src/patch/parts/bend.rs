//! How much a part of a piece bends, in its own plane and out of it.

use glam::{DVec3, DVec4};

use crate::geometry::RectSide;
use crate::math::Aabb;
use crate::patch::pieces::grid::points_at;
use crate::patch::pieces::tensor::euclidean_net;
use crate::patch::{DyadicRect, Piece};

/// A piece is not halved more often than this in one direction: 2⁻¹⁶ of a side is small
/// for any surface worth drawing, and a cusp would never become flat.
pub(super) const MOST_HALVINGS: u32 = 16;

/// Leaves are at least this flat.
const COARSEST: f64 = 0.5;

/// Rational leaves longer than this many times their width, and bent along their length, must be
/// flatter than [`COARSEST`] by the factor by which they are longer, up to a length of [`LONGEST`]
/// widths: what is known of them relative to their length must be good for their width. Measured on
/// the wires of a sphere's net: rays are traced 1.1 to 1.3 times as fast.
const LONG: f64 = 8.0;
const LONGEST: f64 = 32.0;

/// The bend that a part ending in a pole is treated as having towards the pole, for the first
/// [`POLE_HALVINGS`] halvings: the nearer a ray passes to the pole, the less the certificate says
/// about it.
///
/// Measured: discs and cones are traced 1.1 to 1.2 times as fast, other bodies with poles no
/// slower.
const AT_POLES: f64 = 0.15;
const POLE_HALVINGS: u32 = 5;

/// Turns relative to a part's own sides and width count at most this many times the turns relative
/// to its longest row: where the sides are nearly parallel, as beside a cusp line, the former do
/// not shrink however often the part is halved.
const MOST_TIMES: f64 = 4.0;

/// Lengths below this many times the error bound of points are not measured for bending: what would
/// be measured there is rounding error, which does not shrink however often a part is halved.
const LEAST_SEEN: f64 = 1e4;

/// A part of degree above three whose rows deviate from cubics by this fraction of its side counts
/// as bent by [`COARSEST`], because leaves are approximated by bicubics. Halving leaves a sixteenth
/// of the deviation, or an eighth relative to the side; the fourth root of that counts, which
/// shrinks about as a bend does.
///
/// Measured: sheets of degrees 4 and 5 with random weights are traced 1.2 to 2 times as fast, with
/// up to twice as many leaves; an octant sphere of degree 4 × 4 1.0 to 1.1 times, with no more. A
/// third of this value gained little more.
const OFF_CUBIC: f64 = 3e-4;

/// How much a part bends.
///
/// How often a ray meets a part does not change when both are stretched. So turns within the part's
/// plane are measured in units of its own sides, and turns out of the plane in units of its width,
/// which is less than a side where the two sides are slanted. A slender part whose short rows are
/// sheared along it is then as good as the wide part that stretching would make of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend {
    /// What halving in `s` and in `t` is worth: half the angle by which rows turn, or its
    /// equivalent.
    angles: [f64; 2],
    /// The same, counting only what must be at most [`COARSEST`] in a leaf.
    strained: [f64; 2],
    /// The lengths of the part's sides, but at least the shortest that can be measured.
    sides: [f64; 2],
}

/// The rows of control points along one direction: the steps in a row, the index distance of its
/// points in the net, the number of rows less one, and the index distance of rows.
#[derive(Clone, Copy, Debug)]
struct Rows {
    degree: usize,
    step: usize,
    others: usize,
    to_other: usize,
}

/// How far rows turn.
struct Turns {
    /// Relative to the longest row.
    by_side: f64,
    /// Relative to the part's own sides and width.
    by_part: f64,
}

/// The vectors whose products with second differences measure them along both sides and out of the
/// plane.
struct Measures {
    along: [DVec3; 2],
    out: DVec3,
    /// The length of each side perpendicular to the other direction.
    widths: [f64; 2],
}

impl Bend {
    /// Measures the control points over a rectangle of a piece; `None` where only rounding error is
    /// left to measure.
    ///
    /// The measure of a direction is the largest second difference of the control points along it,
    /// times the second derivative's factor, over the part's size: half the angle by which the rows
    /// turn. Twist counts where it leaves the part's plane.
    pub(super) fn of(piece: &Piece, rect: DyadicRect, net: &[DVec4]) -> Option<Self> {
        let [p, q] = piece.patch.degree();
        let noise = piece.patch.noise();
        let least_seen = LEAST_SEEN * noise;
        let points = euclidean_net(net);
        if Aabb::around(points.iter().copied()).size().max_element() < least_seen {
            return None;
        }
        let rows = [
            Rows { degree: p, step: q + 1, others: q, to_other: 1 },
            Rows { degree: q, step: 1, others: p, to_other: q + 1 },
        ];
        let sides = rows.map(|rows| rows.longest_chord(&points).max(least_seen));
        let corner = |i: usize, j: usize| points[i * p * (q + 1) + j * q];
        let (one, other) = (corner(1, 1) - corner(0, 0), corner(1, 0) - corner(0, 1));
        let measures = Measures::new([one + other, one - other], sides);
        let turns = [0, 1].map(|k| rows[k].turns(&points, k, &measures, sides[k]));

        let rational = piece.patch.is_rational();
        // Only where the part bends as a whole, too: a crescent has long rows that turn far
        // relative to its width, but is none the worse for it.
        let lengths = if rational { sides[0] / sides[1] } else { 1.0 };
        let strain = [lengths, lengths.recip()].map(|times| (times.min(LONGEST) / LONG).max(1.0));
        let twist = corner(1, 1) - corner(1, 0) - corner(0, 1) + corner(0, 0);
        let twist = twist.dot(measures.out).abs() / sides[0].max(sides[1]);
        let off_cubics = (p.max(q) > 3).then(|| off_cubics([p, q], net));
        let mut bend = Self { angles: [0.0; 2], strained: [0.0; 2], sides };
        for k in (0..2).filter(|&k| rect.halvings(k) < MOST_HALVINGS) {
            let Turns { by_side, by_part } = turns[k];
            let reached =
                |side: &RectSide| side.fixed() as usize == k && side.is_reached_by(&rect.ranges());
            let poles = piece.collapsed_sides().filter(|(side, _)| reached(side)).count();
            // Two collapsed sides at the two ends of a direction need a leaf each.
            let least = if poles == 2 { f64::INFINITY } else { twist };
            let worth = if poles > 0 && rect.halvings(k) < POLE_HALVINGS { AT_POLES } else { 0.0 };
            // Except the rounding error of points, which does not shrink.
            let seen = |off: [f64; 2]| (off[k] - 2.0 * noise).max(0.0);
            let off_cubic = off_cubics.map_or(0.0, |off| seen(off) / (OFF_CUBIC * sides[k]));
            let off_cubic = COARSEST * off_cubic.sqrt().sqrt();
            bend.angles[k] = by_part.min(MOST_TIMES * by_side).max(least).max(worth).max(off_cubic);
            bend.strained[k] = by_part.min(by_side * strain[k]).max(least);
        }
        Some(bend)
    }

    /// The direction to halve in, where the part bends too much for a leaf.
    pub(super) fn too_much(&self) -> Option<usize> {
        let too_much = self.strained.iter().any(|&bend| bend > COARSEST);
        too_much.then(|| larger(self.strained, self.sides))
    }

    /// The direction in which halving is worth most, and the angle it is worth.
    pub(super) fn most(&self) -> (usize, f64) {
        let direction = larger(self.angles, self.sides);
        (direction, self.angles[direction])
    }

    /// The geometric mean of the sides.
    pub(super) fn size(&self) -> f64 {
        (self.sides[0] * self.sides[1]).sqrt()
    }
}

impl Rows {
    fn longest_chord(&self, points: &[DVec3]) -> f64 {
        let chord = |k: usize| {
            let row = &points[k * self.to_other..];
            row[0].distance_squared(row[self.degree * self.step])
        };
        (0..=self.others).map(chord).fold(0.0, f64::max).sqrt()
    }

    fn turns(&self, points: &[DVec3], direction: usize, measures: &Measures, side: f64) -> Turns {
        let [a, b] = measures.along;
        let out = measures.out / measures.widths[direction];
        let (mut by_side, mut by_part) = (0f64, DVec3::ZERO);
        for k in 0..=self.others {
            let row = |i: usize| points[k * self.to_other + i * self.step];
            for i in 1..self.degree {
                let turn = row(i - 1) - 2.0 * row(i) + row(i + 1);
                by_side = by_side.max(turn.length_squared());
                let parts = DVec3::new(turn.dot(a), turn.dot(b), turn.dot(out));
                by_part = by_part.max(parts.abs());
            }
        }
        let factor = (self.degree * self.degree.saturating_sub(1)) as f64 / 2.0;
        let by_side = by_side.sqrt() * factor / side;
        // Not finite where the chords do not span a plane.
        let spans = measures.along.iter().all(|along| along.is_finite());
        let by_part = if spans { by_part.length() * factor } else { by_side };
        Turns { by_side, by_part }
    }
}

impl Measures {
    /// The measures of a part with these sides. Only the directions of its chords count: they may
    /// be twice as long as the part, or zero.
    fn new(chords: [DVec3; 2], sides: [f64; 2]) -> Self {
        let [a, b] = chords.map(DVec3::normalize_or_zero);
        let normal = a.cross(b);
        let sine = normal.length();
        let out = normal.normalize_or_zero();
        let along = [b.cross(out) / (sine * sides[0]), out.cross(a) / (sine * sides[1])];
        Self { along, out, widths: sides.map(|side| side * sine) }
    }
}

/// Estimates how far rows in `s` and in `t` deviate from cubics, from fourth differences of 5 × 5
/// points.
///
/// A cubic polynomial through Chebyshev points of a row of length one deviates by the fourth
/// derivative over 4! 2⁷, and that derivative is 4⁴ times such a difference.
fn off_cubics(degree: [usize; 2], net: &[DVec4]) -> [f64; 2] {
    let points = points_at([0.0, 0.25, 0.5, 0.75, 1.0], degree, net);
    let off = |[a, b, c, d, e]: [DVec3; 5]| (a + e - 4.0 * (b + d) + 6.0 * c).length() / 12.0;
    let most = |rows: [[DVec3; 5]; 5]| rows.map(off).into_iter().fold(0.0, f64::max);
    let across = [0, 1, 2, 3, 4].map(|k| points.map(|row| row[k]));
    [most(across), most(points)]
}

/// The direction with more bend; if both are equal, for example because both are the twist, that of
/// the longer side.
fn larger(angles: [f64; 2], sides: [f64; 2]) -> usize {
    let order = angles[1].total_cmp(&angles[0]).then(sides[1].total_cmp(&sides[0]));
    usize::from(order.is_gt())
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DQuat, DVec3};

    use crate::geometry::{KnotVector, NurbsSurface, shapes};
    use crate::patch::{Leaf, PatchSet, ScaledFrame};

    /// Directions all around, none of them special.
    fn directions() -> impl Iterator<Item = DVec3> {
        const COUNT: usize = 64;
        const GOLDEN_ANGLE: f64 = 2.399963;
        (0..COUNT).map(|k| {
            let z = (2 * k + 1) as f64 / COUNT as f64 - 1.0;
            let (sine, cosine) = (GOLDEN_ANGLE * k as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * cosine, r * sine, z)
        })
    }

    /// The number of leaves, and the certified shares of the rays along their normals and of rays
    /// from everywhere that are stretched with the surface.
    fn certified(surface: &NurbsSurface, map: &DAffine3) -> (usize, [f64; 2]) {
        let surface = surface.transformed(map).unwrap();
        let (set, parts) = PatchSet::new(&[surface]).unwrap();
        let frame = ScaledFrame::around(&set.bounds());
        let (mut steep, mut any) = (0, 0);
        for part in parts.all() {
            let (leaf, _, oriented) = Leaf::new(part, &set.pieces()[part.piece as usize], &frame);
            let rows = oriented.directions();
            let holds = |d: DVec3| leaf.certificate.holds(rows.map(|row| row.dot(d)));
            steep += usize::from(holds(oriented.unit_axes()[2]));
            let pulled = directions().map(|d| map.transform_vector3(d).normalize());
            any += pulled.filter(|&d| holds(d)).count();
        }
        let count = parts.all().len();
        let part = |holding: usize, of: usize| holding as f64 / of as f64;
        (count, [part(steep, count), part(any, count * directions().count())])
    }

    /// The tangents of a twisted cubic: beside that curve, in the middle, both sides of a part run
    /// along it.
    #[test]
    fn parts_with_parallel_sides_do_not_take_all_the_room() {
        let curve = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0], [3.0, 3.0, 3.0]];
        let tangent =
            [[1.0, 0.0, 0.0], [1.0, 2.0 / 3.0, 0.0], [1.0, 4.0 / 3.0, 1.0], [1.0, 2.0, 3.0]];
        let net = curve.into_iter().zip(tangent).flat_map(|(point, tangent)| {
            let (point, tangent) = (DVec3::from_array(point) / 3.0, DVec3::from_array(tangent));
            [point - tangent, point + tangent]
        });
        let knots = |degree| KnotVector::bezier(degree).unwrap();
        let surface = NurbsSurface::new(knots(3), knots(1), net.collect(), None).unwrap();
        let (_, parts) = PatchSet::new(&[surface]).unwrap();
        let count = parts.all().len();
        assert!((8..100).contains(&count), "{count} leaves");
    }

    /// A span of 1e-9 of a rational surface at 1e5 from the origin: what is measured across it is
    /// rounding error.
    #[test]
    fn slivers_far_from_the_origin_do_not_take_all_the_room() {
        let span = [0.4, 0.4 + 1e-9];
        let ends = |end: f64| std::iter::repeat_n(end, 5);
        let knots_v = KnotVector::new(4, ends(0.0).chain(span).chain(ends(1.0)).collect());
        let (knots_u, knots_v) = (KnotVector::bezier(4).unwrap(), knots_v.unwrap());
        // Numbers from 0 to 1 without order.
        let number = |k: usize| (k as f64 * 0.618_033_988_75).fract();
        let origin = DVec3::new(1e5, -7e4, 3e4);
        let net = (0..35).map(|k| {
            let hill = DVec3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2));
            origin + DVec3::new((k / 7) as f64, (k % 7) as f64, 0.0) + hill
        });
        let weights = (0..35).map(|k| 0.3 + 2.7 * number(5 * k)).collect();
        let surface = NurbsSurface::new(knots_u, knots_v, net.collect(), Some(weights)).unwrap();
        let (_, parts) = PatchSet::new(&[surface]).unwrap();
        let count = parts.all().len();
        assert!((100..4000).contains(&count), "{count} leaves");
    }

    #[test]
    fn stretched_bodies_are_certified_as_others_are() {
        for (name, body) in [
            ("sphere", shapes::sphere(1.0).unwrap()),
            ("biquadratic sphere", shapes::sphere_biquadratic(1.0).unwrap()),
            ("torus", shapes::torus(1.0, 0.4).unwrap()),
        ] {
            for axis in [DVec3::X, DVec3::Z, DVec3::ONE.normalize()] {
                let along_x = DQuat::from_rotation_arc(axis, DVec3::X);
                for by in [1.0, 10.0, 100.0, 1000.0] {
                    let pull = DAffine3::from_scale(DVec3::new(by, 1.0, 1.0));
                    let turn = DAffine3::from_quat(along_x);
                    let (count, [steep, any]) = certified(&body, &(turn.inverse() * pull * turn));
                    let what = format!("{name}, {by} times along {axis:.1}: {count} leaves");
                    assert!(count < 4000, "{what}");
                    assert!(steep > 0.85, "{what}, steep rays: {steep:.3}");
                    assert!(any > 0.8, "{what}, rays from everywhere: {any:.3}");
                }
            }
        }
    }
}
