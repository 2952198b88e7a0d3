//! Surfaces as nets of Bézier pieces, row by row.

use std::borrow::Cow;

use glam::DVec4;

use super::NurbsSurface;
use crate::geometry::polygon::{Insertions, merged};
use crate::geometry::{Direction, KnotVector};

/// A surface cut into Bézier pieces: clamped, with every inner knot at least `p` times.
///
/// Only the refinement along u is stored; the one along v is computed for each requested row. The
/// Bézier net of a dense bicubic surface is nine times as large as the surface, and a caller that
/// stores it in another form need not hold it twice.
pub(crate) struct BezierForm<'a> {
    along_u: Cow<'a, NurbsSurface>,
    insertions_v: Insertions,
    knots_v: KnotVector,
}

impl<'a> BezierForm<'a> {
    pub(crate) fn new(surface: &'a NurbsSurface) -> Self {
        let mut surface = surface.in_clamped_form();
        let missing_u = surface.knots_u().missing_for_bezier();
        if !missing_u.is_empty() {
            surface = Cow::Owned(surface.refined(Direction::U, &missing_u));
        }
        let knots_v = surface.knots_v();
        let missing_v = knots_v.missing_for_bezier();
        let insertions_v = Insertions::new(knots_v, &missing_v);
        let values = merged(knots_v.values(), &missing_v);
        let knots_v = KnotVector::derived(knots_v.degree(), values);
        Self { along_u: surface, insertions_v, knots_v }
    }

    /// The knot vectors in u and v.
    pub(crate) fn knots(&self) -> [&KnotVector; 2] {
        [self.along_u.knots_u(), &self.knots_v]
    }

    /// The common weight of all control points; `None` if weights differ. Refining along v keeps
    /// equal weights equal, so the net refined along u decides.
    pub(crate) fn weight(&self) -> Option<f64> {
        self.along_u.common_weight()
    }

    /// The homogeneous control points of row `i`, in increasing v.
    pub(crate) fn row(&self, i: usize) -> Vec<DVec4> {
        let length = self.along_u.knots_v().point_count();
        self.insertions_v.apply(&self.along_u.control()[i * length..(i + 1) * length])
    }
}
