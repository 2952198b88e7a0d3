//! Plots in a scene file, as `plots.md` shows them.

use glam::DVec3;
use serde::Deserialize;
use toml::Spanned;

use super::super::keyed::{Keyed, Named};
use super::curves::CurveKeys;
use super::forms::FormKey;
use super::kinds::{Kinds, OneOf};
use super::knot_list::KnotList;
use super::values::{BasisDegree, Count, Exactly, Number, Point, Vector};
use super::{LoadError, Reader};
use crate::geometry::{CornerCutting, PolygonEnds};
use crate::scene::{
    BasisSpec, CurveEntry, CurveSpec, FigureSpec, Knots, ObjectSpec, Plane, PlotKind, PlotSpec,
    PlottedSurface, RenderDefaults, SceneError, SceneFault, Written,
};

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FigureKeys {
    size: Option<Spanned<Exactly<Count, 2>>>,
    columns: Option<Spanned<u32>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlotKeys {
    title: Option<Spanned<String>>,
    plane: Option<Spanned<Named<PlaneKey>>>,
    view: Option<Spanned<Vector>>,
    show: Spanned<OneOf<ShowKeys>>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum PlaneKey {
    Xy,
    Xz,
    Yz,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum ShowKeys {
    Curves(Vec<Keyed<EntryKeys>>),
    Basis(Spanned<Keyed<BasisKeys>>),
    Blending(Named<FormKey>),
    Derivatives(Spanned<Keyed<DerivativeKeys>>),
    Hodograph(Spanned<Keyed<DerivativeKeys>>),
    Curvature(Keyed<OneCurveKeys>),
    Comb(Keyed<CombKeys>),
    Insertion(Keyed<InsertionKeys>),
    Elevation(Spanned<Keyed<ElevationKeys>>),
    DeCasteljau(Keyed<DeCasteljauKeys>),
    CornerCutting(Keyed<CornerCuttingKeys>),
    Trims(Keyed<ObjectKeys>),
    Surfaces(Keyed<SurfacesKeys>),
}

impl ShowKeys {
    /// For a plot that does not show space: its name, and what it is drawn over instead.
    fn over(&self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Basis(_) => Some(("basis", "the parameter")),
            Self::Blending(_) => Some(("blending", "the parameter")),
            Self::Derivatives(_) => Some(("derivatives", "the parameter")),
            Self::Curvature(_) => Some(("curvature", "the parameter")),
            Self::Trims(_) => Some(("trims", "u and v")),
            _ => None,
        }
    }
}

impl Kinds for ShowKeys {
    const EXAMPLE: &'static str = "what to plot, as in { blending = \"bspline\" }";
    const APART: &'static str = "each needs a [[plot]] of its own";
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EntryKeys {
    curve: Spanned<CurveKeys>,
    label: Option<Spanned<String>>,
    #[serde(default = "yes")]
    polygon: bool,
    #[serde(default = "yes")]
    knots: bool,
}

fn yes() -> bool {
    true
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BasisKeys {
    degree: BasisDegree,
    knots: Option<Spanned<KnotList>>,
    count: Option<u32>,
    weights: Option<Spanned<Vec<Number>>>,
    #[serde(default)]
    support: bool,
    derivative: Option<Spanned<u32>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OneCurveKeys {
    curve: Spanned<CurveKeys>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DerivativeKeys {
    curve: Spanned<CurveKeys>,
    order: Option<Spanned<u32>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CombKeys {
    curve: Spanned<CurveKeys>,
    teeth: Option<u32>,
    scale: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct InsertionKeys {
    curve: Spanned<CurveKeys>,
    knots: Vec<Spanned<Number>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ElevationKeys {
    curve: Spanned<CurveKeys>,
    times: Option<Spanned<u32>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DeCasteljauKeys {
    curve: Spanned<CurveKeys>,
    t: Spanned<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CornerCuttingKeys {
    polygon: Vec<Point>,
    scheme: Named<SchemeKey>,
    rounds: Option<u32>,
    #[serde(default)]
    closed: bool,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum SchemeKey {
    Chaikin,
    Cubic,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectKeys {
    of: Spanned<String>,
    surface: Option<Spanned<u32>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SurfacesKeys {
    of: Spanned<String>,
    surface: Option<Spanned<u32>>,
    lines: Option<u32>,
    #[serde(default)]
    net: bool,
}

/// The teeth of a span's comb if not given: enough to read as a surface.
const TEETH: usize = 24;

/// The rounds of corner cutting if not given: the polygon then looks like its limit.
const ROUNDS: usize = 3;

impl Reader<'_, '_> {
    pub(super) fn figure(&self, Keyed(keys): Keyed<FigureKeys>) -> Result<FigureSpec, LoadError> {
        if let Some(columns) = &keys.columns
            && *columns.get_ref() == 0
        {
            let place = self.source.place(columns.span().start);
            return Err(LoadError::malformed(
                place,
                "found 0, needed a number of columns from 1 on",
            ));
        }
        let size = keys.size.map(|size| self.written(size, |size| size.0.map(|side| side.0)));
        if let Some(Written { value, place }) = &size {
            RenderDefaults::check_size(*value)
                .map_err(|error| SceneError::new(place.clone(), SceneFault::Picture(error)))?;
        }
        let columns = keys.columns.map(|columns| self.written(columns, |columns| columns as usize));
        Ok(FigureSpec { size, columns })
    }

    pub(super) fn plot(&self, keys: Spanned<Keyed<PlotKeys>>) -> Result<PlotSpec, LoadError> {
        let Keyed(keys) = keys.into_inner();
        let place = self.source.place(keys.show.span().start);
        let title = keys.title.map(|title| self.name(title)).transpose()?;
        let OneOf(show) = keys.show.into_inner();
        let plane = self.plane(keys.plane, keys.view, show.over())?;
        let show = self.show(show)?;
        Ok(PlotSpec { place, title: title.map(|title| title.value), plane, show })
    }

    /// The plane of a plot of space; `over` says what another plot is drawn over.
    fn plane(
        &self,
        plane: Option<Spanned<Named<PlaneKey>>>,
        view: Option<Spanned<Vector>>,
        over: Option<(&str, &str)>,
    ) -> Result<Option<Plane>, LoadError> {
        let malformed =
            |at: usize, message: String| Err(LoadError::malformed(self.source.place(at), message));
        let plane_at = plane.as_ref().map(|plane| (plane.span().start, "plane"));
        let view_at = view.as_ref().map(|view| (view.span().start, "view"));
        if let (Some((at, key)), Some((kind, over))) = (plane_at.or(view_at), over) {
            return malformed(
                at,
                format!(
                    "a plot of {kind} is drawn over {over}, not in a plane of space: leave {key} out"
                ),
            );
        }
        match (plane.map(|plane| plane.into_inner().0), view) {
            (None, None) => Ok(None),
            (Some(PlaneKey::Xy), None) => Ok(Some(Plane::Xy)),
            (Some(PlaneKey::Xz), None) => Ok(Some(Plane::Xz)),
            (Some(PlaneKey::Yz), None) => Ok(Some(Plane::Yz)),
            (None, Some(view)) => match *view.get_ref() {
                Vector(toward) if toward == DVec3::ZERO => {
                    let found = "view (0, 0, 0) is no direction: it must not be zero";
                    malformed(view.span().start, found.to_owned())
                }
                Vector(toward) => Ok(Some(Plane::Across(toward))),
            },
            (Some(_), Some(view)) => {
                let both = "both plane and view: a plot has one of them".to_owned();
                malformed(view.span().start, both)
            }
        }
    }

    fn show(
        &self,
        keys: ShowKeys,
    ) -> Result<PlotKind<CurveSpec, BasisSpec, ObjectSpec>, LoadError> {
        Ok(match keys {
            ShowKeys::Curves(entries) => {
                let entries = entries.into_iter().map(|Keyed(keys)| self.entry(keys));
                PlotKind::Curves(entries.collect::<Result<_, _>>()?)
            }
            ShowKeys::Basis(keys) => PlotKind::Basis(self.basis(keys)),
            ShowKeys::Blending(Named(form)) => PlotKind::Blending(form.into()),
            ShowKeys::Derivatives(keys) => {
                let (curve, order) = self.derivative(keys)?;
                PlotKind::Derivatives { curve, order }
            }
            ShowKeys::Hodograph(keys) => {
                let (curve, order) = self.derivative(keys)?;
                PlotKind::Hodograph { curve, order }
            }
            ShowKeys::Curvature(Keyed(keys)) => PlotKind::Curvature(self.curve(keys.curve)?),
            ShowKeys::Comb(Keyed(keys)) => PlotKind::Comb {
                curve: self.curve(keys.curve)?,
                teeth: keys.teeth.map_or(TEETH, |teeth| teeth as usize),
                scale: keys.scale.map(|scale| scale.0),
            },
            ShowKeys::Insertion(Keyed(keys)) => {
                let knots = keys.knots.into_iter();
                let knots = knots.map(|knot| self.written(knot, |knot| knot.0)).collect();
                PlotKind::Insertion { curve: self.curve(keys.curve)?, knots }
            }
            ShowKeys::Elevation(keys) => {
                let place = self.source.place(keys.span().start);
                let Keyed(keys) = keys.into_inner();
                let times = match keys.times {
                    Some(times) => self.written(times, |times| times as usize),
                    None => Written::new(1, place),
                };
                PlotKind::Elevation { curve: self.curve(keys.curve)?, times }
            }
            ShowKeys::DeCasteljau(Keyed(keys)) => PlotKind::DeCasteljau {
                curve: self.curve(keys.curve)?,
                t: self.written(keys.t, |t| t.0),
            },
            ShowKeys::CornerCutting(Keyed(keys)) => PlotKind::CornerCutting {
                polygon: keys.polygon.into_iter().map(|point| point.0).collect(),
                scheme: match keys.scheme.0 {
                    SchemeKey::Chaikin => CornerCutting::Chaikin,
                    SchemeKey::Cubic => CornerCutting::Cubic,
                },
                ends: if keys.closed { PolygonEnds::Closed } else { PolygonEnds::Open },
                rounds: keys.rounds.map_or(ROUNDS, |rounds| rounds as usize),
            },
            ShowKeys::Trims(Keyed(keys)) => PlotKind::Trims(self.object_spec(keys)),
            ShowKeys::Surfaces(Keyed(keys)) => PlotKind::Surfaces {
                of: self.object_spec(ObjectKeys { of: keys.of, surface: keys.surface }),
                lines: keys.lines.map_or(PlottedSurface::LINES, |lines| lines as usize),
                net: keys.net,
            },
        })
    }

    /// A curve and the order of its derivative.
    fn derivative(
        &self,
        keys: Spanned<Keyed<DerivativeKeys>>,
    ) -> Result<(CurveSpec, Written<usize>), LoadError> {
        let place = self.source.place(keys.span().start);
        let Keyed(keys) = keys.into_inner();
        let order = match keys.order {
            Some(order) => self.written(order, |order| order as usize),
            None => Written::new(1, place),
        };
        Ok((self.curve(keys.curve)?, order))
    }

    fn basis(&self, keys: Spanned<Keyed<BasisKeys>>) -> BasisSpec {
        let place = self.source.place(keys.span().start);
        let Keyed(keys) = keys.into_inner();
        let knots = match keys.knots {
            Some(knots) => self.written(knots, |knots| knots.0),
            None => Written::new(Knots::ClampedUniform, place),
        };
        let weights = |list: Vec<Number>| list.into_iter().map(|weight| weight.0).collect();
        BasisSpec {
            degree: keys.degree.0 as usize,
            knots,
            count: keys.count.map(|count| count as usize),
            weights: keys.weights.map(|list| self.written(list, weights)),
            support: keys.support,
            derivative: keys.derivative.map(|k| self.written(k, |k| k as usize)),
        }
    }

    fn object_spec(&self, keys: ObjectKeys) -> ObjectSpec {
        let surface = keys.surface.map(|number| self.written(number, |number| number as usize));
        ObjectSpec { of: self.text(keys.of), surface }
    }

    fn entry(&self, keys: EntryKeys) -> Result<CurveEntry<CurveSpec>, LoadError> {
        let label = keys.label.map(|label| self.name(label)).transpose()?;
        Ok(CurveEntry {
            curve: self.curve(keys.curve)?,
            label: label.map(|label| label.value),
            polygon: keys.polygon,
            knots: keys.knots,
        })
    }
}
