//! What is traced, as one or several NURBS surfaces in their places.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec2;

use super::NurbsSurface;
use super::trim::Trims;

/// A part of a surface that is a NURBS surface itself, and its place in the whole.
///
/// Kinds of surface other than NURBS become charts, so that what bounds, meets and draws
/// surfaces knows of NURBS only.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    /// The part, on its own domain.
    pub surface: Cow<'a, NurbsSurface>,
    /// Where that lies in the whole's (u, v).
    pub map: ChartMap,
    /// Which sides are borders of the whole surface: first u, last u, first v, last v.
    pub border: [bool; 4],
    /// Whether the last u, and the last v, belong to another chart, that begins there with
    /// something else: (u, v) of points there are the last numbers before it.
    pub open_end: [bool; 2],
    /// Which part of it is there, on its own domain; all of it without trims.
    pub trims: Option<Arc<Trims>>,
}

/// Where a chart lies in the parameters of the whole surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChartMap {
    /// The chart's parameters are the whole surface's.
    Identity,
    /// The chart's unit square is mapped bilinearly, to these places of (0, 0), (1, 0),
    /// (0, 1) and (1, 1); it keeps its orientation.
    Bilinear([DVec2; 4]),
}

impl ChartMap {
    /// The whole's parameters of a place on the chart.
    #[inline]
    pub fn uv(&self, at: DVec2) -> DVec2 {
        match self {
            Self::Identity => at,
            Self::Bilinear([c00, c10, c01, c11]) => {
                let DVec2 { x: s, y: t } = at;
                (1.0 - s) * ((1.0 - t) * c00 + t * c01) + s * ((1.0 - t) * c10 + t * c11)
            }
        }
    }
}

impl<'a> Chart<'a> {
    /// The whole's parameters of a place on the chart; at an [open end](Self::open_end) the
    /// last numbers before it.
    pub fn uv(&self, at: DVec2) -> DVec2 {
        let [u, v] = self.surface.domain();
        let inside = |t: f64, end: f64, open| if open && t >= end { end.next_down() } else { t };
        let [open_u, open_v] = self.open_end;
        self.map.uv(DVec2::new(inside(at.x, u.1, open_u), inside(at.y, v.1, open_v)))
    }

    /// A whole surface as its only chart.
    pub fn whole(surface: &'a NurbsSurface) -> Self {
        Self {
            surface: Cow::Borrowed(surface),
            map: ChartMap::Identity,
            border: [true; 4],
            open_end: [false; 2],
            trims: None,
        }
    }
}

/// What can be traced: it has charts.
pub trait Charts {
    /// The parts, which together are the surface.
    fn charts(&self) -> Vec<Chart<'_>>;
}

impl Charts for NurbsSurface {
    fn charts(&self) -> Vec<Chart<'_>> {
        vec![Chart::whole(self)]
    }
}
