//! Triangular rational Bézier patches.

use std::fmt;

use glam::{DAffine3, DVec2, DVec3, DVec4, Vec4Swizzles};

use super::TriangleError;
use crate::geometry::affine::{moved, unfit_determinant};
use crate::geometry::knots::unit_knots;
use crate::geometry::magnitude::{Extent, extent, is_usable, is_usable_weight};
use crate::geometry::{MAX_DEGREE, MIN_MAGNITUDE, NurbsCurve, SurfaceDerivatives};

/// A triangular rational Bézier patch of degree `n`,
/// `S(u, v) = Σ B_ijk w_ijk P_ijk / Σ B_ijk w_ijk` with `B_ijk = n!/(i! j! k!) uⁱ vʲ wᵏ`,
/// `i + j + k = n` and `w = 1 − u − v`, on the triangle `u, v, w ≥ 0`.
///
/// Corner `u = 1` is the control point with `i = n`, and so on. The homogeneous points
/// `(w x, w y, w z, w)` are stored, i slowest, then j: `(0,0,n)`, `(0,1,n−1)`, … `(n,0,0)`.
/// The normal `Sᵤ × Sᵥ` points to the side from which the corners `u = 1`, `v = 1`, `w = 1` run
/// counterclockwise. Farin 2002, ch. 17.
///
/// # Invariants, checked once on construction
/// - `1 ≤ n ≤` [`MAX_DEGREE`], and there are `(n + 1)(n + 2)/2` control points;
/// - no coordinate is larger than [`MAX_MAGNITUDE`](crate::geometry::MAX_MAGNITUDE), and weights
///   are from [`MIN_MAGNITUDE`] to that;
/// - the control points are not all on one line (within rounding), and span at least
///   [`MIN_MAGNITUDE`] along an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct TrianglePatch {
    degree: usize,
    control: Vec<DVec4>,
}

/// A side of a triangular patch: the parameter that is zero there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriangleSide {
    /// `u = 0`: from the corner `w = 1` to `v = 1`.
    U,
    /// `v = 0`: from the corner `w = 1` to `u = 1`.
    V,
    /// `w = 0`: from the corner `v = 1` to `u = 1`.
    W,
}

impl fmt::Display for TriangleSide {
    /// The name of its parameter.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::U => "u",
            Self::V => "v",
            Self::W => "w",
        })
    }
}

/// A quarter of a triangular patch, and where it lies.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleQuarter {
    /// The quarter as a patch of its own, on its own unit triangle.
    pub patch: TrianglePatch,
    /// Where its corners `u = 1`, `v = 1`, `w = 1` lie in the whole patch's `(u, v)`.
    pub corners: [DVec2; 3],
}

/// Barycentric coordinates `[u, v, w]`.
pub(super) type Barycentric = [f64; 3];

/// The number of control points of a patch of this degree.
fn count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// The index at which the point of exponents `(i, j, n − i − j)` is stored.
fn index(degree: usize, i: usize, j: usize) -> usize {
    i * (2 * degree + 3 - i) / 2 + j
}

/// The exponents `(i, j)` in the order in which points are stored.
fn exponents(degree: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..=degree).flat_map(move |i| (0..=degree - i).map(move |j| (i, j)))
}

/// One round of de Casteljau's algorithm, in place: mixes the points of a degree in the ratio of
/// the coordinates into those of the next lower degree. Where one coordinate is zero, the order of
/// the sum does not matter: sides depend on their own control points only.
pub(super) fn mix(points: &mut Vec<DVec4>, degree: usize, [u, v, w]: Barycentric) {
    let lower = degree - 1;
    let mixed = exponents(lower).map(|(i, j)| {
        let at = |i, j| points[index(degree, i, j)];
        u * at(i + 1, j) + v * at(i, j + 1) + w * at(i, j)
    });
    *points = mixed.collect();
}

impl TrianglePatch {
    /// A patch from its control points, in the order above, and their weights; without
    /// weights it is polynomial.
    ///
    /// # Errors
    /// When one of the invariants above does not hold.
    pub fn new(
        degree: usize,
        points: Vec<DVec3>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, TriangleError> {
        let weights = weights.unwrap_or_else(|| vec![1.0; points.len()]);
        if weights.len() != points.len() {
            let (weights, points) = (weights.len(), points.len());
            return Err(TriangleError::WeightCount { weights, points });
        }
        let control = points.iter().zip(&weights).map(|(&point, &w)| (w * point).extend(w));
        Self::from_homogeneous(degree, control.collect())
    }

    /// A patch from its homogeneous control points `(w x, w y, w z, w)`, in the order above.
    ///
    /// # Errors
    /// When one of the invariants above does not hold.
    pub fn from_homogeneous(degree: usize, control: Vec<DVec4>) -> Result<Self, TriangleError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(TriangleError::Degree { degree });
        }
        let (points, needed) = (control.len(), count(degree));
        if points != needed {
            return Err(TriangleError::PointCount { points, degree, needed });
        }
        for ((i, j), point) in exponents(degree).zip(&control) {
            let exponents = [i, j, degree - i - j];
            let weight = point.w;
            if !is_usable_weight(weight) {
                return Err(TriangleError::Weight { exponents, weight });
            }
            let euclidean = point.xyz() / weight;
            if !is_usable(euclidean) {
                return Err(TriangleError::Point { exponents, point: euclidean });
            }
        }
        let patch = Self { degree, control };
        patch.check_extent()?;
        Ok(patch)
    }

    /// Checks the extent as for tensor-product surfaces: points that differ by rounding only are
    /// one.
    fn check_extent(&self) -> Result<(), TriangleError> {
        let points = || self.control.iter().map(|point| point.xyz() / point.w);
        match extent(points, [self.degree; 2]) {
            Extent::Wide { size } if size >= MIN_MAGNITUDE => Ok(()),
            Extent::Wide { size } => Err(TriangleError::TooSmall { size }),
            Extent::Line { from, to } => Err(TriangleError::NoArea { from, to }),
            Extent::Point(point) => Err(TriangleError::NoExtent { point }),
        }
    }

    /// The degree `n`.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The homogeneous control points `(w x, w y, w z, w)`, i slowest, then j.
    pub fn control(&self) -> &[DVec4] {
        &self.control
    }

    /// The homogeneous control point of exponents `(i, j, n − i − j)`; `None` if there is none.
    pub fn homogeneous(&self, i: usize, j: usize) -> Option<DVec4> {
        let there = i <= self.degree && j <= self.degree - i;
        there.then(|| self.control[index(self.degree, i, j)])
    }

    /// The control point of exponents `(i, j, n − i − j)` in space; `None` if there is none.
    pub fn point(&self, i: usize, j: usize) -> Option<DVec3> {
        self.homogeneous(i, j).map(|point| point.xyz() / point.w)
    }

    /// Whether the weights differ; with equal weights the patch is polynomial.
    pub fn is_rational(&self) -> bool {
        self.control.iter().any(|point| point.w != self.control[0].w)
    }

    /// The point `S(u, v)` by de Casteljau's algorithm: `n` rounds of mixing neighbours in
    /// the ratio `u : v : w`.
    ///
    /// Off the triangle the rational functions continue and may have poles; NaN gives NaN.
    pub fn point_at(&self, uv: DVec2) -> DVec3 {
        let mut points = self.control.clone();
        let at = [uv.x, uv.y, 1.0 - uv.x - uv.y];
        for degree in (1..=self.degree).rev() {
            mix(&mut points, degree, at);
        }
        points[0].xyz() / points[0].w
    }

    /// The point `S(u, v)` with its first and second derivatives by `u` and `v`, `w` being
    /// `1 − u − v`.
    ///
    /// After `n − 2` rounds of de Casteljau's algorithm six points `Q` are left. With `A` the
    /// homogeneous point, `A_uu = n(n − 1)(Q₂₀₀ − 2 Q₁₀₁ + Q₀₀₂)` and the like are second
    /// differences of these points; first derivatives are `n` times differences one round later.
    /// The quotients follow as for tensor-product surfaces. As there, all coordinates are taken
    /// relative to the point itself, so that small derivatives keep their digits.
    pub fn derivatives(&self, uv: DVec2) -> SurfaceDerivatives {
        let origin = self.point_at(uv);
        let around = |point: &DVec4| {
            let shifted = |wx: f64, x: f64| (-point.w).mul_add(x, wx);
            let (x, y) = (shifted(point.x, origin.x), shifted(point.y, origin.y));
            DVec4::new(x, y, shifted(point.z, origin.z), point.w)
        };
        let mut points: Vec<DVec4> = self.control.iter().map(around).collect();
        let at = [uv.x, uv.y, 1.0 - uv.x - uv.y];
        for degree in (3..=self.degree).rev() {
            mix(&mut points, degree, at);
        }
        let n = self.degree as f64;
        let mut second = [DVec4::ZERO; 3];
        if self.degree >= 2 {
            // Stored as 002, 011, 020, 101, 110, 200.
            let [q002, q011, q020] = [points[0], points[1], points[2]];
            let [q101, q110, q200] = [points[3], points[4], points[5]];
            let uu = (q200 - q101) - (q101 - q002);
            let uv = (q110 - q101) - (q011 - q002);
            let vv = (q020 - q011) - (q011 - q002);
            second = [uu, uv, vv].map(|difference| n * (n - 1.0) * difference);
            mix(&mut points, 2, at);
        }
        let [q001, q010, q100] = [points[0], points[1], points[2]];
        let (au, av) = (n * (q100 - q001), n * (q010 - q001));
        mix(&mut points, 1, at);
        let [auu, auv, avv] = second;
        let mut sums = [points[0], au, av, auu, auv, avv];
        if !self.is_rational() {
            // Equal weights: w is constant, and its derivatives are rounding errors.
            for sum in &mut sums[1..] {
                sum.w = 0.0;
            }
        }
        let relative = SurfaceDerivatives::of_quotient(sums);
        SurfaceDerivatives { point: origin + relative.point, ..relative }
    }

    /// The unit normal `Sᵤ × Sᵥ / |Sᵤ × Sᵥ|`; where the product vanishes on a side or at a corner,
    /// the normal's limit along the way from the middle of the triangle, as far as second
    /// derivatives determine it. `None` where there is none.
    pub fn normal(&self, uv: DVec2) -> Option<DVec3> {
        let on_a_side = uv.x <= 0.0 || uv.y <= 0.0 || uv.x + uv.y >= 1.0;
        let inward = if on_a_side { DVec2::splat(1.0 / 3.0) - uv } else { DVec2::ZERO };
        self.derivatives(uv).unit_normal(inward)
    }

    /// A side as a curve on `[0, 1]`.
    pub fn side(&self, side: TriangleSide) -> NurbsCurve {
        let n = self.degree;
        let at = |t: usize| match side {
            TriangleSide::U => index(n, 0, t),
            TriangleSide::V => index(n, t, 0),
            TriangleSide::W => index(n, t, n - t),
        };
        NurbsCurve::assembled(unit_knots(n), (0..=n).map(|t| self.control[at(t)]).collect())
    }

    /// The exact curve, on `[0, 1]`, on which the parameter named by `side` has the value `at`. It
    /// runs beside that side, in the same direction. `None` if `at` is not from 0 to 1; at 1 the
    /// curve is the corner.
    ///
    /// Its control points are blossoms: for point `k`, `k` arguments are the second end of the
    /// line in the parameters, and the others the first end.
    pub fn curve_at(&self, side: TriangleSide, at: f64) -> Option<NurbsCurve> {
        let within = (0.0..=1.0).contains(&at); // false for NaN
        let rest = 1.0 - at;
        let [start, end] = match side {
            TriangleSide::U => [[at, 0.0, rest], [at, rest, 0.0]],
            TriangleSide::V => [[0.0, at, rest], [rest, at, 0.0]],
            TriangleSide::W => [[0.0, rest, at], [rest, 0.0, at]],
        };
        let n = self.degree;
        let point = |k: usize| {
            let places: Vec<Barycentric> =
                (0..n).map(|index| if index < k { end } else { start }).collect();
            self.blossom(&places)
        };
        within.then(|| NurbsCurve::assembled(unit_knots(n), (0..=n).map(point).collect()))
    }

    /// The polar form (blossom) of the homogeneous patch at as many points as its degree: the
    /// symmetric function that is affine in each and gives the patch where all are the same.
    fn blossom(&self, at: &[Barycentric]) -> DVec4 {
        let mut points = self.control.clone();
        for (round, &at) in at.iter().enumerate() {
            mix(&mut points, self.degree - round, at);
        }
        points[0]
    }

    /// The four quarters between the corners and the middles of the sides: those at `u = 1`,
    /// `v = 1`, `w = 1`, then the middle one. All keep the patch's orientation.
    ///
    /// A control point of a quarter is the blossom at the quarter's corners, each as often as its
    /// exponent says. Corners of the patch are taken before middles of its sides, so that quarters,
    /// and those of a neighbour with the same side, share common sides' control points bit for bit.
    pub fn quarters(&self) -> [TriangleQuarter; 4] {
        let [u, v, w] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let [uv, uw, vw] = [[0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
        [[u, uv, uw], [uv, v, vw], [uw, vw, w], [vw, uw, uv]].map(|corners| {
            let control = exponents(self.degree).map(|(i, j)| {
                let times = [i, j, self.degree - i - j];
                let repeated = corners.iter().zip(times);
                let mut at: Vec<Barycentric> = repeated
                    .flat_map(|(&corner, times)| std::iter::repeat_n(corner, times))
                    .collect();
                // Corners (which hold a 1) first; then middles in one order for all quarters.
                at.sort_by(|a, b| {
                    let corners_first = b.contains(&1.0).cmp(&a.contains(&1.0));
                    corners_first.then(b[0].total_cmp(&a[0])).then(b[1].total_cmp(&a[1]))
                });
                self.blossom(&at)
            });
            TriangleQuarter {
                patch: Self { degree: self.degree, control: control.collect() },
                corners: corners.map(|[u, v, _]| DVec2::new(u, v)),
            }
        })
    }

    /// The patch with `u` and `v` exchanged, which reverses its normals.
    #[must_use]
    pub fn swapped(&self) -> Self {
        let n = self.degree;
        let control = exponents(n).map(|(i, j)| self.control[index(n, j, i)]).collect();
        Self { degree: n, control }
    }

    /// The patch moved by an affine map. If the map mirrors, normals that pointed out of a body
    /// point into it; [`TrianglePatch::swapped`] reverses them again.
    ///
    /// # Errors
    /// When the map is not finite, flattens space, or takes a control point to infinity.
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, TriangleError> {
        if !map.is_finite() {
            return Err(TriangleError::TransformNotFinite);
        }
        if let Some(determinant) = unfit_determinant(map) {
            return Err(TriangleError::Transform { determinant });
        }
        let control = self.control.iter().map(|point| moved(map, point)).collect();
        Self::from_homogeneous(self.degree, control)
    }
}
