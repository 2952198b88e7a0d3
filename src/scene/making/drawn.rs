//! Drawings of another object's surfaces: control nets, trim edges, lines of constant parameter.
//! Whatever several of them share is drawn once.

use std::borrow::Cow;

use glam::DVec3;

use crate::geometry::construct::{
    Component, ConstructError, ControlNet, Drawing, NetStyle, Tightest, TubeStyle,
};
use crate::geometry::{
    Cage, CurveError, Direction, LimitSurface, NurbsCurve, Surface, TriangleSide,
};
use crate::math::Shown;
use crate::scene::errors::DrawError;
use crate::scene::written::{Scheme, Subdivision};

/// A drawing with a limit on its control points.
struct Drawn {
    drawing: Drawing,
    most_points: usize,
    tightest: Tightest,
}

impl Drawn {
    /// A drawing, still empty, of lines that lie among these points.
    fn among(
        points: impl IntoIterator<Item = DVec3>,
        style: TubeStyle,
        most_points: usize,
    ) -> Self {
        let drawing = Drawing::among(points, style);
        Self { drawing, most_points, tightest: Tightest::default() }
    }

    fn of_surfaces(surfaces: &[Surface], style: TubeStyle, most_points: usize) -> Self {
        let points = surfaces.iter().flat_map(|surface| surface.control_net().points);
        Self::among(points, style, most_points)
    }

    /// Adds a tube along a line, which errors call `line`. If the tube folds, other lines may be
    /// bent more, so that error is reported at the end.
    fn tube(&mut self, curve: &NurbsCurve, line: impl FnOnce() -> String) -> Result<(), DrawError> {
        let made = self.drawing.tube(curve);
        let told = made.map_err(|error| in_line(line(), error));
        self.tightest.sift(told)?;
        self.check(self.drawing.point_count())
    }

    fn check(&self, points: usize) -> Result<(), DrawError> {
        if points > self.most_points {
            return Err(DrawError::LargeDrawing { limit: self.most_points });
        }
        Ok(())
    }

    fn pieces(self) -> Result<Vec<Component>, DrawError> {
        self.tightest.check()?;
        Ok(self.drawing.pieces()?)
    }
}

/// Makes an error one about this line, unless it is about numbers that all lines have in common.
fn in_line(line: String, error: ConstructError) -> ConstructError {
    match error {
        ConstructError::Curve {
            error: CurveError::Radius { .. } | CurveError::RadiusRange { .. },
            ..
        }
        | ConstructError::Tolerance { .. } => error,
        error => ConstructError::Line { line, error: Box::new(error) },
    }
}

/// The name in errors of something on one of `count` surfaces: `what` alone if there is only one.
fn on_surface(surface: usize, count: usize, what: &str) -> String {
    if count == 1 { what.to_owned() } else { format!("surface {surface}, {what}") }
}

/// More steps than these bring any cage beyond what can be drawn, if it grows at all.
const MOST_STEPS: usize = 16;

impl Subdivision {
    /// The cage after this many steps of the scheme.
    ///
    /// # Errors
    /// When there are more steps than any cage that grows can take, or a cage on the way has more
    /// vertices than can be drawn: after the first few, each step makes about four times as many.
    pub(super) fn cage_after(&self, steps: usize) -> Result<Cow<'_, Cage>, DrawError> {
        if steps > MOST_STEPS {
            return Err(DrawError::Steps { steps, most: MOST_STEPS });
        }
        let mut cage = Cow::Borrowed(&*self.cage);
        for after in 0..steps {
            let (count, limit) = (cage.positions().len(), NetStyle::MAX_POINTS);
            if count > limit {
                return Err(DrawError::LargeCage { after, steps, count, limit });
            }
            cage = Cow::Owned(match self.scheme {
                Scheme::CatmullClark => cage.refined_catmull_clark(),
                Scheme::DooSabin => cage.refined_doo_sabin(),
            });
        }
        Ok(cage)
    }
}

/// Control nets as cylinders and balls.
pub(super) fn control_nets(
    nets: &[ControlNet],
    style: &NetStyle,
    most_points: usize,
) -> Result<Vec<Component>, DrawError> {
    let points = nets.iter().flat_map(|net| net.points.iter().copied());
    let mut drawn = Drawn::among(points, style.lines(), most_points);
    for (index, net) in nets.iter().enumerate() {
        drawn.drawing.net(net, style.joints).map_err(|error| match nets.len() {
            1 => error,
            _ => in_line(format!("surface {index}"), error),
        })?;
        drawn.check(drawn.drawing.point_count())?;
    }
    drawn.pieces()
}

/// Trim edges as tubes.
pub(super) fn trim_curves(
    surfaces: &[Surface],
    style: &TubeStyle,
    most_points: usize,
) -> Result<Vec<Component>, DrawError> {
    let of_each = surfaces.iter().map(Surface::trimmed);
    let trimmed: Vec<_> =
        of_each.enumerate().filter_map(|(index, one)| Some((index, one?))).collect();
    if trimmed.is_empty() {
        return Err(DrawError::NoTrims);
    }
    let mut drawn = Drawn::of_surfaces(surfaces, *style, most_points);
    let mut is_cut = false;
    for (index, surface) in trimmed {
        // Edges are lifted onto the surface's Bézier pieces, all of which are made for that.
        drawn.check(surface.surface().bezier_point_count())?;
        let edges = surface.edge_curves().map_err(DrawError::TrimEdge)?;
        is_cut |= !edges.is_empty();
        for (number, edge) in edges.iter().enumerate() {
            drawn
                .tube(edge, || on_surface(index, surfaces.len(), &format!("trim edge {number}")))?;
        }
    }
    if !is_cut {
        return Err(DrawError::NoTrimEdges);
    }
    drawn.pieces()
}

/// The parameter that is constant along a line, and its value.
type IsoLine = (TriangleSide, f64);

/// The lines of constant u, v and w at these values.
pub(super) fn iso_lines([u, v, w]: [&[f64]; 3]) -> Vec<IsoLine> {
    let all = [(TriangleSide::U, u), (TriangleSide::V, v), (TriangleSide::W, w)];
    all.into_iter().flat_map(|(fixed, at)| at.iter().map(move |&t| (fixed, t))).collect()
}

/// Curves of constant parameter as tubes, where trims keep them. Those that are only a point, at
/// poles and corners, show nothing; but each line asked for must show something on one of the
/// surfaces.
pub(super) fn iso_curves(
    surfaces: &[Surface],
    lines: &[IsoLine],
    style: &TubeStyle,
    most_points: usize,
) -> Result<Vec<Component>, DrawError> {
    if lines.is_empty() {
        return Err(DrawError::NoIsoLines);
    }
    let mut drawn = Drawn::of_surfaces(surfaces, *style, most_points);
    // What has been found of each line so far.
    let mut found = vec![Found::Nothing; lines.len()];
    for (index, surface) in surfaces.iter().enumerate() {
        for (&(fixed, t), found) in lines.iter().zip(&mut found) {
            for curve in iso_curve(surface, fixed, t)? {
                if curve.is_point() {
                    *found = (*found).max(Found::Point);
                } else {
                    *found = Found::Curve;
                    let line = format!("{fixed} = {}", Shown(t));
                    drawn.tube(&curve, || on_surface(index, surfaces.len(), &line))?;
                }
            }
        }
    }
    for (&(parameter, t), found) in lines.iter().zip(found) {
        match found {
            Found::Nothing => return Err(DrawError::IsoCut { parameter, t }),
            Found::Point => return Err(DrawError::IsoPoint { parameter, t }),
            Found::Curve => {}
        }
    }
    drawn.pieces()
}

/// The parts of one line of constant parameter that are kept on a surface.
fn iso_curve(surface: &Surface, fixed: TriangleSide, t: f64) -> Result<Vec<NurbsCurve>, DrawError> {
    let direction = match fixed {
        TriangleSide::U => Some(Direction::U),
        TriangleSide::V => Some(Direction::V),
        TriangleSide::W => None,
    };
    let curves = match (surface, direction) {
        (Surface::Triangle(patch), _) => {
            let curve = patch.curve_at(fixed, t).map(|curve| vec![curve]);
            return curve.ok_or(DrawError::IsoOff { parameter: fixed, t, end: 1 });
        }
        (Surface::Limit(surface), Some(direction)) => return limit_curves(surface, direction, t),
        (Surface::Nurbs(surface), Some(fixed)) => surface.curve_at(fixed, t).map(|c| vec![c]),
        (Surface::Trimmed(surface), Some(direction)) => surface.kept_curves(direction, t),
        (_, None) => return Err(DrawError::NoW { kind: surface.kind() }),
    };
    curves.map_err(DrawError::Iso)
}

/// A line of constant parameter of a subdivision surface: of constant `u` in one of its unit
/// squares, of constant `v` in all of them.
fn limit_curves(
    surface: &LimitSurface,
    direction: Direction,
    t: f64,
) -> Result<Vec<NurbsCurve>, DrawError> {
    let (parameter, end) = match direction {
        Direction::U => (TriangleSide::U, surface.unit_count()),
        Direction::V => (TriangleSide::V, 1),
    };
    let within = (0.0..=end as f64).contains(&t); // false for NaN
    if !within {
        return Err(DrawError::IsoOff { parameter, t, end });
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
