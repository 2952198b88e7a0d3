//! The borders of a surface: sides of its charts, or the three sides of a triangle.

use glam::DVec3;
use nurbray::geometry::{Chart, Surface, TrianglePatch, TriangleSide};

use super::super::border::Border;
use super::border_curve::BorderCurve;
use super::which::Which;

/// A border of a surface, which may be collapsed to a point.
pub(super) enum Side<'a> {
    /// A border of a chart, or of a knot in it where the surface may jump.
    OfChart(&'a Chart<'a>, Border),
    /// A side of a triangle, of which two charts have a half each.
    OfTriangle(&'a TrianglePatch, TriangleSide),
}

impl<'a> Side<'a> {
    /// The borders of a surface with these charts.
    pub(super) fn all(surface: &'a Surface, charts: &'a [Chart<'a>]) -> Vec<Self> {
        if let Surface::Triangle(patch) = surface {
            let sides = [TriangleSide::U, TriangleSide::V, TriangleSide::W];
            return sides.map(|side| Self::OfTriangle(patch, side)).into();
        }
        let of_chart = |chart: &'a Chart<'a>| {
            let borders = Border::of(chart).chain(Border::inner(chart));
            borders.map(move |border| Self::OfChart(chart, border))
        };
        charts.iter().flat_map(of_chart).collect()
    }

    /// What reports call it.
    pub(super) fn which(&self) -> Which {
        match self {
            Self::OfChart(_, border) => Which::Border(*border),
            Self::OfTriangle(_, side) => Which::Side(*side),
        }
    }

    /// The curve, if it is not collapsed and trims leave something of it.
    pub(super) fn curve(&self) -> Option<BorderCurve<'a>> {
        if self.pole().is_some() {
            return None;
        }
        match self {
            Self::OfChart(chart, border) => BorderCurve::new(chart, *border),
            Self::OfTriangle(patch, side) => Some(BorderCurve::of_side(patch, *side)),
        }
    }

    /// The point it is collapsed to, if it is and trims keep some of it.
    pub(super) fn kept_pole(&self) -> Option<DVec3> {
        self.pole().filter(|_| match self {
            Self::OfChart(chart, border) => border.is_kept(chart),
            Self::OfTriangle(..) => true,
        })
    }

    fn pole(&self) -> Option<DVec3> {
        match self {
            Self::OfChart(chart, border) => border.pole(&chart.surface),
            Self::OfTriangle(patch, side) => {
                let curve = patch.side(*side);
                curve.point(0).filter(|_| curve.is_point())
            }
        }
    }
}
