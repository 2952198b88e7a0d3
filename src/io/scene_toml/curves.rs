//! Curves in a scene file, as `from_curves.md` shows them.

use glam::DVec3;
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use super::super::keyed::Keyed;
use super::forms::{PowerKeys, SegmentKeys};
use super::kinds::OneOf;
use super::knot_list::KnotList;
use super::transforms::TransformKeys;
use super::values::{Degree, Exactly, Number, Point, Whole};
use super::{LoadError, Reader};
use crate::geometry::is_usable_weight;
use crate::geometry::shapes::QuarticArc;
use crate::scene::{
    BSplineEnds, CurveKind, CurveSpec, Knots, Place, Transform, UnknownName, Written,
};

/// A curve's table.
pub(super) struct CurveKeys(CurveTable);

impl<'de> Deserialize<'de> for CurveKeys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Keyed::deserialize(deserializer).map(|Keyed(table)| Self(table))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CurveTable {
    nurbs: Option<Keyed<NurbsCurveKeys>>,
    #[serde(alias = "polygon")]
    polyline: Option<Vec<Point>>,
    bezier: Option<Vec<Point>>,
    through: Option<Keyed<ThroughKeys>>,
    bspline: Option<Keyed<BSplineKeys>>,
    catmull_rom: Option<Keyed<CatmullRomKeys>>,
    hermite: Option<Keyed<HermiteKeys>>,
    matrix_form: Option<Keyed<SegmentKeys>>,
    power: Option<Keyed<PowerKeys>>,
    circle: Option<Keyed<CircleKeys>>,
    arc: Option<Keyed<ArcKeys>>,
    note_circle: Option<Spanned<String>>,
    quarter_circle_2: Option<Keyed<QuadraticKeys>>,
    quarter_circle_4: Option<Keyed<QuarticKeys>>,
    #[serde(default)]
    transform: Vec<OneOf<TransformKeys>>,
    #[serde(default)]
    reverse: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NurbsCurveKeys {
    degree: Spanned<Degree>,
    knots: Option<Spanned<KnotList>>,
    points: Spanned<Vec<Point>>,
    weights: Option<Spanned<Vec<Spanned<Number>>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ThroughKeys {
    degree: Option<Degree>,
    points: Vec<Point>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BSplineKeys {
    degree: Option<Degree>,
    points: Vec<Point>,
    ends: Option<Spanned<[u32; 2]>>,
    #[serde(default)]
    closed: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CatmullRomKeys {
    points: Vec<Point>,
    #[serde(default)]
    closed: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HermiteKeys {
    points: Vec<Point>,
    derivatives: Vec<Point>,
}

/// The degree of a spline, if none is given.
const CUBIC: Degree = Whole(3);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CircleKeys {
    center: Option<Spanned<Point>>,
    radius: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ArcKeys {
    center: Option<Spanned<Point>>,
    radius: Number,
    from: Option<Number>,
    degrees: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct QuadraticKeys {
    weights: Exactly<Number, 3>,
}

/// A solution of the constraint for `w1`, or all constants.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct QuarticKeys {
    solution: Option<Spanned<u32>>,
    w1: Option<Number>,
    weights: Option<Exactly<Number, 2>>,
    y1: Option<Number>,
    x2: Option<Number>,
}

/// The kinds of curves, for messages.
const KINDS: &str = "nurbs, polyline, bezier, through, bspline, catmull_rom, hermite, matrix_form, \
                     power, circle, arc, note_circle, quarter_circle_2, quarter_circle_4";

impl Reader<'_, '_> {
    pub(super) fn curve(&self, keys: Spanned<CurveKeys>) -> Result<CurveSpec, LoadError> {
        let place = self.source.place(keys.span().start);
        let CurveKeys(keys) = keys.into_inner();
        let points = |points: Vec<Point>| points.into_iter().map(|point| point.0).collect();
        // A centre is short for the first step of the transform.
        let mut transform = Vec::new();
        let mut arc = |center: Option<Spanned<Point>>, radius: Number, from, degrees| {
            let step = |center: Point| Transform::Translate(center.0);
            transform.extend(center.map(|center| self.written(center, step)));
            CurveKind::Arc { radius: radius.0, from, degrees }
        };
        let kinds = [
            keys.nurbs.map(|Keyed(keys)| self.nurbs_curve(keys)),
            keys.polyline.map(|list| CurveKind::Polyline(points(list))),
            keys.bezier.map(|list| CurveKind::Bezier(points(list))),
            keys.through.map(|Keyed(keys)| CurveKind::Through {
                points: points(keys.points),
                degree: keys.degree.unwrap_or(CUBIC).0 as usize,
            }),
            keys.bspline.map(|Keyed(keys)| self.bspline(keys)).transpose()?,
            keys.catmull_rom.map(|Keyed(keys)| CurveKind::CatmullRom {
                points: points(keys.points),
                closed: keys.closed,
            }),
            keys.hermite.map(|Keyed(keys)| CurveKind::Hermite {
                points: points(keys.points),
                derivatives: points(keys.derivatives),
            }),
            keys.matrix_form.map(|Keyed(keys)| self.segment(keys)),
            keys.power.map(|Keyed(keys)| self.power(keys)),
            keys.circle.map(|Keyed(keys)| arc(keys.center, keys.radius, 0.0, 360.0)),
            keys.arc.map(|Keyed(keys)| {
                let from = keys.from.map_or(0.0, |from| from.0);
                arc(keys.center, keys.radius, from, keys.degrees.0)
            }),
            keys.note_circle.map(|name| self.note_circle(name)).transpose()?,
            keys.quarter_circle_2
                .map(|Keyed(keys)| CurveKind::QuadraticArc(keys.weights.0.map(|weight| weight.0))),
            keys.quarter_circle_4.map(|Keyed(keys)| self.quartic(&place, keys)).transpose()?,
        ];
        let mut given = kinds.into_iter().flatten();
        let (Some(kind), None) = (given.next(), given.next()) else {
            let message = format!("curve: needed is one, and only one, of {KINDS}");
            return Err(LoadError::malformed(place, message));
        };
        transform.extend(keys.transform.into_iter().map(|step| self.transform(step)));
        Ok(CurveSpec { place, kind, transform, reverse: keys.reverse })
    }

    fn bspline(&self, keys: BSplineKeys) -> Result<CurveKind, LoadError> {
        let ends = match (keys.closed, keys.ends) {
            (true, Some(ends)) => {
                let place = self.source.place(ends.span().start);
                let message = "bspline: a closed one has no ends to repeat";
                return Err(LoadError::malformed(place, message));
            }
            (true, None) => BSplineEnds::Closed,
            (false, ends) => {
                let times = ends.map_or([1, 1], Spanned::into_inner);
                BSplineEnds::Repeated(times.map(|times| times as usize))
            }
        };
        let points = keys.points.into_iter().map(|point| point.0).collect();
        Ok(CurveKind::BSpline { points, degree: keys.degree.unwrap_or(CUBIC).0 as usize, ends })
    }

    fn note_circle(&self, name: Spanned<String>) -> Result<CurveKind, LoadError> {
        let circle = name.get_ref().parse().map_err(|error: UnknownName| {
            LoadError::malformed(self.source.place(name.span().start), error.to_string())
        })?;
        Ok(CurveKind::NamedArc(circle))
    }

    fn quartic(&self, place: &Place, keys: QuarticKeys) -> Result<CurveKind, LoadError> {
        let (solution, w1) = match keys {
            QuarticKeys { solution: Some(solution), w1, weights: None, y1: None, x2: None } => {
                (solution, w1)
            }
            QuarticKeys {
                solution: None,
                w1: None,
                weights: Some(Exactly(weights)),
                y1: Some(Number(y1)),
                x2: Some(Number(x2)),
            } => {
                let weights = weights.map(|weight| weight.0);
                return Ok(CurveKind::QuarticConstants { weights, y1, x2 });
            }
            _ => {
                let message = "quarter_circle_4: needed is solution = 1 or 2, with w1 if it is not 1; \
                               or all of weights = [w1, w2], y1 and x2";
                return Err(LoadError::malformed(place.clone(), message));
            }
        };
        let arc = match *solution.get_ref() {
            1 => QuarticArc::First,
            2 => QuarticArc::Second,
            other => {
                let place = self.source.place(solution.span().start);
                let message = format!("found {other}, needed solution 1 or 2");
                return Err(LoadError::malformed(place, message));
            }
        };
        Ok(CurveKind::QuarticArc { arc, w1: w1.map_or(1.0, |w1| w1.0) })
    }

    /// The weights of a curve with this many points; their place is that of the first unusable one,
    /// if there is one for each point.
    fn weights_of(&self, points: usize, list: Spanned<Vec<Spanned<Number>>>) -> Written<Vec<f64>> {
        let all = list.get_ref();
        let unusable = all.iter().find(|weight| !is_usable_weight(weight.get_ref().0));
        let span = match unusable.filter(|_| all.len() == points) {
            Some(weight) => weight.span(),
            None => list.span(),
        };
        let values = all.iter().map(|weight| weight.get_ref().0).collect();
        Written::new(values, self.source.place(span.start))
    }

    fn nurbs_curve(&self, keys: NurbsCurveKeys) -> CurveKind {
        let knots = match keys.knots {
            Some(knots) => self.written(knots, |knots| knots.0),
            None => {
                Written::new(Knots::ClampedUniform, self.source.place(keys.points.span().start))
            }
        };
        let points: Vec<DVec3> =
            keys.points.into_inner().into_iter().map(|point| point.0).collect();
        let weights = keys.weights.map(|list| self.weights_of(points.len(), list));
        let degree = self.written(keys.degree, |degree| degree.0 as usize);
        CurveKind::Nurbs { degree, knots, points, weights }
    }
}
