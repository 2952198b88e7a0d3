//! Where the surfaces of constructions are made.

use std::collections::{HashMap, HashSet};

use super::curve::CurveFault;
use super::placing::Placer;
use super::{Construction, CurveSpec, Place, SceneError, SceneFault, Written};
use crate::geometry::construct::{
    self, Axis, Borders, ConstructError, ControlNet, NetStyle, Piece, Sweep, TubeStyle,
};
use crate::geometry::{CurveError, Direction, LimitSurface, NurbsCurve, Surface, TriangleSide};

/// A surface made, and how far it is from what was asked for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Made {
    /// What it is called within its object; may be empty.
    pub(super) name: String,
    pub(super) surface: Surface,
    /// A bound of the distance in space; 0 where it is exact.
    pub(super) deviation: f64,
}

impl<S: Into<Surface>> From<S> for Made {
    /// A surface that is exactly what was asked for, the only one.
    fn from(surface: S) -> Self {
        Self { name: String::new(), surface: surface.into(), deviation: 0.0 }
    }
}

/// Makes the surfaces of one part: knows what errors should call it, and where it stands.
pub(super) struct Workshop<'a> {
    /// The surface's name.
    pub(super) surface: &'a str,
    /// Where the construction was written.
    pub(super) place: &'a Place,
    /// Where its numbers were written, by their keys.
    pub(super) written: &'a [Written<&'static str>],
    /// Finds other objects' surfaces.
    pub(super) placer: &'a Placer<'a>,
}

impl Workshop<'_> {
    /// The surfaces of a construction. What is wrong with one of its curves or numbers is told
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
            _ => error,
        })
    }

    fn made(&self, what: &Construction) -> Result<Vec<Made>, SceneError> {
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
                let [u0, u1, v0, v1] = &**borders;
                let borders = Borders {
                    u0: self.curve("border u0", u0)?,
                    u1: self.curve("border u1", u1)?,
                    v0: self.curve("border v0", v0)?,
                    v1: self.curve("border v1", v1)?,
                };
                vec![self.checked(construct::coons(&borders))?.into()]
            }
            Construction::Loft { sections, degree } => {
                let made = sections.iter().enumerate();
                let made =
                    made.map(|(index, curve)| self.curve(&format!("section {index}"), curve));
                let made = made.collect::<Result<Vec<_>, _>>()?;
                let highest = made.len().saturating_sub(1).clamp(1, construct::LOFT_DEGREE);
                let degree = degree.unwrap_or(highest);
                vec![self.checked(construct::loft(&made, degree))?.surface.into()]
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
            Construction::Net { of, style } => {
                let nets = self.placer.nets_of(self.surface, of)?;
                numbered(self.checked(control_nets(&nets, style, self.drawing()))?)
            }
            Construction::TrimCurves { of, style } => {
                let surfaces = self.placer.surfaces_of(self.surface, of)?;
                numbered(self.checked(trim_curves(&surfaces, style, self.drawing()))?)
            }
            Construction::IsoCurves { of, u, v, w, style } => {
                let surfaces = self.placer.surfaces_of(self.surface, of)?;
                numbered(self.checked(iso_curves(&surfaces, [u, v, w], style, self.drawing()))?)
            }
        };
        Ok(pieces)
    }

    /// Nothing drawn yet.
    fn drawing(&self) -> Drawing {
        Drawing { pieces: Vec::new(), points: 0, most_points: self.placer.most_points }
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

    /// What was made, or why not.
    fn checked<T>(&self, made: Result<T, ConstructError>) -> Result<T, SceneError> {
        made.map_err(|error| {
            let surface = self.surface.to_owned();
            SceneError::new(self.place.clone(), SceneFault::Construction { surface, error })
        })
    }
}

/// The key of the number that is at fault, if it is one that has a key.
fn key_of(error: &ConstructError) -> Option<&'static str> {
    Some(match error {
        ConstructError::Angle { .. } => "degrees",
        ConstructError::Direction { what: "extrusion by", .. } => "by",
        ConstructError::Direction { what: "direction of the axis", .. } => "axis",
        ConstructError::Direction { what: "up", .. } | ConstructError::Up { .. } => "up",
        ConstructError::Point { .. } | ConstructError::FarAxis { .. } => "through",
        ConstructError::DegreeAcross { .. } | ConstructError::Sections { .. } => "degree",
        ConstructError::Scale { .. }
        | ConstructError::NoScale
        | ConstructError::ScaleCount { .. } => "scale",
        ConstructError::Twist { .. } => "twist",
        ConstructError::Tolerance { .. } | ConstructError::NotHeld { .. } => "tolerance",
        ConstructError::Width { .. } => "width",
        ConstructError::Radius { what: "joint", .. } => "joints",
        ConstructError::Curve {
            error: CurveError::Radius { .. } | CurveError::RadiusRange { .. },
            ..
        } => "radius",
        ConstructError::IsoOff { parameter, .. }
        | ConstructError::IsoCut { parameter, .. }
        | ConstructError::IsoPoint { parameter, .. } => match parameter {
            'u' => "u",
            'v' => "v",
            _ => "w",
        },
        ConstructError::NoW { .. } => "w",
        _ => return None,
    })
}

/// What is drawn of another object's surfaces, as long as it is not too much.
struct Drawing {
    pieces: Vec<Piece>,
    /// Their control points.
    points: usize,
    most_points: usize,
}

impl Drawing {
    fn add(&mut self, pieces: Vec<Piece>) -> Result<(), ConstructError> {
        self.points += pieces.iter().map(|piece| piece.surface.control().len()).sum::<usize>();
        self.check(self.points)?;
        self.pieces.extend(pieces);
        Ok(())
    }

    fn check(&self, points: usize) -> Result<(), ConstructError> {
        if points > self.most_points {
            return Err(ConstructError::LargeDrawing { limit: self.most_points });
        }
        Ok(())
    }
}

/// Control nets as cylinders and balls.
fn control_nets(
    nets: &[ControlNet],
    style: &NetStyle,
    mut drawing: Drawing,
) -> Result<Vec<Piece>, ConstructError> {
    for net in nets {
        drawing.add(construct::control_net(net, style)?)?;
    }
    Ok(drawing.pieces)
}

/// Trim edges as tubes.
fn trim_curves(
    surfaces: &[Surface],
    style: &TubeStyle,
    mut drawing: Drawing,
) -> Result<Vec<Piece>, ConstructError> {
    let mut trimmed = surfaces.iter().filter_map(Surface::trimmed).peekable();
    if trimmed.peek().is_none() {
        return Err(ConstructError::NoTrims);
    }
    for surface in trimmed {
        // Edges are lifted onto its Bézier pieces, all of which are made for that.
        drawing.check(surface.surface().bezier_point_count())?;
        for edge in surface.edge_curves().map_err(ConstructError::TrimEdge)? {
            drawing.add(construct::tube(&edge, style)?)?;
        }
    }
    Ok(drawing.pieces)
}

/// Curves of constant parameter as tubes, where trims keep them. Those that are only a point, at
/// poles and corners, show nothing; but each line asked for must show something on one of the
/// surfaces.
fn iso_curves(
    surfaces: &[Surface],
    [u, v, w]: [&Vec<f64>; 3],
    style: &TubeStyle,
    mut drawing: Drawing,
) -> Result<Vec<Piece>, ConstructError> {
    let all = [(TriangleSide::U, u), (TriangleSide::V, v), (TriangleSide::W, w)];
    let lines = all.into_iter().flat_map(|(fixed, at)| at.iter().map(move |&t| (fixed, t)));
    let lines: Vec<(TriangleSide, f64)> = lines.collect();
    if lines.is_empty() {
        return Err(ConstructError::NoIsoLines);
    }
    // What each line has come to so far.
    let mut found = vec![Found::Nothing; lines.len()];
    for surface in surfaces {
        for (&(fixed, t), found) in lines.iter().zip(&mut found) {
            for curve in iso_curve(surface, fixed, t)? {
                if curve.is_point() {
                    *found = (*found).max(Found::Point);
                } else {
                    *found = Found::Curve;
                    drawing.add(construct::tube(&curve, style)?)?;
                }
            }
        }
    }
    for ((fixed, t), found) in lines.into_iter().zip(found) {
        let parameter = parameter(fixed);
        match found {
            Found::Nothing => return Err(ConstructError::IsoCut { parameter, t }),
            Found::Point => return Err(ConstructError::IsoPoint { parameter, t }),
            Found::Curve => {}
        }
    }
    Ok(drawing.pieces)
}

/// What is kept of one line of constant parameter on a surface.
fn iso_curve(
    surface: &Surface,
    fixed: TriangleSide,
    t: f64,
) -> Result<Vec<NurbsCurve>, ConstructError> {
    let direction = match fixed {
        TriangleSide::U => Some(Direction::U),
        TriangleSide::V => Some(Direction::V),
        TriangleSide::W => None,
    };
    let curves = match (surface, direction) {
        (Surface::Triangle(patch), _) => {
            let curve = patch.curve_at(fixed, t).map(|curve| vec![curve]);
            return curve.ok_or(ConstructError::IsoOff { parameter: parameter(fixed), t, end: 1 });
        }
        (Surface::Limit(surface), Some(direction)) => return limit_curves(surface, direction, t),
        (Surface::Nurbs(surface), Some(Direction::U)) => surface.curve_at_u(t).map(|c| vec![c]),
        (Surface::Nurbs(surface), Some(Direction::V)) => surface.curve_at_v(t).map(|c| vec![c]),
        (Surface::Trimmed(surface), Some(direction)) => surface.kept_curves(direction, t),
        (_, None) => return Err(ConstructError::NoW { kind: surface.kind() }),
    };
    curves.map_err(ConstructError::Iso)
}

/// A line of constant parameter of a subdivision surface: of constant `u` in one of its unit
/// squares, of constant `v` in all of them.
fn limit_curves(
    surface: &LimitSurface,
    direction: Direction,
    t: f64,
) -> Result<Vec<NurbsCurve>, ConstructError> {
    let (parameter, end) = match direction {
        Direction::U => ('u', surface.unit_count()),
        Direction::V => ('v', 1),
    };
    let within = (0.0..=end as f64).contains(&t); // false for NaN
    if !within {
        return Err(ConstructError::IsoOff { parameter, t, end });
    }
    Ok(match direction {
        Direction::U => {
            let unit = (t as usize).min(end.saturating_sub(1));
            surface.unit_curves(unit, direction, t - unit as f64)
        }
        Direction::V => {
            let units = 0..surface.unit_count();
            units.flat_map(|unit| surface.unit_curves(unit, direction, t)).collect()
        }
    })
}

/// What a fixed parameter is called.
fn parameter(fixed: TriangleSide) -> char {
    match fixed {
        TriangleSide::U => 'u',
        TriangleSide::V => 'v',
        TriangleSide::W => 'w',
    }
}

/// What a line of constant parameter is on some surfaces.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Found {
    /// Trims keep nothing of it.
    Nothing,
    /// A point.
    Point,
    /// A curve.
    Curve,
}

/// The pieces under names of their own: what each is, with a number where there are several.
fn numbered(pieces: Vec<Piece>) -> Vec<Made> {
    let of = |what| pieces.iter().filter(|piece| piece.what == what).count();
    let several: HashSet<&str> = KINDS.into_iter().filter(|what| of(*what) > 1).collect();
    let only = pieces.len() == 1;
    let mut counts: HashMap<&str, usize> = HashMap::new();
    pieces
        .into_iter()
        .map(|Piece { what, surface, deviation }| {
            let count = counts.entry(what).or_default();
            *count += 1;
            let name = match several.contains(what) {
                _ if only => String::new(),
                true => format!("{what} {count}"),
                false => what.to_owned(),
            };
            Made { name, surface: surface.into(), deviation }
        })
        .collect()
}

/// What pieces may be.
const KINDS: [&str; 6] = ["tube", "joint", "cap", "ribbon", "line", "point"];
