//! Surfaces of any kind as charts: one or several NURBS surfaces, each with its place in the whole.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec2;

use super::NurbsSurface;
use super::trim::Trims;

/// A part of a surface that is a NURBS surface itself, and its place in the whole.
///
/// Other kinds of surface are divided into charts, so that the code that bounds, intersects and
/// draws surfaces handles NURBS only.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    /// The part, on its own domain.
    pub surface: Cow<'a, NurbsSurface>,
    /// The map from the chart's parameters to the whole surface's (u, v).
    pub map: ChartMap,
    /// Which sides are borders of the whole surface, in the order of
    /// [`RectSide::ALL`](super::RectSide::ALL).
    pub border: [bool; 4],
    /// Whether the last u, and the last v, belong to another chart, which begins there with
    /// other values. Points at such an end get the last number below it as their u or v.
    pub open_end: [bool; 2],
    /// The trims that keep a part of the chart, on its own domain; `None` keeps all of it.
    pub trims: Option<Arc<Trims>>,
}

/// Where a chart lies in the parameters of the whole surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChartMap {
    /// The chart's parameters are the whole surface's.
    Identity,
    /// The chart's unit square is mapped bilinearly: its corners (0, 0), (1, 0), (0, 1) and
    /// (1, 1) go to these places. The orientation is kept.
    Bilinear([DVec2; 4]),
}

impl ChartMap {
    /// The parameters, on the whole surface, of a place on the chart.
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
    /// The parameters, on the whole surface, of a place on the chart; at an
    /// [open end](Self::open_end) the last number below it.
    pub fn uv(&self, at: DVec2) -> DVec2 {
        let [u, v] = self.surface.domain();
        let inside = |t: f64, end: f64, open| if open && t >= end { end.next_down() } else { t };
        let [open_u, open_v] = self.open_end;
        self.map.uv(DVec2::new(inside(at.x, u[1], open_u), inside(at.y, v[1], open_v)))
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

/// A surface that can be traced: it consists of charts.
///
/// The trait is sealed: only the surfaces of this crate have charts. Nothing checks that charts
/// agree where they meet, or which of their sides are borders, and the count of crossings depends
/// on that. References and pointers to a surface have its charts, so that it need not be copied:
///
/// ```
/// use std::sync::Arc;
///
/// use nurbray::geometry::{Surface, shapes};
/// use nurbray::intersect::SurfaceBvh;
///
/// let shared: Arc<Surface> = Arc::new(shapes::sphere(1.0)?.into());
/// let bvh = SurfaceBvh::build(&[Arc::clone(&shared)])?;
/// assert_eq!(bvh.surface_count(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Charts: Sealed {
    /// The charts, which together are the surface.
    fn charts(&self) -> Vec<Chart<'_>>;
}

/// Pointers to a surface stand for it.
macro_rules! charts_of_pointers {
    ($($pointer:ty),*) => {$(
        impl<S: Charts + ?Sized> Charts for $pointer {
            fn charts(&self) -> Vec<Chart<'_>> {
                (**self).charts()
            }
        }

        impl<S: Sealed + ?Sized> Sealed for $pointer {}
    )*};
}

charts_of_pointers!(&S, Box<S>, Arc<S>);

/// Only the surfaces of this crate.
pub trait Sealed {}

impl Sealed for NurbsSurface {}

impl Charts for NurbsSurface {
    fn charts(&self) -> Vec<Chart<'_>> {
        vec![Chart::whole(self)]
    }
}
