//! The making of constructions' surfaces.

use std::collections::HashMap;

use super::drawn::{control_nets, iso_curves, iso_lines, trim_curves};
use super::made::Made;
use crate::geometry::construct::{
    self, Axis, Borders, Component, ComponentKind, ConstructError, ControlNet, DirectionOf, Sweep,
};
use crate::geometry::{
    CurveError, KnotError, NurbsCurve, NurbsSurface, Surface, SurfaceError, matrix_surface,
};
use crate::scene::errors::{DrawError, SceneError, SceneFault};
use crate::scene::written::{Construction, CurveFault, CurveSpec, Place, Written};

/// Makes the surfaces of one part, and knows its name and its place for errors.
pub(super) struct Workshop<'a> {
    /// The surface's name.
    pub(super) surface: &'a str,
    /// Where the construction was written.
    pub(super) place: &'a Place,
    /// Where its numbers were written, by their keys.
    pub(super) written: &'a [Written<&'static str>],
    /// The most control points that may be drawn: many times as many as are written.
    pub(super) most_points: usize,
    pub(super) others: &'a dyn Others,
}

/// Finds what constructions draw of other objects, which they name.
pub(super) trait Others {
    /// An object's surfaces, in their places, for the object `drawn` that draws them.
    fn surfaces_of(&self, drawn: &str, of: &Written<String>) -> Result<Vec<Surface>, SceneError>;

    /// An object's control nets, in their places. Limit surfaces are not made for that, as their
    /// nets are their cages after some steps; `blamed` gives the error of those its place.
    fn nets_of(
        &self,
        drawn: &str,
        of: &Written<String>,
        steps: usize,
        blamed: &dyn Fn(DrawError) -> SceneError,
    ) -> Result<Vec<ControlNet>, SceneError>;
}

impl Workshop<'_> {
    /// Makes the surfaces of a construction. An error about one of its curves or numbers is placed
    /// where that was written.
    pub(super) fn make(&self, what: &Construction) -> Result<Vec<Made>, SceneError> {
        self.made(what).map_err(|error| match error.fault() {
            SceneFault::Construction { error: fault, .. } if error.place() == self.place => {
                let curves = what.curves();
                let curve = curves.iter().find(|(name, _)| fault.blames(name));
                let number = || self.written.iter().find(|one| Some(one.value) == key_of(fault));
                let place = curve.map(|(_, curve)| &curve.place);
                let place = place.or_else(|| number().map(|number| &number.place));
                SceneError::new(place.unwrap_or(self.place).clone(), error.fault().clone())
            }
            SceneFault::Drawing { error: fault, .. } if error.place() == self.place => {
                let number = self.written.iter().find(|one| Some(one.value) == fault.key());
                let place = number.map_or(self.place, |number| &number.place);
                SceneError::new(place.clone(), error.fault().clone())
            }
            _ => error,
        })
    }

    fn made(&self, what: &Construction) -> Result<Vec<Made>, SceneError> {
        let most_points = self.most_points;
        let pieces = match what {
            Construction::Revolution { profile, through, axis, degrees } => {
                let profile = self.curve("profile", profile)?;
                let axis = self.checked(Axis::new(*through, *axis))?;
                vec![self.checked(construct::revolve(&profile, &axis, *degrees))?.into()]
            }
            Construction::Extrusion { profile, by } => {
                let profile = self.curve("profile", profile)?;
                vec![self.checked(construct::extrude(&profile, *by))?.into()]
            }
            Construction::Ruled { from, to } => {
                let (from, to) = (self.curve("from", from)?, self.curve("to", to)?);
                vec![self.checked(construct::ruled(&from, &to))?.into()]
            }
            Construction::Coons(borders) => {
                vec![self.checked(construct::coons(&self.borders(borders)?))?.into()]
            }
            Construction::Loft { sections, degree } => {
                let sections = self.sections(sections)?;
                let highest = sections.len().saturating_sub(1).clamp(1, construct::LOFT_DEGREE);
                let degree = degree.unwrap_or(highest);
                vec![self.checked(construct::loft(&sections, degree))?.surface.into()]
            }
            Construction::MatrixForm { form, geometry } => {
                vec![self.patch(matrix_surface(*form, geometry))?]
            }
            Construction::Power { coefficients, denominator, domain } => {
                vec![self.patch(NurbsSurface::from_powers(coefficients, denominator, *domain))?]
            }
            Construction::Sweep { profile, path, options } => {
                let profile = self.curve("profile", profile)?;
                let path = self.curve("path", path)?;
                let Sweep { surface, deviation } =
                    self.checked(construct::sweep(&profile, &path, options))?;
                vec![Made { name: String::new(), surface: surface.into(), deviation }]
            }
            Construction::Tube { curve, style } => {
                let curve = self.curve("curve", curve)?;
                numbered(self.checked(construct::tube(&curve, style))?)
            }
            Construction::Ribbon { curve, style } => {
                let curve = self.curve("curve", curve)?;
                numbered(self.checked(construct::ribbon(&curve, style))?)
            }
            Construction::Polygon { curve, style } => {
                let curve = self.curve("curve", curve)?;
                let net = ControlNet::from(&curve);
                numbered(self.checked(construct::control_net(&net, style))?)
            }
            Construction::Net { of, steps, style } => {
                let blamed = |error| self.not_drawn(error);
                let nets = self.others.nets_of(self.surface, of, *steps, &blamed)?;
                numbered(self.drawn(control_nets(&nets, style, most_points))?)
            }
            Construction::TrimCurves { of, style } => {
                let surfaces = self.others.surfaces_of(self.surface, of)?;
                numbered(self.drawn(trim_curves(&surfaces, style, most_points))?)
            }
            Construction::IsoCurves { of, u, v, w, style } => {
                let surfaces = self.others.surfaces_of(self.surface, of)?;
                let lines = iso_lines([u, v, w]);
                numbered(self.drawn(iso_curves(&surfaces, &lines, style, most_points))?)
            }
        };
        Ok(pieces)
    }

    fn borders(&self, [u0, u1, v0, v1]: &[CurveSpec; 4]) -> Result<Borders, SceneError> {
        Ok(Borders {
            u0: self.curve("border u0", u0)?,
            u1: self.curve("border u1", u1)?,
            v0: self.curve("border v0", v0)?,
            v1: self.curve("border v1", v1)?,
        })
    }

    fn sections(&self, sections: &[CurveSpec]) -> Result<Vec<NurbsCurve>, SceneError> {
        let numbered = sections.iter().enumerate();
        numbered.map(|(index, curve)| self.curve(&format!("section {index}"), curve)).collect()
    }

    /// The curve written under a key.
    fn curve(&self, key: &str, curve: &CurveSpec) -> Result<NurbsCurve, SceneError> {
        let surface = self.surface.to_owned();
        curve.curve().map_err(|fault| match fault {
            CurveFault::Curve(place, error) => {
                let error = ConstructError::Curve { which: key.to_owned(), error };
                SceneError::new(place, SceneFault::Construction { surface, error })
            }
            CurveFault::Transform(place, error) => {
                let object = format!("{surface}, {key}");
                SceneError::new(place, SceneFault::Transform { object, error })
            }
        })
    }

    /// Passes on what was made, or gives the error its place.
    fn checked<T>(&self, made: Result<T, ConstructError>) -> Result<T, SceneError> {
        made.map_err(|error| self.blamed(error))
    }

    /// Passes on what was drawn, or gives the error its place.
    fn drawn<T>(&self, made: Result<T, DrawError>) -> Result<T, SceneError> {
        made.map_err(|error| self.not_drawn(error))
    }

    /// Passes on a patch that was made from numbers alone, or gives the error the place of those
    /// that are at fault.
    fn patch(&self, made: Result<NurbsSurface, SurfaceError>) -> Result<Made, SceneError> {
        made.map(Made::from).map_err(|error| {
            let written = |key: &&str| self.written.iter().find(|number| number.value == *key);
            let number = keys_of_patch(&error).iter().find_map(written);
            let place = number.map_or(self.place, |number| &number.place).clone();
            SceneError::new(place, SceneFault::Surface { surface: self.surface.to_owned(), error })
        })
    }

    fn not_drawn(&self, error: DrawError) -> SceneError {
        let surface = self.surface.to_owned();
        match error {
            DrawError::Construct(error) => self.blamed(error),
            error => SceneError::new(self.place.clone(), SceneFault::Drawing { surface, error }),
        }
    }

    fn blamed(&self, error: ConstructError) -> SceneError {
        let surface = self.surface.to_owned();
        SceneError::new(self.place.clone(), SceneFault::Construction { surface, error })
    }
}

/// The key of the number that is at fault, if that has a key.
fn key_of(error: &ConstructError) -> Option<&'static str> {
    Some(match error {
        ConstructError::Line { error, .. } => return key_of(error),
        ConstructError::Angle { .. } => "degrees",
        ConstructError::Direction { what: DirectionOf::Extrusion, .. } => "by",
        ConstructError::Direction { what: DirectionOf::Axis, .. } => "axis",
        ConstructError::Direction { what: DirectionOf::Up, .. } | ConstructError::Up { .. } => "up",
        ConstructError::Point { .. } | ConstructError::FarAxis { .. } => "through",
        ConstructError::DegreeAcross { .. } | ConstructError::Sections { .. } => "degree",
        ConstructError::Scale { .. }
        | ConstructError::NoScale
        | ConstructError::ScaleCount { .. } => "scale",
        ConstructError::Twist { .. } => "twist",
        ConstructError::Tolerance { .. } | ConstructError::NotHeld { .. } => "tolerance",
        ConstructError::Width { .. } => "width",
        ConstructError::JointRadius { .. } => "joints",
        ConstructError::Curve {
            error: CurveError::Radius { .. } | CurveError::RadiusRange { .. },
            ..
        } => "radius",
        _ => return None,
    })
}

/// The keys that the numbers of a patch that are at fault may have, the likeliest first.
fn keys_of_patch(error: &SurfaceError) -> &'static [&'static str] {
    match error {
        SurfaceError::Denominator { .. } | SurfaceError::Weight { .. } => {
            &["denominator", "coefficients"]
        }
        SurfaceError::Knots { error: KnotError::Degree { .. }, .. } => &["coefficients"],
        SurfaceError::Knots { .. } | SurfaceError::Domain { .. } => &["domain"],
        _ => &["geometry", "coefficients"],
    }
}

/// Names the pieces: what each is, with a number where there are several.
fn numbered(pieces: Vec<Component>) -> Vec<Made> {
    let mut totals: HashMap<ComponentKind, usize> = HashMap::new();
    for piece in &pieces {
        *totals.entry(piece.kind).or_default() += 1;
    }
    let only = pieces.len() == 1;
    let mut counts: HashMap<ComponentKind, usize> = HashMap::new();
    pieces
        .into_iter()
        .map(|Component { kind, surface, deviation }| {
            let count = counts.entry(kind).or_default();
            *count += 1;
            let name = match totals[&kind] {
                _ if only => String::new(),
                1 => kind.to_string(),
                _ => format!("{kind} {count}"),
            };
            Made { name, surface: surface.into(), deviation }
        })
        .collect()
}
