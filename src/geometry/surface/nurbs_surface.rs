//! Tensor-product NURBS surfaces.

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::SurfaceError;
use crate::geometry::magnitude::{Extent, extent, is_usable, is_usable_weight};
use crate::geometry::{Direction, KnotVector, MAX_MAGNITUDE, MIN_MAGNITUDE};

/// A tensor-product NURBS surface `S(u, v) = Σ Nᵢ(u) Nⱼ(v) wᵢⱼ Pᵢⱼ / Σ Nᵢ(u) Nⱼ(v) wᵢⱼ`.
///
/// The homogeneous net `(w x, w y, w z, w)` is stored, v fastest: point `(i, j)` is at index
/// `i nv + j`. The true surface is the stored one: that of the products as they were rounded.
///
/// # Invariants, checked once on construction and relied on everywhere else
/// - the net has `nu × nv` points, the numbers the knot vectors ask for;
/// - no coordinate is larger than [`MAX_MAGNITUDE`], and weights are from [`MIN_MAGNITUDE`]
///   to [`MAX_MAGNITUDE`];
/// - the control points are not all on one line (within rounding), and span at least
///   [`MIN_MAGNITUDE`] along an axis;
/// - the domains of u and v are from [`MIN_MAGNITUDE`] to [`MAX_MAGNITUDE`] long.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsSurface {
    knots: [KnotVector; 2],
    control: Vec<DVec4>,
    rational: bool,
}

impl NurbsSurface {
    /// A surface from its knots, its control points (v fastest), and their weights;
    /// without weights it is polynomial.
    ///
    /// # Errors
    /// When one of the invariants above does not hold.
    pub fn new(
        knots_u: KnotVector,
        knots_v: KnotVector,
        points: Vec<DVec3>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, SurfaceError> {
        check_count(&knots_u, &knots_v, points.len())?;
        let nv = knots_v.point_count();
        if let Some(k) = points.iter().position(|point| !is_usable(*point)) {
            return Err(SurfaceError::Point { i: k / nv, j: k % nv, point: points[k] });
        }
        let weights = weights.unwrap_or_else(|| vec![1.0; points.len()]);
        if weights.len() != points.len() {
            let (weights, points) = (weights.len(), points.len());
            return Err(SurfaceError::WeightCount { weights, points });
        }
        let control = points.iter().zip(&weights).map(|(&point, &w)| (w * point).extend(w));
        Self::from_homogeneous(knots_u, knots_v, control.collect())
    }

    /// A surface from its knots and its homogeneous control points `(w x, w y, w z, w)`,
    /// v fastest.
    ///
    /// # Errors
    /// When one of the invariants above does not hold.
    pub fn from_homogeneous(
        knots_u: KnotVector,
        knots_v: KnotVector,
        control: Vec<DVec4>,
    ) -> Result<Self, SurfaceError> {
        check_count(&knots_u, &knots_v, control.len())?;
        check_domain(Direction::U, &knots_u)?;
        check_domain(Direction::V, &knots_v)?;
        let nv = knots_v.point_count();
        for (k, point) in control.iter().enumerate() {
            let (i, j, weight) = (k / nv, k % nv, point.w);
            if !is_usable_weight(weight) {
                return Err(SurfaceError::Weight { i, j, weight });
            }
            if !is_usable(point.xyz() / weight) {
                return Err(SurfaceError::Point { i, j, point: point.xyz() / weight });
            }
        }
        let surface = Self::assembled([knots_u, knots_v], control);
        surface.extent().checked()?;
        Ok(surface)
    }

    /// A surface from parts that are valid, because an operation on a valid surface made them.
    pub(crate) fn assembled(knots: [KnotVector; 2], control: Vec<DVec4>) -> Self {
        debug_assert_eq!(control.len(), knots[0].point_count() * knots[1].point_count());
        let rational = control.iter().any(|point| point.w != control[0].w);
        Self { knots, control, rational }
    }

    /// Returns the size of the control net along the longest axis; refuses a surface whose control
    /// points all coincide or lie on one line, to within rounding.
    pub(crate) fn check_extent(&self) -> Result<f64, SurfaceError> {
        self.extent().wide()
    }

    fn extent(&self) -> Extent {
        extent(|| self.points(), self.degree())
    }

    /// The knots in u.
    pub fn knots_u(&self) -> &KnotVector {
        &self.knots[0]
    }

    /// The knots in v.
    pub fn knots_v(&self) -> &KnotVector {
        &self.knots[1]
    }

    /// The knots in one direction.
    pub fn knots(&self, direction: Direction) -> &KnotVector {
        &self.knots[direction]
    }

    /// The degrees in u and in v.
    pub fn degree(&self) -> [usize; 2] {
        [self.knots[0].degree(), self.knots[1].degree()]
    }

    /// The numbers of control points along u and along v.
    pub fn size(&self) -> [usize; 2] {
        [self.knots[0].point_count(), self.knots[1].point_count()]
    }

    /// The homogeneous control net `(w x, w y, w z, w)`, v fastest.
    pub fn control(&self) -> &[DVec4] {
        &self.control
    }

    /// Control point `(i, j)` in space; `None` if there is none.
    pub fn point(&self, i: usize, j: usize) -> Option<DVec3> {
        self.has(i, j).then(|| self.vertex(i, j))
    }

    /// The weight of control point `(i, j)`; `None` if there is none.
    pub fn weight(&self, i: usize, j: usize) -> Option<f64> {
        self.has(i, j).then(|| self.homogeneous(i, j).w)
    }

    /// The control points in space, v fastest.
    pub fn points(&self) -> impl ExactSizeIterator<Item = DVec3> {
        self.control.iter().map(|point| point.xyz() / point.w)
    }

    /// The weights of the control points, v fastest.
    pub fn weights(&self) -> impl ExactSizeIterator<Item = f64> {
        self.control.iter().map(|point| point.w)
    }

    /// Whether control point `(i, j)` exists: a `j` too large would index a later row.
    fn has(&self, i: usize, j: usize) -> bool {
        let [nu, nv] = self.size();
        i < nu && j < nv
    }

    /// Control point `(i, j)` in space, where it is known to exist.
    pub(crate) fn vertex(&self, i: usize, j: usize) -> DVec3 {
        let point = self.homogeneous(i, j);
        point.xyz() / point.w
    }

    /// The homogeneous control point `(i, j)`, where it is known to exist.
    pub(crate) fn homogeneous(&self, i: usize, j: usize) -> DVec4 {
        self.control[i * self.knots[1].point_count() + j]
    }

    /// Whether the weights differ; with equal weights the surface is polynomial.
    pub fn is_rational(&self) -> bool {
        self.rational
    }

    /// The common weight of all control points; `None` if weights differ.
    pub(crate) fn common_weight(&self) -> Option<f64> {
        self.control.first().filter(|_| !self.rational).map(|point| point.w)
    }

    /// The domain in u and in v.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        [self.knots[0].domain(), self.knots[1].domain()]
    }
}

impl Extent {
    /// The length along the longest axis; an error if no ray can meet the points' surface.
    pub(crate) fn wide(self) -> Result<f64, SurfaceError> {
        match self {
            Self::Wide { size } => Ok(size),
            Self::Line { from, to } => Err(SurfaceError::NoArea { from, to }),
            Self::Point(point) => Err(SurfaceError::NoExtent { point }),
        }
    }

    /// As [`Extent::wide`]; also an error if the length is below [`MIN_MAGNITUDE`].
    pub(crate) fn checked(self) -> Result<f64, SurfaceError> {
        let size = self.wide()?;
        if size < MIN_MAGNITUDE { Err(SurfaceError::TooSmall { size }) } else { Ok(size) }
    }
}

/// Checks a domain's length: derivatives are sizes over such lengths, and their squares must be
/// finite.
pub(super) fn check_domain(direction: Direction, knots: &KnotVector) -> Result<(), SurfaceError> {
    let [start, end] = knots.domain();
    if (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&(end - start)) {
        return Ok(());
    }
    Err(SurfaceError::Domain { direction, start, end })
}

/// Checks the number of control points; the product may overflow, as counts come from files.
fn check_count(
    knots_u: &KnotVector,
    knots_v: &KnotVector,
    points: usize,
) -> Result<(), SurfaceError> {
    let (nu, nv) = (knots_u.point_count(), knots_v.point_count());
    if nu.checked_mul(nv) == Some(points) {
        Ok(())
    } else {
        Err(SurfaceError::PointCount { points, nu, nv })
    }
}
