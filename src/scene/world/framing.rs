//! Choosing a view that shows everything, and lights that show its shape.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, DVec4};

use crate::geometry::trim::{Side, UvBox};
use crate::geometry::{Chart, Charts, KnotVector, NurbsSurface, Surface};
use crate::math::Aabb;
use crate::scene::look::{Camera, CameraError, Light, Projection, VIEW_FROM, View};
use crate::scene::written::{CameraSpec, Lens, Place, Written};

/// The share of the picture's shorter side that the bounding sphere takes up is one over
/// this: a thin frame of background remains.
const MARGIN: f64 = 1.05;

/// The approximate number of points sampled across a surface, each way, to find its extent: a
/// sphere is found to a thousandth of its size, well within [`MARGIN`].
const MOST_SAMPLES: usize = 48;

/// The approximate number of points sampled in all to see where each surface is, a few
/// milliseconds' work. If there are many surfaces, most are small, and so is what their few samples
/// miss.
const ALL_SAMPLES: f64 = 65_536.0;

/// The approximate number of further points, on those surfaces that may reach beyond all of these.
const MORE_SAMPLES: usize = 1 << 20;

/// Where weights differ by more than this factor along a line of control points, a surface runs
/// through much of its extent near the ends of its spans.
const EVEN_WEIGHTS: f64 = 16.0;

/// The most points sampled on the way to each end of such spans, each nearer by √2.
const MOST_NEAR_ENDS: usize = 64;

/// A sphere around the middle of the surfaces that holds them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BoundingSphere {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

impl BoundingSphere {
    /// The sphere about the middle of the surfaces' bounding box; found by sampling, since
    /// control points can lie far off their surface. `None` without surfaces.
    pub(super) fn of<'a>(surfaces: impl ExactSizeIterator<Item = &'a Surface>) -> Option<Self> {
        Self::around(&scene_samples(surfaces))
    }

    /// The sphere about the middle of the points' bounding box; `None` without points.
    fn around(points: &[DVec3]) -> Option<Self> {
        let low = points.iter().copied().reduce(DVec3::min)?;
        let high = points.iter().copied().reduce(DVec3::max)?;
        let center = 0.5 * low + 0.5 * high;
        let radius = points.iter().map(|point| point.distance(center)).fold(0.0, f64::max);
        Some(Self { center, radius })
    }

    /// Whether a box lies inside the sphere.
    fn holds(&self, aabb: &Aabb) -> bool {
        let farthest = (aabb.min - self.center).abs().max((aabb.max - self.center).abs());
        farthest.length() <= self.radius
    }
}

/// Points on all surfaces, more on those that may reach beyond the others' points.
fn scene_samples<'a>(surfaces: impl ExactSizeIterator<Item = &'a Surface>) -> Vec<DVec3> {
    let few = (ALL_SAMPLES / surfaces.len() as f64).sqrt() as usize;
    let few = few.clamp(2, MOST_SAMPLES); // fewer would miss the middle of a closed span
    let mut points = Vec::new();
    let mut boxes = Vec::with_capacity(surfaces.len());
    for surface in surfaces {
        let mut some = surface_samples(surface, few);
        boxes.push((surface, Aabb::around(some.iter().copied())));
        points.append(&mut some);
    }
    let Some(sphere) = BoundingSphere::around(&points) else { return points };
    // What samples miss of a surface is a share of its size that falls with their square.
    let whole = Aabb::around(points.iter().copied());
    let candidates = boxes.into_iter().filter_map(|(surface, own)| {
        let size = own.size().max_element();
        let share = (size / whole.size().max_element()).sqrt();
        let needed = (MOST_SAMPLES as f64 * share).ceil() as usize; // 0 for NaN
        let reach = own.grown(size / (few * few) as f64);
        let is_inside = reach.min.cmpge(whole.min).all()
            && reach.max.cmple(whole.max).all()
            && sphere.holds(&reach);
        (needed > few && !is_inside).then_some((surface, needed))
    });
    // Those that need least come first, and leave to the others what they do not take.
    let mut candidates: Vec<(&Surface, usize)> = candidates.collect();
    candidates.sort_by_key(|(_, needed)| *needed);
    let (mut left, count) = (MORE_SAMPLES, candidates.len());
    for (k, (surface, needed)) in candidates.into_iter().enumerate() {
        let share = (left / (count - k)).isqrt();
        let mut more = surface_samples(surface, needed.min(share.max(few)));
        left = left.saturating_sub(more.len());
        points.append(&mut more);
    }
    points
}

/// Points on a surface: the more charts, the fewer on each.
fn surface_samples(surface: &Surface, across: usize) -> Vec<DVec3> {
    let charts = surface.charts();
    let across = (across as f64 / (charts.len() as f64).sqrt()).ceil() as usize;
    let kept = appended(charts.iter().map(|chart| chart_samples(chart, across)));
    if kept.is_empty() {
        // The part that trims keep may lie between the samples.
        let whole = charts.into_iter().map(|chart| Chart { trims: None, ..chart });
        return appended(whole.map(|chart| chart_samples(&chart, across)));
    }
    kept
}

/// All points, copied list by list, not point by point.
fn appended(lists: impl Iterator<Item = Vec<DVec3>>) -> Vec<DVec3> {
    let mut all = Vec::new();
    for mut list in lists {
        all.append(&mut list);
    }
    all
}

/// Points on a chart: the points of a grid through every knot, as far as the chart's trims keep
/// them.
fn chart_samples(chart: &Chart<'_>, across: usize) -> Vec<DVec3> {
    let surface = &chart.surface;
    let (us, vs) = (surface.knots_u(), surface.knots_v());
    let bounds = match &chart.trims {
        Some(trims) => trims.bounds(),
        None => UvBox::new(us.domain(), vs.domain()),
    };
    let [uneven_u, uneven_v] = uneven_weights(surface);
    let us = parameters((us, uneven_u), across, [bounds.min.x, bounds.max.x]);
    let vs = parameters((vs, uneven_v), across, [bounds.min.y, bounds.max.y]);
    let points = surface.points_at(&us, &vs);
    let Some(trims) = &chart.trims else { return points };
    let grid = us.iter().flat_map(|&u| vs.iter().map(move |&v| DVec2::new(u, v)));
    let kept = |&(uv, _): &(DVec2, DVec3)| trims.side_of(uv) != Side::Outside;
    let kept = grid.zip(points).filter(kept).map(|(_, point)| point);
    // Small parts may lie between the points of the grid, but not between those of their own edges.
    let domain = trims.domain().bounds();
    let thinned = trims.joints().step_by(1 + trims.segment_count() / (across * across).max(16));
    let edges = thinned.filter(|uv| uv.cmpge(domain.min).all() && uv.cmple(domain.max).all());
    kept.chain(edges.map(|uv| surface.point_at(uv))).collect()
}

/// The largest ratio of two weights along a line of control points, in each direction.
fn uneven_weights(surface: &NurbsSurface) -> [f64; 2] {
    if !surface.is_rational() {
        return [1.0; 2];
    }
    let (net, columns) = (surface.control(), surface.size()[1]);
    let ratio = |line: &mut dyn Iterator<Item = &DVec4>| {
        let (low, high) = line.fold((f64::INFINITY, 0.0f64), |(low, high), point| {
            (low.min(point.w), high.max(point.w))
        });
        high / low
    };
    let along_v = net.chunks_exact(columns).map(|row| ratio(&mut row.iter()));
    let along_u = (0..columns).map(|j| ratio(&mut net.iter().skip(j).step_by(columns)));
    [along_u.fold(1.0, f64::max), along_v.fold(1.0, f64::max)]
}

/// The ends of all spans within a range, and enough parameters between them to make up `across`;
/// where weights are uneven, up to four times as many in addition, near the ends of spans.
fn parameters(
    (knots, uneven): (&KnotVector, f64),
    across: usize,
    [from, to]: [f64; 2],
) -> Vec<f64> {
    let spans = knots.spans().map(|span| [span.start.max(from), span.end.min(to)]);
    let spans: Vec<[f64; 2]> = spans.filter(|[start, end]| start < end).collect();
    let each = across.div_ceil(spans.len().max(1)).max(1);
    let mut shares: Vec<f64> = (1..=each).map(|k| k as f64 / each as f64).collect();
    if uneven > EVEN_WEIGHTS {
        let halvings = (2.0 * uneven.log2()) as usize;
        let most = MOST_NEAR_ENDS.min(2 * across / spans.len().max(1));
        for k in 0..halvings.min(most) {
            let share = 0.5f64.powf(0.5 * (k + 3) as f64);
            shares.extend([share, 1.0 - share]);
        }
    }
    let mut parameters = vec![from];
    for [start, end] in spans {
        parameters.extend(shares.iter().map(|share| start + share * (end - start)));
    }
    parameters
}

impl CameraSpec {
    /// Where the part of the camera that an error is about was written.
    pub(super) fn blame(&self, error: &CameraError) -> &Place {
        let (from, at) = (place(&self.look_from), place(&self.look_at));
        let part = match (error, &self.lens) {
            (CameraError::Coordinate { name: "look_from", .. }, _) => from,
            (CameraError::Coordinate { name: "look_at", .. }, _) => at,
            (CameraError::Coordinate { .. } | CameraError::NoUp(_), _)
            | (CameraError::UpAlongView { .. }, _) => place(&self.up),
            (CameraError::NoDirection(_) | CameraError::RoundedDirection(_), _) => at.or(from),
            (CameraError::Fov(_), Lens::Perspective { fov }) => place(fov),
            (CameraError::Height(_), Lens::Orthographic { height }) => place(height),
            (CameraError::Fov(_) | CameraError::Height(_), _) => None,
        };
        part.unwrap_or(&self.place)
    }

    /// The camera as written, with the rest chosen to show the sphere in pictures of this aspect,
    /// width over height.
    pub(super) fn camera(
        &self,
        sphere: BoundingSphere,
        aspect: f64,
    ) -> Result<Camera, CameraError> {
        let radius = MARGIN * sphere.radius;
        // Lenses give the height of a picture; the sphere must fit into its width, too.
        let narrow = aspect.min(1.0);
        let projection = match &self.lens {
            Lens::Perspective { fov } => {
                Projection::Perspective { fov: value(fov).unwrap_or(Lens::DEFAULT_FOV) }
            }
            Lens::Orthographic { height } => {
                Projection::Orthographic { height: value(height).unwrap_or(2.0 * radius / narrow) }
            }
        };
        let look_at = value(&self.look_at).unwrap_or(sphere.center);

        // An eye without a given place goes where the sphere just fits, even if its centre lies
        // off the middle of the picture.
        let look_from = value(&self.look_from).unwrap_or_else(|| {
            let reach = radius + MARGIN * look_at.distance(sphere.center);
            let distance = match projection {
                // The same for `narrow` 1, except for rounding.
                Projection::Perspective { fov } if narrow < 1.0 => {
                    reach / (narrow * (0.5 * fov.to_radians()).tan()).atan().sin()
                }
                Projection::Perspective { fov } => reach / (0.5 * fov.to_radians()).sin(),
                Projection::Orthographic { .. } => 2.0 * reach,
            };
            look_at + distance * VIEW_FROM.normalize()
        });
        let view = |up| View { look_from, look_at, up };
        match value(&self.up) {
            Some(up) => Camera::new(view(up), projection),
            None => match Camera::new(view(DVec3::Z), projection) {
                Err(CameraError::UpAlongView { .. }) => Camera::new(view(DVec3::Y), projection), // from above
                other => other,
            },
        }
    }
}

fn place<T>(written: &Option<Written<T>>) -> Option<&Place> {
    written.as_ref().map(|written| &written.place)
}

fn value<T: Copy>(written: &Option<Written<T>>) -> Option<T> {
    written.as_ref().map(|written| written.value)
}

/// The lights of a scene that has none: as in a photographer's studio, a key light over the
/// camera's left shoulder, a fill light a third as strong from the right, and a little
/// light from everywhere. A white surface facing the key light has a radiance near 1.
pub(super) fn default_lights(camera: &Camera) -> Vec<Light> {
    let (right, up, back) = (camera.right(), camera.up(), -camera.forward());
    let key = Light::directional(-0.6 * right + 0.9 * up + 0.8 * back, [0.75 * PI; 3]);
    let fill = Light::directional(0.9 * right + 0.2 * up + 0.6 * back, [0.25 * PI; 3]);
    let ambient = Light::Ambient { radiance: [0.06; 3] };
    key.into_iter().chain(fill).chain([ambient]).collect()
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::geometry::shapes;

    /// `many` small planes, and a narrow arch whose crown, 17.8 high, is at a third of its length.
    fn planes_and_arch(many: usize) -> (Vec<Surface>, DVec3) {
        let plane = Surface::from(shapes::plane(1.0, 1.0).unwrap());
        let net = [[-1.0, 0.0], [0.0, 40.0], [0.0, 0.0], [1.0, 0.0]];
        let net = net.map(|[x, y]| [0.0, 0.5, 1.0].map(|z| DVec3::new(x, y, z)));
        let [us, vs] = [3, 2].map(|degree| KnotVector::bezier(degree).unwrap());
        let arch = NurbsSurface::new(us, vs, net.concat(), None).unwrap();
        let crown = arch.point_at(DVec2::new(1.0 / 3.0, 0.5));
        let all = std::iter::repeat_n(&plane, many).cloned().chain([Surface::from(arch)]);
        (all.collect(), crown)
    }

    #[test]
    fn a_large_surface_among_many_small_ones_is_held() {
        for many in [0, 10, 1_500, 2_000, 17_000] {
            let (all, crown) = planes_and_arch(many);
            let sphere = BoundingSphere::of(all.iter()).unwrap();
            let off = crown.distance(sphere.center) / sphere.radius;
            assert!(off < 1.0 + 2e-3, "{many}: {off}");
        }
        // Few samples alone would not do.
        let (all, crown) = planes_and_arch(17_000);
        let few = all.iter().flat_map(|surface| surface_samples(surface, 2)).collect::<Vec<_>>();
        let sphere = BoundingSphere::around(&few).unwrap();
        assert!(crown.distance(sphere.center) > MARGIN * sphere.radius);
    }

    #[test]
    fn no_scene_takes_many_samples() {
        // All as long as the scene.
        let plane = |k: usize| {
            let map = DAffine3::from_translation(DVec3::new(0.0, 0.0, 1e-3 * k as f64));
            Surface::from(shapes::plane(100.0, 1.0).unwrap().transformed(&map).unwrap())
        };
        let all: Vec<Surface> = (0..17_000).map(plane).collect();
        let points = scene_samples(all.iter());
        assert!(points.len() < 2 * MORE_SAMPLES, "{}", points.len());
        let sphere = BoundingSphere::around(&points).unwrap();
        assert!((sphere.radius - DVec3::new(50.0, 0.5, 8.4995).length()).abs() < 1e-9);
        let knots = KnotVector::clamped_uniform(3, 67).unwrap();
        assert!(parameters((&knots, 1e30), MOST_SAMPLES, [0.0, 1.0]).len() < 64 * 4);
        let knots = KnotVector::bezier(3).unwrap();
        assert!(parameters((&knots, 1e30), 2, [0.0, 1.0]).len() < 12);
    }

    #[test]
    fn what_bulges_near_the_end_of_a_span_is_held() {
        for ratio in [1.0, 3.0, 1e2, 1e4, 1e8] {
            let knots = |degree| KnotVector::bezier(degree).unwrap();
            let net = [-1.0, 8.0, 1.0].map(|z| [0.0, 1.0].map(|x| DVec3::new(x, 0.0, z)));
            let weights = [1.0, ratio, ratio * ratio].map(|weight| [weight; 2]).concat();
            let bulge = NurbsSurface::new(knots(2), knots(1), net.concat(), Some(weights)).unwrap();
            let sphere = BoundingSphere::of([Surface::from(bulge)].iter()).unwrap();
            // Its parabola, whatever the weights: 65/16 at the height of its vertex.
            let highest = DVec3::new(0.5, 0.0, 65.0 / 16.0);
            let off = highest.distance(sphere.center) / sphere.radius;
            assert!(off < MARGIN, "{ratio}: {off}");
        }
    }

    #[test]
    fn pictures_of_any_shape_just_hold_the_sphere_and_lenses_say_how_high_they_are() {
        let sphere = BoundingSphere { center: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 };
        let written = |value: f64| Some(Written::from(value));
        for fov in [None, written(70.0)] {
            for aspect in [0.2, 0.5, 1.0, 2.0] {
                let lens = Lens::Perspective { fov: fov.clone() };
                let camera = CameraSpec { lens, ..CameraSpec::default() };
                let camera = camera.camera(sphere, aspect).unwrap();
                let [top, side] = [DVec2::new(0.5, 0.0), DVec2::new(0.0, 0.5)]
                    .map(|film| camera.ray(film, aspect));
                let half = top.direction().angle_between(camera.forward()).to_degrees();
                assert!((2.0 * half - fov.as_ref().map_or(30.0, |fov| fov.value)).abs() < 1e-9);
                let nearest = [top, side].map(|ray| {
                    let to = sphere.center - ray.origin();
                    to.cross(ray.direction()).length() / ray.direction().length()
                });
                let nearest = nearest[0].min(nearest[1]);
                assert!((nearest - MARGIN * sphere.radius).abs() < 1e-12, "{aspect}: {nearest}");
            }
        }
        let camera = |height: Option<Written<f64>>| {
            let lens = Lens::Orthographic { height };
            CameraSpec { lens, ..CameraSpec::default() }.camera(sphere, 0.5).unwrap().projection()
        };
        assert_eq!(camera(written(3.0)), Projection::Orthographic { height: 3.0 });
        assert_eq!(camera(None), Projection::Orthographic { height: 4.0 * MARGIN * 0.5 });
    }
}
