//! Surfaces to plot: in space as lines, or their trims in (u, v).

use std::fmt;

use glam::{DAffine3, DMat3, DVec2, DVec3};

use crate::geometry::{CurveError, NurbsCurve, Surface};
use crate::scene::errors::{PlotError, SceneError};
use crate::scene::making::{Placer, loop_curve, trim_curve_error};
use crate::scene::written::{
    CurveKind, LoopKind, LoopSpec, Object, ObjectSpec, Part, Place, Scene,
};

/// A surface to plot.
#[derive(Clone, Debug, PartialEq)]
pub struct PlottedSurface {
    /// The surface, in its place.
    pub surface: Surface,
    /// Its trim loops as they were written, in that order; none if it is whole.
    pub loops: Vec<Vec<LoopCurve>>,
}

/// A curve of a trim loop, as it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopCurve {
    /// What it was written as.
    pub kind: LoopCurveKind,
    /// The curve in the plane z = 0, where x is u and y is v.
    pub curve: NurbsCurve,
}

/// What a curve of a trim loop was written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LoopCurveKind {
    /// Straight lines from point to point.
    Lines,
    /// A circle or an arc of one.
    Arc,
    /// A Bézier curve.
    Bezier,
    /// A spline, by its knots or through points.
    Spline,
}

impl PlottedSurface {
    /// How many curves of constant parameter are drawn between two borders, if not given.
    pub const LINES: usize = 3;

    /// A surface of this name, made of a part of an object that is `reversed` or not, and whose u
    /// and v are not exchanged.
    ///
    /// # Errors
    /// When the numbers of a loop do not make a curve.
    pub fn new(
        name: &str,
        surface: Surface,
        part: &Part,
        reversed: bool,
    ) -> Result<Self, SceneError> {
        Self::of(name, surface, part, &Object { reverse: reversed, ..Object::default() })
    }

    /// A surface of this name, made of a part of an object.
    ///
    /// # Errors
    /// When the numbers of a loop do not make a curve.
    pub fn of(
        name: &str,
        surface: Surface,
        part: &Part,
        object: &Object,
    ) -> Result<Self, SceneError> {
        let Some(trims) = &part.trims else { return Ok(Self { surface, loops: Vec::new() }) };
        let curves_of = |(index, one): (usize, &LoopSpec)| one.curves(name, index);
        let mut loops = trims
            .loops
            .iter()
            .enumerate()
            .map(curves_of)
            .collect::<Result<Vec<Vec<LoopCurve>>, _>>()?;
        // Like the surface's own trims.
        let mut from_written = DAffine3::IDENTITY;
        if object.swap_uv {
            from_written = DAffine3::from_mat3(DMat3::from_cols(DVec3::Y, DVec3::X, DVec3::Z));
        }
        if object.reverse {
            // A point at u is then as far from the other end.
            let ([[start, _], _], [[_, end], _]) = (surface.domain(), surface.reversed().domain());
            let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
            let mirror = DAffine3::from_mat3_translation(mirror, (start + end) * DVec3::X);
            from_written = mirror * from_written;
        }
        if from_written != DAffine3::IDENTITY {
            for (index, (one, written)) in loops.iter_mut().zip(&trims.loops).enumerate() {
                for (at, LoopCurve { curve, .. }) in one.iter_mut().enumerate() {
                    *curve = curve.transformed(&from_written).map_err(|error| {
                        trim_curve_error(name, [index, at], &written.place, error.into())
                    })?;
                }
            }
        }
        Ok(Self { surface, loops })
    }
}

/// The object, and which of its surfaces.
impl fmt::Display for ObjectSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.of.value)?;
        self.surface.as_ref().map_or(Ok(()), |surface| write!(f, ", surface {}", surface.value))
    }
}

impl ObjectSpec {
    /// Makes the surfaces, each anew.
    ///
    /// # Errors
    /// When the object is not known, does not have that surface, or cannot be made; `fails` makes
    /// the error about the plot.
    pub(super) fn surfaces(
        &self,
        scene: &Scene,
        fails: impl Fn(&Place, PlotError) -> SceneError,
    ) -> Result<Vec<PlottedSurface>, SceneError> {
        let Some(object) = scene.named_object(&self.of.value) else {
            let error = scene.unknown_object(&self.of.value);
            return Err(fails(&self.of.place, PlotError::Object(error)));
        };
        let made =
            Placer { scene, most_points: Scene::MAX_POINTS }.surfaces(&self.of.value, object)?;
        if let Some(wanted) = &self.surface
            && wanted.value >= made.len()
        {
            let (of, count) = (self.of.value.clone(), made.len());
            let error = PlotError::NoSurface { of, count, wanted: wanted.value };
            return Err(fails(&wanted.place, error));
        }
        let wanted = self.surface.as_ref().map(|wanted| wanted.value);
        let made = made.into_iter().enumerate();
        let made = made.filter(|(index, _)| wanted.is_none_or(|wanted| wanted == *index));
        let plotted = made.map(|(_, (part, made))| {
            PlottedSurface::of(&self.of.value, made.surface, &object.parts[part], object)
        });
        plotted.collect()
    }

    /// The one trimmed surface.
    ///
    /// # Errors
    /// As [`ObjectSpec::surfaces`], and when there is none, or several.
    pub(super) fn trimmed(
        &self,
        scene: &Scene,
        fails: impl Fn(&Place, PlotError) -> SceneError,
    ) -> Result<PlottedSurface, SceneError> {
        let all = self.surfaces(scene, &fails)?;
        let numbers: Vec<usize> =
            (0..all.len()).filter(|&index| all[index].surface.trimmed().is_some()).collect();
        let mut trimmed = all.into_iter().filter(|one| one.surface.trimmed().is_some());
        let of = self.of.value.clone();
        match (trimmed.next(), numbers.len()) {
            (Some(only), 1) => Ok(only),
            (None, _) => Err(fails(&self.of.place, PlotError::NoTrims { of })),
            _ => Err(fails(&self.of.place, PlotError::SeveralTrimmed { of, numbers })),
        }
    }
}

impl LoopSpec {
    /// The curves of loop `index` of a surface of this name, as they were written.
    fn curves(&self, name: &str, index: usize) -> Result<Vec<LoopCurve>, SceneError> {
        let only = |kind, curve: Result<NurbsCurve, CurveError>| match curve {
            Ok(curve) => Ok(vec![LoopCurve { kind, curve }]),
            Err(error) => Err(trim_curve_error(name, [index, 0], &self.place, error.into())),
        };
        let flat = |point: &DVec2| point.extend(0.0);
        match &self.kind {
            LoopKind::Polygon(corners) => {
                // A repeated corner makes no side, such as the first one given again at the end.
                let mut closed: Vec<DVec3> =
                    corners.iter().chain(corners.first()).map(flat).collect();
                closed.dedup();
                only(LoopCurveKind::Lines, NurbsCurve::polyline(&closed))
            }
            LoopKind::Circle { center, radius } => {
                let circle = crate::geometry::shapes::circle_arc(*radius, 0.0, 360.0);
                let placed = DAffine3::from_translation(flat(center));
                let circle = circle.and_then(|circle| circle.transformed(&placed));
                only(LoopCurveKind::Arc, circle)
            }
            LoopKind::Curves(curves) => {
                let made = curves.iter().enumerate().map(|(at, spec)| {
                    let kind = match &spec.kind {
                        CurveKind::Polyline(_) => LoopCurveKind::Lines,
                        CurveKind::Bezier(_) => LoopCurveKind::Bezier,
                        CurveKind::Arc { .. }
                        | CurveKind::NamedArc(_)
                        | CurveKind::QuadraticArc(_)
                        | CurveKind::QuarticConstants { .. }
                        | CurveKind::QuarticArc { .. } => LoopCurveKind::Arc,
                        _ => LoopCurveKind::Spline,
                    };
                    Ok(LoopCurve { kind, curve: loop_curve(name, [index, at], spec)? })
                });
                made.collect()
            }
        }
    }
}
