//! Plots as written, and checked.

use glam::DVec3;

use super::curve::CurveFault;
use super::{
    BasisSpec, CurveKind, CurveSpec, ObjectSpec, Place, PlotError, PlottedBasis, PlottedSurface,
    Scene, SceneError, SceneFault, Written,
};
use crate::geometry::{
    CornerCutting, CurveError, KnotVector, MatrixForm, NurbsCurve, PolygonEnds, RationalBasis,
};

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
    /// The coordinates of space that are shown; those its curves vary most in if not given.
    pub plane: Option<Plane>,
    /// What is drawn.
    pub show: PlotKind<CurveSpec, BasisSpec, ObjectSpec>,
}

/// A plot whose numbers have been checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What stands above it.
    pub title: Option<String>,
    /// The coordinates of space that are shown; those its curves vary most in if not given.
    pub plane: Option<Plane>,
    /// What is drawn.
    pub show: PlotKind<PlottedCurve, PlottedBasis, Vec<PlottedSurface>>,
}

impl Plot {
    /// The most functions of a basis: no screen shows more.
    pub const MAX_FUNCTIONS: usize = 1000;
}

/// Two coordinates of space: the one to the right and the one upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// x and y.
    Xy,
    /// x and z.
    Xz,
    /// y and z.
    Yz,
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
    /// The coordinates of a curve's first derivative, and the speed, over the parameter.
    Derivatives(C),
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

/// A curve to plot, whose weights may be zero.
#[derive(Clone, Debug, PartialEq)]
pub enum PlottedCurve {
    /// A NURBS curve.
    Nurbs(NurbsCurve),
    /// A curve that some control points have no influence on.
    Weighted {
        /// The basis with its weights.
        basis: RationalBasis,
        /// The control points.
        points: Vec<DVec3>,
    },
}

impl From<NurbsCurve> for PlottedCurve {
    fn from(curve: NurbsCurve) -> Self {
        Self::Nurbs(curve)
    }
}

impl PlottedCurve {
    /// The knots.
    pub fn knots(&self) -> &KnotVector {
        match self {
            Self::Nurbs(curve) => curve.knots(),
            Self::Weighted { basis, .. } => basis.knots(),
        }
    }

    /// The control points in space.
    pub fn points(&self) -> Vec<DVec3> {
        match self {
            Self::Nurbs(curve) => {
                (0..curve.control().len()).map(|index| curve.point(index)).collect()
            }
            Self::Weighted { points, .. } => points.clone(),
        }
    }

    /// The weights of the control points.
    pub fn weights(&self) -> Vec<f64> {
        match self {
            Self::Nurbs(curve) => curve.control().iter().map(|point| point.w).collect(),
            Self::Weighted { basis, .. } => basis.weights().to_vec(),
        }
    }

    /// The point at a parameter of the domain.
    pub fn point_at(&self, t: f64) -> DVec3 {
        match self {
            Self::Nurbs(curve) => curve.point_at(t),
            // There are as many points as weights: `None` does not occur.
            Self::Weighted { basis, points } => basis.point(points, t).unwrap_or(DVec3::NAN),
        }
    }

    /// The curve, if all its weights are positive.
    pub fn nurbs(&self) -> Option<&NurbsCurve> {
        match self {
            Self::Nurbs(curve) => Some(curve),
            Self::Weighted { .. } => None,
        }
    }
}

/// The most rounds of corner cutting: each doubles the polygon, and after ten no screen shows what
/// another one changes.
pub(super) const MAX_ROUNDS: usize = 10;

/// The most teeth a span's comb may have: more would be closer together than any screen shows.
pub(super) const MAX_TEETH: usize = 1000;

/// The most curves of a surface in one direction: more would be closer together than any screen
/// shows.
pub(super) const MAX_LINES: usize = 1000;

type Surfaces = Vec<PlottedSurface>;

/// Checks one plot, which errors call `name`.
struct Checker<'a> {
    name: String,
    spec: &'a PlotSpec,
    scene: &'a Scene,
}

impl PlotSpec {
    /// Returns the plot, if its numbers make sense. Errors call it by its title or `number`,
    /// counted from 0. Objects it names are those of `scene`.
    ///
    /// # Errors
    /// When a curve, a knot vector, a weight or a parameter is not valid, or an object cannot be
    /// shown.
    pub fn checked(&self, number: usize, scene: &Scene) -> Result<Plot, SceneError> {
        let name = match &self.title {
            Some(title) => format!("\"{title}\""),
            None => number.to_string(),
        };
        let show = Checker { name, spec: self, scene }.kind()?;
        Ok(Plot { title: self.title.clone(), plane: self.plane, show })
    }
}

impl Checker<'_> {
    fn kind(&self) -> Result<PlotKind<PlottedCurve, PlottedBasis, Surfaces>, SceneError> {
        let place = &self.spec.place;
        Ok(match &self.spec.show {
            PlotKind::Curves(entries) => {
                if entries.is_empty() {
                    return Err(self.error(place, PlotError::NoCurves));
                }
                let checked = entries.iter().enumerate().map(|(index, entry)| {
                    let curve = self.curve(&format!("curve {index}"), &entry.curve)?;
                    let label = entry.label.clone();
                    Ok(CurveEntry { curve, label, polygon: entry.polygon, knots: entry.knots })
                });
                PlotKind::Curves(checked.collect::<Result<_, SceneError>>()?)
            }
            PlotKind::Basis(basis) => {
                PlotKind::Basis(basis.checked(|place, error| self.error(place, error))?)
            }
            PlotKind::Blending(form) => PlotKind::Blending(*form),
            PlotKind::Derivatives(curve) => PlotKind::Derivatives(self.nurbs(curve)?),
            PlotKind::Curvature(curve) => PlotKind::Curvature(self.nurbs(curve)?),
            PlotKind::Comb { curve, teeth, scale } => {
                if !(1..=MAX_TEETH).contains(teeth) {
                    return Err(self.error(place, PlotError::Teeth { found: *teeth }));
                }
                PlotKind::Comb { curve: self.nurbs(curve)?, teeth: *teeth, scale: *scale }
            }
            PlotKind::Insertion { curve, knots } => {
                let curve = self.nurbs(curve)?;
                if let PlottedCurve::Nurbs(nurbs) = &curve {
                    self.insert(nurbs, knots)?;
                }
                PlotKind::Insertion { curve, knots: knots.clone() }
            }
            PlotKind::Elevation { curve, times } => {
                let curve = self.nurbs(curve)?;
                if let PlottedCurve::Nurbs(nurbs) = &curve {
                    self.elevate(nurbs, times)?;
                }
                PlotKind::Elevation { curve, times: times.clone() }
            }
            PlotKind::DeCasteljau { curve, t } => {
                PlotKind::DeCasteljau { curve: self.curve_with(curve, t)?, t: t.clone() }
            }
            PlotKind::CornerCutting { polygon, scheme, ends, rounds } => {
                self.check_cutting(polygon, (*scheme, *ends), *rounds)?;
                PlotKind::CornerCutting {
                    polygon: polygon.clone(),
                    scheme: *scheme,
                    ends: *ends,
                    rounds: *rounds,
                }
            }
            PlotKind::Trims(of) => {
                let trimmed = of.trimmed(self.scene, |place, error| self.error(place, error))?;
                PlotKind::Trims(vec![trimmed])
            }
            PlotKind::Surfaces { of, lines, net } => {
                if *lines > MAX_LINES {
                    return Err(self.error(place, PlotError::Lines { found: *lines }));
                }
                let of = of.surfaces(self.scene, |place, error| self.error(place, error))?;
                PlotKind::Surfaces { of, lines: *lines, net: *net }
            }
        })
    }

    /// A curve whose domain holds `t`.
    fn curve_with(&self, curve: &CurveSpec, t: &Written<f64>) -> Result<PlottedCurve, SceneError> {
        let curve = self.curve("curve", curve)?;
        let (start, end) = curve.knots().domain();
        if (start..=end).contains(&t.value) {
            return Ok(curve);
        }
        let error = CurveError::Parameter { t: t.value, start, end };
        Err(self.error(&t.place, PlotError::At(error)))
    }

    fn check_cutting(
        &self,
        polygon: &[DVec3],
        (scheme, ends): (CornerCutting, PolygonEnds),
        rounds: usize,
    ) -> Result<(), SceneError> {
        let place = &self.spec.place;
        if rounds > MAX_ROUNDS {
            return Err(self.error(place, PlotError::Rounds { found: rounds }));
        }
        let limit = scheme.limit(polygon, ends);
        limit.map(drop).map_err(|error| self.error(place, PlotError::Polygon(error)))
    }

    fn error(&self, place: &Place, error: PlotError) -> SceneError {
        SceneError::new(place.clone(), SceneFault::Plot { plot: self.name.clone(), error })
    }

    /// Inserts the knots as a trial.
    fn insert(&self, curve: &NurbsCurve, knots: &[Written<f64>]) -> Result<(), SceneError> {
        if knots.is_empty() {
            return Err(self.error(&self.spec.place, PlotError::NoKnots));
        }
        let mut curve = curve.clone();
        for knot in knots {
            let inserted = curve.insert_knot(knot.value, 1);
            curve = inserted.map_err(|error| self.error(&knot.place, PlotError::At(error)))?;
        }
        Ok(())
    }

    /// Raises the degree as a trial.
    fn elevate(&self, curve: &NurbsCurve, times: &Written<usize>) -> Result<(), SceneError> {
        if times.value == 0 {
            return Err(self.error(&times.place, PlotError::NotElevated));
        }
        let elevated = curve.elevated(times.value);
        elevated.map(drop).map_err(|error| self.error(&times.place, PlotError::At(error)))
    }

    fn curve(&self, which: &str, spec: &CurveSpec) -> Result<PlottedCurve, SceneError> {
        let zero = match &spec.kind {
            CurveKind::Nurbs { weights: Some(weights), .. } => weights.contains(&0.0),
            _ => false,
        };
        if !zero {
            return spec.curve().map(PlottedCurve::Nurbs).map_err(|e| blame(&self.name, which, e));
        }
        let (basis, points) = spec.weighted().map_err(|fault| blame(&self.name, which, fault))?;
        Ok(PlottedCurve::Weighted { basis, points })
    }

    /// A curve whose weights must be positive: the only one of its plot.
    fn nurbs(&self, spec: &CurveSpec) -> Result<PlottedCurve, SceneError> {
        spec.curve().map(PlottedCurve::Nurbs).map_err(|fault| blame(&self.name, "curve", fault))
    }
}

pub(super) fn blame(plot: &str, which: &str, fault: CurveFault) -> SceneError {
    let (plot, which) = (plot.to_owned(), which.to_owned());
    let (place, error) = match fault {
        CurveFault::Curve(place, error) => (place, PlotError::Curve { which, error }),
        CurveFault::Transform(place, error) => (place, PlotError::Transform { which, error }),
    };
    SceneError::new(place, SceneFault::Plot { plot, error })
}

impl CurveSpec {
    /// Returns the curve for a plot, which errors call `plot`.
    ///
    /// # Errors
    /// When its numbers do not make a curve.
    pub fn plotted(&self, plot: &str) -> Result<PlottedCurve, SceneError> {
        self.curve().map(PlottedCurve::Nurbs).map_err(|fault| blame(plot, "curve", fault))
    }
}
