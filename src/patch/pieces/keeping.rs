//! How much memory control points may take: which of them are kept, and which are made on demand.

use super::piece_net::numbers_a_point;
use crate::geometry::{Chart, Extractions, KnotVector, NurbsSurface};

/// How the control points of charts are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::patch) enum Keeping {
    /// All Bézier points, ready to be used.
    Bezier,
    /// Where this is possible and saves much, the control points of the B-spline, from which pieces
    /// make their Bézier points.
    Spline,
}

/// The Bézier points of all charts are kept as long as they take no more than this together: with
/// everything else they fit into a core's own cache, of 1 or 2 MB, and a small model does not lack
/// memory. If they are made anew for each search, a sheet of 64 × 64 spans (0.9 MB) is traced 0.94
/// to 1.0 times as fast.
const MOST_BEZIER_BYTES: usize = 1 << 18;

/// Charts with fewer than this many times as many Bézier points as control points keep their Bézier
/// points all the same. So do charts of so few spans that their control points, with what makes
/// nets of them, take more than one part in this many of the memory.
const LEAST_SAVING: usize = 2;

impl Keeping {
    /// The choice for all charts together, which share the cache.
    pub(in crate::patch) fn of<'c>(charts: impl Iterator<Item = &'c Chart<'c>>) -> Self {
        let bytes = charts
            .map(|chart| {
                let size = numbers_a_point(chart.surface.common_weight());
                chart.surface.bezier_point_count().saturating_mul(size_of::<f64>() * size)
            })
            .fold(0, usize::saturating_add);
        if bytes > MOST_BEZIER_BYTES { Self::Spline } else { Self::Bezier }
    }

    /// How one surface's control points are kept, given the choice for all.
    pub(super) fn of_one(self, surface: &NurbsSurface) -> Self {
        let degrees = [surface.knots_u(), surface.knots_v()].map(KnotVector::degree);
        let can_be_made = degrees.iter().all(|&degree| degree <= Extractions::MOST_DEGREE);
        let saves = self == Self::Spline && can_be_made && spline_saves(surface);
        if saves { Self::Spline } else { Self::Bezier }
    }

    /// How many Bézier points of a surface are kept.
    pub(in crate::patch) fn bezier_points(self, surface: &NurbsSurface) -> usize {
        match self.of_one(surface) {
            Self::Bezier => surface.bezier_point_count(),
            Self::Spline => 0,
        }
    }
}

/// How many pieces a surface is cut into.
pub(in crate::patch) fn piece_count(surface: &NurbsSurface) -> usize {
    surface.knots_u().spans().count().saturating_mul(surface.knots_v().spans().count())
}

/// Whether a surface has many times as many Bézier points as control points, and its Bézier points,
/// with the power nets kept beside them, take much more memory than its control points with what
/// makes nets of them.
fn spline_saves(surface: &NurbsSurface) -> bool {
    let knots = [surface.knots_u(), surface.knots_v()];
    let (bezier, control) = (surface.bezier_point_count(), surface.control().len());
    let by_powers: usize =
        knots.iter().map(|knots| knots.spans().count() * (knots.degree() + 1)).product();
    let makers = knots.iter().map(|knots| {
        let p = knots.degree();
        knots.point_count() * (Extractions::numbers_a_span(p) + p * (p + 1))
    });
    let size = numbers_a_point(surface.common_weight());
    let kept = size * control + makers.sum::<usize>();
    bezier >= LEAST_SAVING * control && size * (bezier + by_powers) >= LEAST_SAVING * kept
}
