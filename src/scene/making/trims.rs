//! Trims as written, checked and made.

use std::borrow::Cow;

use glam::DVec2;

use crate::geometry::trim::{
    Coverage, Kept, Side, TrimCurve, TrimDomain, TrimError, TrimLoop, TrimLoopError, Trims,
    tolerated_overlap,
};
use crate::geometry::{NurbsCurve, NurbsSurface, TrimmedSurface};
use crate::scene::errors::{SceneError, SceneFault, TrimCurveFault};
use crate::scene::written::{
    CurveFault, CurveKind, CurveSpec, Knots, LoopKind, LoopSense, LoopSpec, Place, TrimSpec,
    Written,
};

/// The width of the strip along a domain's border in which kept parts do not count, as a share of
/// the domain's sides.
const BORDER: f64 = 1e-9;

/// How often a loop is looked at for points that are clear of another one, each time a quarter as
/// far: from a tolerated overlap down to rounding.
const LOOKS: usize = 20;

impl TrimSpec {
    /// The number of control points written.
    pub fn point_count(&self) -> usize {
        let count = |one: &LoopSpec| match &one.kind {
            LoopKind::Polygon(corners) => corners.len(),
            LoopKind::Circle { .. } => 0,
            LoopKind::Curves(curves) => {
                curves.iter().map(CurveSpec::point_count).fold(0, usize::saturating_add)
            }
        };
        self.loops.iter().map(count).fold(0, usize::saturating_add)
    }

    /// The surface with these trims; errors call it `name`.
    pub(super) fn trimmed(
        &self,
        name: &str,
        surface: NurbsSurface,
    ) -> Result<TrimmedSurface, SceneError> {
        let fails = |error| {
            let fault = SceneFault::Trims { surface: name.to_owned(), error };
            SceneError::new(self.place.clone(), fault)
        };
        let domain = TrimDomain::with_seams_of(&surface).map_err(fails)?;
        let loops = self.loops.iter().enumerate();
        let loops = loops.map(|(index, one)| one.trim_loop(name, index, domain));
        let loops = loops.collect::<Result<Vec<_>, _>>()?;
        let trims = Trims::new(domain, self.kept, &loops).map_err(|error| {
            let place = self.place_of(&error).clone();
            SceneError::new(place, SceneFault::Trims { surface: name.to_owned(), error })
        })?;
        self.check_senses(name, domain, &loops)?;
        // Where a surface is cut off up to a border, the border itself counts as kept, as it is an
        // edge; but it shows nothing.
        let bounds = domain.bounds();
        let inner = bounds.grown(-BORDER * (bounds.max - bounds.min));
        if trims.classify(&inner) == Coverage::Outside {
            let fault = SceneFault::NothingKept { surface: name.to_owned() };
            return Err(SceneError::new(self.place.clone(), fault));
        }
        TrimmedSurface::new(surface, trims).map_err(fails)
    }

    /// Checks that loops are what they are said to be, given how many others lie around each.
    fn check_senses(
        &self,
        name: &str,
        domain: TrimDomain,
        loops: &[TrimLoop],
    ) -> Result<(), SceneError> {
        if self.loops.iter().all(|one| one.sense.is_none()) {
            return Ok(());
        }
        let alone =
            loops.iter().map(|one| Trims::new(domain, Kept::Odd, std::slice::from_ref(one)));
        let Ok(alone) = alone.collect::<Result<Vec<Trims>, _>>() else { return Ok(()) };
        for (index, (one, trims)) in self.loops.iter().zip(&alone).enumerate() {
            let points: Vec<DVec2> = trims.joints().chain(trims.middles()).collect();
            let is_around = |(other, trims): &(usize, &Trims)| {
                let overlap = tolerated_overlap(&domain, &loops[index], &loops[*other]);
                lies_in(&points, trims, overlap)
            };
            let others = alone.iter().enumerate().filter(|(other, _)| *other != index);
            let around = others.filter(is_around).count();
            let outlines = (around % 2 == 0) == (self.kept == Kept::Odd);
            let found = if outlines { LoopSense::Outline } else { LoopSense::Hole };
            if let Some(said) = one.sense.filter(|said| *said != found) {
                let (surface, trim_loop) = (name.to_owned(), index);
                let fault = SceneFault::TrimSense { surface, trim_loop, said, found, around };
                return Err(SceneError::new(one.place.clone(), fault));
            }
        }
        Ok(())
    }

    /// Where the loop that an error is about was written; of two loops, the later one.
    fn place_of(&self, error: &TrimError) -> &Place {
        let index = match error {
            TrimError::Loop { index, .. }
            | TrimError::OutsideDomain { index, .. }
            | TrimError::TooFar { index, .. }
            | TrimError::TooManyPeriods { index, .. }
            | TrimError::SelfCrossing { index, .. }
            | TrimError::CopyCrossing { index, .. } => Some(*index),
            TrimError::Crossing { loops, .. } | TrimError::Coincident { loops } => {
                loops.iter().copied().max()
            }
            TrimError::Domain { .. }
            | TrimError::OtherDomain { .. }
            | TrimError::NoLoops
            | TrimError::TooManySegments { .. }
            | TrimError::Entangled { .. }
            | TrimError::Tolerance { .. } => None,
        };
        index.and_then(|index| self.loops.get(index)).map_or(&self.place, |one| &one.place)
    }
}

/// Whether a loop through these points lies in the only loop of some trims.
///
/// Loops may touch, and overlap a little where they do: a point clear of that decides. A loop so
/// narrow that it has none is decided by the points that are as clear as any.
fn lies_in(points: &[DVec2], other: &Trims, overlap: DVec2) -> bool {
    let reaches = std::iter::successors(Some(overlap), |reach| Some(0.25 * *reach));
    let mut sides = reaches.take(LOOKS).flat_map(|reach| {
        points.iter().filter_map(move |&point| match other.side_within(point, reach) {
            Side::Inside => Some(true),
            Side::Outside => Some(false),
            Side::Edge { .. } => None,
        })
    });
    sides.next() == Some(true)
}

impl LoopSpec {
    fn trim_loop(
        &self,
        name: &str,
        index: usize,
        domain: TrimDomain,
    ) -> Result<TrimLoop, SceneError> {
        let made = match &self.kind {
            LoopKind::Polygon(corners) => TrimLoop::polygon(corners),
            LoopKind::Circle { center, radius } => TrimLoop::circle(*center, *radius),
            LoopKind::Curves(curves) => {
                let made = curves.iter().enumerate();
                let made = made.map(|(at, curve)| trim_curve(name, [index, at], curve));
                TrimLoop::on(&domain, &made.collect::<Result<Vec<_>, _>>()?)
            }
        };
        made.map_err(|error| {
            let place = match (&error, &self.kind) {
                (TrimLoopError::Open { next, .. }, LoopKind::Curves(curves)) => {
                    curves.get(*next).map_or(&self.place, |curve| &curve.place)
                }
                _ => &self.place,
            };
            let error = TrimError::Loop { index, error: domain.explained(error) };
            let surface = name.to_owned();
            SceneError::new(place.clone(), SceneFault::Trims { surface, error })
        })
    }
}

/// Curve `at` of loop `index`.
fn trim_curve(name: &str, at: [usize; 2], curve: &CurveSpec) -> Result<TrimCurve, SceneError> {
    let made = loop_curve(name, at, curve)?;
    TrimCurve::nurbs(&made).map_err(|error| trim_curve_error(name, at, &curve.place, error.into()))
}

/// Curve `at` of loop `index`, in (u, v) and 0.
pub(in crate::scene) fn loop_curve(
    name: &str,
    [index, at]: [usize; 2],
    curve: &CurveSpec,
) -> Result<NurbsCurve, SceneError> {
    on_even_knots(curve).curve().map_err(|fault| match fault {
        CurveFault::Curve(place, error) => {
            trim_curve_error(name, [index, at], &place, error.into())
        }
        CurveFault::Transform(place, error) => {
            let object = format!("{name}, loop {index}, curve {at}");
            SceneError::new(place, SceneFault::Transform { object, error })
        }
    })
}

/// The error of curve `at` of loop `index`.
pub(in crate::scene) fn trim_curve_error(
    name: &str,
    [trim_loop, curve]: [usize; 2],
    place: &Place,
    error: TrimCurveFault,
) -> SceneError {
    let fault = SceneFault::TrimCurve { surface: name.to_owned(), trim_loop, curve, error };
    SceneError::new(place.clone(), fault)
}

/// The same curve, a polyline with evenly spaced knots. Its own parameter, the arc length, needs
/// points that differ, and trims need no parameter: files written by modelling programs have loops
/// with sides of length zero, at poles of the surface. Those are dropped like the sides of a
/// [`LoopKind::Polygon`] whose corners are repeated.
fn on_even_knots(curve: &CurveSpec) -> Cow<'_, CurveSpec> {
    let CurveKind::Polyline(points) = &curve.kind else { return Cow::Borrowed(curve) };
    if points.len() < 2 {
        return Cow::Borrowed(curve);
    }
    let knots = Written { value: Knots::Uniform, place: curve.place.clone() };
    let kind = CurveKind::Nurbs { degree: 1.into(), knots, points: points.clone(), weights: None };
    Cow::Owned(CurveSpec { kind, ..curve.clone() })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::shapes;

    fn polyline(points: &[[f64; 2]]) -> CurveSpec {
        let points = points.iter().map(|&[u, v]| DVec3::new(u, v, 0.0)).collect();
        let kind = CurveKind::Polyline(points);
        CurveSpec { place: Place::default(), kind, transform: Vec::new(), reverse: false }
    }

    /// A triangle with a corner twice, and with a side of length zero, is the triangle.
    #[test]
    fn sides_of_length_zero_are_dropped() {
        let [a, b, c] = [[0.1, 0.1], [0.9, 0.1], [0.5, 0.5]];
        let loops: [&[&[[f64; 2]]]; 5] = [
            &[&[a, b, c, a]],
            &[&[a, b, b, b, c], &[c, a, a]],
            &[&[a, b, c], &[c, c], &[c, a]],
            &[&[a, a, a], &[a, b, c, a]],
            // The length up to the second corner rounds the distance to the next one away.
            &[&[a, b, [0.9, 0.1_f64.next_up()], c, a]],
        ];
        for points in loops {
            let curves: Vec<CurveSpec> = points.iter().map(|points| polyline(points)).collect();
            // As they were written, they are drawn.
            for (at, (points, curve)) in points.iter().zip(&curves).enumerate() {
                let drawn = loop_curve("plane", [0, at], curve).unwrap();
                let drawn: Vec<[f64; 2]> = drawn.points().map(|p| [p.x, p.y]).collect();
                assert_eq!(&drawn, points);
            }
            let place = Place::default();
            let one =
                LoopSpec { place: place.clone(), kind: LoopKind::Curves(curves), sense: None };
            let trims = TrimSpec { place, kept: Kept::Odd, loops: vec![one] };
            let made = trims.trimmed("plane", shapes::cylinder(1.0, 1.0).unwrap()).unwrap();
            let corners: Vec<DVec2> = made.trims().joints().collect();
            assert!(
                [a, b, c].iter().all(|&corner| corners.contains(&corner.into())),
                "{corners:?}"
            );
            assert_eq!(made.trims().side_of(DVec2::new(0.5, 0.3)), Side::Inside);
            assert_eq!(made.trims().side_of(DVec2::new(0.5, 0.6)), Side::Outside);
        }
    }

    #[test]
    fn a_polyline_needs_two_points_all_the_same() {
        let alone = trim_curve("plane", [0, 0], &polyline(&[[0.1, 0.1]])).unwrap_err();
        assert!(alone.to_string().contains("plane"), "{alone}");
    }
}
