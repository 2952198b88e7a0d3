//! Plots as written.

use glam::DVec3;

use super::{CurveSpec, Knots, Place, Written};
use crate::geometry::{CornerCutting, MatrixForm, PolygonEnds};
use crate::scene::look::VIEW_FROM;

/// How the plots of a scene lie in one picture, as far as the author says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigureSpec {
    /// Width and height of the picture in pixels.
    pub size: Option<Written<[u32; 2]>>,
    /// How many plots lie side by side.
    pub columns: Option<Written<usize>>,
}

/// A plot as written, not yet checked.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotSpec {
    /// Where it was written.
    pub place: Place,
    /// What stands above it.
    pub title: Option<String>,
    /// How space is shown: if not given, so that no coordinate is hidden in which things vary.
    pub plane: Option<Plane>,
    /// What is drawn.
    pub show: PlotKind<CurveSpec, BasisSpec, ObjectSpec>,
}

/// The plane of a plot of space: two coordinates, the one to the right and the one upwards, or that
/// of a parallel view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plane {
    /// x and y.
    Xy,
    /// x and z.
    Xz,
    /// y and z.
    Yz,
    /// Across this direction, which points to the viewer; z is upwards.
    Across(DVec3),
}

impl Plane {
    /// As rendered pictures show things if no camera is given: from the front right, above.
    pub const OBLIQUE: Self = Self::Across(VIEW_FROM);

    /// The unit vectors to the right, upwards and to the viewer.
    pub fn directions(self) -> [DVec3; 3] {
        let (right, up) = match self {
            Self::Xy => (DVec3::X, DVec3::Y),
            Self::Xz => (DVec3::X, DVec3::Z),
            Self::Yz => (DVec3::Y, DVec3::Z),
            Self::Across(toward) => {
                // Seen from above, x is to the right.
                let right = DVec3::Z.cross(toward).normalize_or(DVec3::X);
                (right, toward.normalize_or(DVec3::Z).cross(right))
            }
        };
        [right, up, right.cross(up)]
    }
}

/// What a plot can show of curves `C`, basis functions `B` and surfaces `S`, as written or
/// checked.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PlotKind<C, B, S> {
    /// Curves in space.
    Curves(Vec<CurveEntry<C>>),
    /// The basis functions over a knot vector.
    Basis(B),
    /// The functions that blend the four vectors of a matrix form, on `[0, 1]`.
    Blending(MatrixForm),
    /// The coordinates of a curve's derivative, and its length, over the parameter.
    Derivatives {
        /// The curve.
        curve: C,
        /// Which derivative, from 1 to the degree.
        order: Written<usize>,
    },
    /// The curve that a curve's derivative runs through.
    Hodograph {
        /// The curve.
        curve: C,
        /// Which derivative, from 1 to the degree.
        order: Written<usize>,
    },
    /// The curvature of a curve over the parameter.
    Curvature(C),
    /// A curve with teeth across it, as long as its curvature.
    Comb {
        /// The curve.
        curve: C,
        /// How many teeth each of its spans has.
        teeth: usize,
        /// The length of a tooth for curvature 1; chosen to fit if not given.
        scale: Option<f64>,
    },
    /// The control polygons of a curve while knots are inserted.
    Insertion {
        /// The curve.
        curve: C,
        /// The knots, one after the other.
        knots: Vec<Written<f64>>,
    },
    /// The control polygons of a curve while its degree is raised.
    Elevation {
        /// The curve.
        curve: C,
        /// How often.
        times: Written<usize>,
    },
    /// The points of de Casteljau's algorithm, or of de Boor's where the curve has several
    /// pieces.
    DeCasteljau {
        /// The curve.
        curve: C,
        /// The parameter of the point that is constructed.
        t: Written<f64>,
    },
    /// Polygons whose corners are cut, with the limit.
    CornerCutting {
        /// The polygon.
        polygon: Vec<DVec3>,
        /// The rule.
        scheme: CornerCutting,
        /// Whether it closes.
        ends: PolygonEnds,
        /// How often corners are cut.
        rounds: usize,
    },
    /// The trim loops of a surface in its (u, v), and what they keep; once checked, of one surface.
    Trims(S),
    /// Surfaces in space: borders, trim edges, curves of constant parameter.
    Surfaces {
        /// The surfaces.
        of: S,
        /// How many curves there are between two borders in each direction, between the
        /// borders of faces where a cage has faces.
        lines: usize,
        /// Whether control nets are drawn, too.
        net: bool,
    },
}

/// One of several curves in a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveEntry<C> {
    /// The curve.
    pub curve: C,
    /// What the legend calls it.
    pub label: Option<String>,
    /// Whether its control polygon is drawn.
    pub polygon: bool,
    /// Whether its knots are marked.
    pub knots: bool,
}

/// Basis functions as written.
#[derive(Clone, Debug, PartialEq)]
pub struct BasisSpec {
    /// The degree.
    pub degree: usize,
    /// The knots.
    pub knots: Written<Knots>,
    /// The number of control points, where neither knots nor weights give it: that of the
    /// functions, but periodic knots have `degree` functions more, as the first ones come again
    /// at the end of the period.
    pub count: Option<usize>,
    /// The weights; all 1 if not given.
    pub weights: Option<Written<Vec<f64>>>,
    /// Whether functions are drawn off the domain, too, wherever they do not vanish.
    pub support: bool,
    /// Which derivative of the functions is drawn; the functions themselves if not given.
    pub derivative: Option<Written<usize>>,
}

/// The surfaces of an object to plot, as written.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectSpec {
    /// The object's name.
    pub of: Written<String>,
    /// Which of its surfaces, counted from 0, if not all.
    pub surface: Option<Written<usize>>,
}

/// The most rounds of corner cutting: each doubles the polygon, and after ten no screen shows what
/// another one changes.
pub(in crate::scene) const MAX_ROUNDS: usize = 10;

/// The most teeth a span's comb may have: more would be closer together than any screen shows.
pub(in crate::scene) const MAX_TEETH: usize = 1000;

/// The most curves of a surface in one direction: more would be closer together than any screen
/// shows.
pub(in crate::scene) const MAX_LINES: usize = 1000;

/// The most functions of a basis: no screen shows more.
pub(in crate::scene) const MAX_FUNCTIONS: usize = 1000;
