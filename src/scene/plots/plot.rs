//! Plots, checked.

use glam::DVec3;

use super::curve::blame;
use super::{PlottedBasis, PlottedCurve, PlottedSurface};
use crate::geometry::{CornerCutting, CurveError, NurbsCurve, PolygonEnds};
use crate::scene::errors::{PlotError, SceneError, SceneFault};
use crate::scene::written::{
    CurveEntry, CurveFault, CurveKind, CurveSpec, MAX_FUNCTIONS, MAX_LINES, MAX_ROUNDS, MAX_TEETH,
    Place, Plane, PlotKind, PlotSpec, Scene, Written,
};

/// A plot whose numbers have been checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What stands above it.
    pub title: Option<String>,
    /// How space is shown: if not given, so that no coordinate is hidden in which things vary.
    pub plane: Option<Plane>,
    /// What is drawn.
    pub show: PlotKind<PlottedCurve, PlottedBasis, Vec<PlottedSurface>>,
}

impl Plot {
    /// The most functions of a basis: no screen shows more.
    pub const MAX_FUNCTIONS: usize = MAX_FUNCTIONS;
}

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
        let title = self.title.clone().or_else(|| self.title_by_object());
        Ok(Plot { title, plane: self.plane, show })
    }

    /// What a plot of an object's surfaces is called if it has no title.
    fn title_by_object(&self) -> Option<String> {
        match &self.show {
            PlotKind::Trims(of) => Some(format!("Trims of {of}")),
            PlotKind::Surfaces { of, .. } => Some(format!("{of} in space")),
            _ => None,
        }
    }
}

impl Checker<'_> {
    fn kind(&self) -> Result<PlotKind<PlottedCurve, PlottedBasis, Surfaces>, SceneError> {
        let place = &self.spec.place;
        Ok(match &self.spec.show {
            PlotKind::Curves(entries) => PlotKind::Curves(self.entries(entries)?),
            PlotKind::Basis(basis) => {
                PlotKind::Basis(basis.checked(|place, error| self.error(place, error))?)
            }
            PlotKind::Blending(form) => PlotKind::Blending(*form),
            PlotKind::Derivatives { curve, order } => {
                let (curve, order) = (self.derivable(curve, order)?, order.clone());
                PlotKind::Derivatives { curve, order }
            }
            PlotKind::Hodograph { curve, order } => {
                let (curve, order) = (self.derivable(curve, order)?, order.clone());
                PlotKind::Hodograph { curve, order }
            }
            PlotKind::Curvature(curve) => PlotKind::Curvature(self.nurbs(curve)?),
            PlotKind::Comb { curve, teeth, scale } => {
                if !(1..=MAX_TEETH).contains(teeth) {
                    return Err(self.error(place, PlotError::Teeth { found: *teeth }));
                }
                PlotKind::Comb { curve: self.nurbs(curve)?, teeth: *teeth, scale: *scale }
            }
            PlotKind::Insertion { curve, knots } => {
                let curve = self.nurbs(curve)?;
                if let Some(nurbs) = curve.nurbs() {
                    self.insert(nurbs, knots)?;
                }
                PlotKind::Insertion { curve, knots: knots.clone() }
            }
            PlotKind::Elevation { curve, times } => {
                let curve = self.nurbs(curve)?;
                if let Some(nurbs) = curve.nurbs() {
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

    /// The curves drawn in one plot, one at least.
    fn entries(
        &self,
        entries: &[CurveEntry<CurveSpec>],
    ) -> Result<Vec<CurveEntry<PlottedCurve>>, SceneError> {
        if entries.is_empty() {
            return Err(self.error(&self.spec.place, PlotError::NoCurves));
        }
        let checked = entries.iter().enumerate().map(|(index, entry)| {
            let curve = self.curve(&format!("curve {index}"), &entry.curve)?;
            let label = entry.label.clone();
            Ok(CurveEntry { curve, label, polygon: entry.polygon, knots: entry.knots })
        });
        checked.collect()
    }

    /// A curve with positive weights that has this derivative.
    fn derivable(
        &self,
        curve: &CurveSpec,
        order: &Written<usize>,
    ) -> Result<PlottedCurve, SceneError> {
        let curve = self.nurbs(curve)?;
        let degree = curve.knots().degree();
        if (1..=degree).contains(&order.value) {
            return Ok(curve);
        }
        Err(self.error(&order.place, PlotError::Order { found: order.value, degree }))
    }

    /// A curve whose domain holds `t`.
    fn curve_with(&self, curve: &CurveSpec, t: &Written<f64>) -> Result<PlottedCurve, SceneError> {
        let curve = self.curve("curve", curve)?;
        let [start, end] = curve.knots().domain();
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
            CurveKind::Nurbs { weights: Some(weights), .. } => weights.value.contains(&0.0),
            _ => false,
        };
        if !zero {
            return spec.plotted_curve().map_err(|fault| {
                let fault = match fault {
                    // Here a weight may be zero, and the message says so.
                    CurveFault::Curve(place, CurveError::Weight { index, weight }) => {
                        CurveFault::Curve(place, CurveError::BasisWeight { index, weight })
                    }
                    fault => fault,
                };
                blame(&self.name, which, fault)
            });
        }
        let (basis, points) = spec.weighted().map_err(|fault| blame(&self.name, which, fault))?;
        Ok(PlottedCurve::Weighted { basis, points })
    }

    /// A curve whose weights must be positive: the only one of its plot.
    fn nurbs(&self, spec: &CurveSpec) -> Result<PlottedCurve, SceneError> {
        spec.curve().map(PlottedCurve::Nurbs).map_err(|fault| blame(&self.name, "curve", fault))
    }
}
