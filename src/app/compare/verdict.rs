//! Whether two answers for one ray mean the same place, and if not, why.

use glam::DVec3;
use nurbray::intersect::{Query, SurfaceBvh};
use nurbray::math::Ray;

use super::sight::{self, Sight, View};

/// The largest distance from our tangent plane, in tolerances, at which a triangle's hit counts
/// as the same place.
///
/// If triangles lie up to `e` inside a sphere and a ray passes `h ≥ e` inside its outline, the
/// hits are `√(2Rh) − √(2R(h − e))` apart along the ray, that is
/// `2 (h − √(h (h − e))) ≤ 2 e` from the tangent plane: the nearer the outline, the more.
/// The further tenth allows for what the sampling that made the triangles overlooks.
const SAME_PLACE: f64 = 2.2;

/// How far to the side, in tolerances, rays look for what the other side sees, and in how many
/// directions. Triangles and surface are at most a tolerance apart, and so are their outlines.
const ASIDE: [f64; 2] = [1.0, SAME_PLACE];
const DIRECTIONS: u32 = 8;

/// The outcome of one ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Both miss.
    Nothing,
    /// Both see the same place.
    Same,
    /// The triangles lack what the surface shows.
    Lost(Cause),
    /// The triangles show what the surface does not have there.
    Invented(Cause),
    /// Our own answer is doubtful: there is no truth to judge by.
    Open,
}

/// Why two answers differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// A ray at most [`SAME_PLACE`] tolerances aside sees on the surface what the triangles show,
    /// or may see it: the silhouette is in the wrong place.
    Silhouette,
    /// No such ray: there is a gap between triangles, or they overlap.
    Gap,
}

/// Judges answers of one tessellation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judge<'a> {
    /// The surfaces.
    pub(super) bvh: &'a SurfaceBvh,
    /// The tolerance in scene units.
    pub(super) tolerance: f64,
}

impl Judge<'_> {
    /// Compares what both see along a ray.
    pub(super) fn judge(self, ray: &Ray, ours: &View, theirs: Option<&Sight>) -> Verdict {
        let View::Known(ours) = ours else { return Verdict::Open };
        let lost = match (ours.as_ref(), theirs) {
            (None, None) => return Verdict::Nothing,
            (Some(_), None) => true,
            (None, Some(_)) => false,
            (Some(ours), Some(theirs)) => {
                let apart = (theirs.distance - ours.distance).abs() * ours.incidence(ray);
                if apart <= self.reach(theirs) {
                    return Verdict::Same;
                }
                theirs.distance > ours.distance
            }
        };
        let cause = if self.is_seen_aside(ray, theirs) { Cause::Silhouette } else { Cause::Gap };
        if lost { Verdict::Lost(cause) } else { Verdict::Invented(cause) }
    }

    /// The largest distance from a tangent plane that counts as the same place.
    fn reach(self, theirs: &Sight) -> f64 {
        SAME_PLACE * self.tolerance + theirs.rounding
    }

    /// Whether a ray a little to the side sees on the surface what the triangles show.
    fn is_seen_aside(self, ray: &Ray, theirs: Option<&Sight>) -> bool {
        let mut tracer = self.bvh.tracer();
        let mut sees_it = |aside: Ray| {
            let answer = tracer.first_hit(&Query::primary(aside));
            if answer.doubtful {
                return true;
            }
            match (sight::on_surface(&answer, &aside), theirs) {
                (None, None) => true,
                (Some(ours), Some(theirs)) => {
                    let apart = (theirs.point - ours.point).dot(ours.normal).abs();
                    // The tangent plane was moved aside, too.
                    apart <= 2.0 * self.reach(theirs)
                }
                _ => false,
            }
        };
        self.rays_aside(ray).any(&mut sees_it)
    }

    fn rays_aside(self, ray: &Ray) -> impl Iterator<Item = Ray> {
        let along = ray.direction().normalize_or_zero();
        let (right, up) = along.any_orthonormal_pair();
        let offsets = ASIDE.into_iter().flat_map(move |distance| {
            (0..DIRECTIONS).map(move |direction| {
                let turn = f64::from(direction) / f64::from(DIRECTIONS);
                let (sine, cosine) = (std::f64::consts::TAU * turn).sin_cos();
                distance * self.tolerance * (cosine * right + sine * up)
            })
        });
        let ray = *ray;
        offsets.filter_map(move |offset: DVec3| {
            Ray::with_range(ray.origin() + offset, ray.direction(), ray.t_min(), ray.t_max()).ok()
        })
    }
}

#[cfg(test)]
mod tests {
    use nurbray::geometry::shapes;

    use super::*;

    /// The unit sphere, seen from above by rays that run down at a distance from its axis;
    /// triangles are a sphere of another radius, or have a hole.
    struct Setting {
        bvh: SurfaceBvh,
        tolerance: f64,
    }

    impl Setting {
        fn new(size: f64) -> Self {
            let bvh = SurfaceBvh::build(&[shapes::sphere(size).unwrap()]);
            Self { bvh: bvh.unwrap(), tolerance: 1e-3 * size }
        }

        fn ray(size: f64, beside: f64) -> Ray {
            let origin = DVec3::new(beside * 0.6, beside * 0.8, 3.0) * size;
            Ray::new(origin, DVec3::NEG_Z).unwrap()
        }

        fn exact(&self, ray: &Ray) -> Option<Sight> {
            sight::on_surface(&self.bvh.tracer().first_hit(&Query::primary(*ray)), ray)
        }

        fn verdict(&self, ray: &Ray, theirs: Option<f64>) -> Verdict {
            let sight = |distance: f64| Sight {
                distance,
                point: ray.at(distance / ray.direction().length()),
                normal: DVec3::Z,
                facet: DVec3::Z,
                rounding: 0.0,
                residual: 0.0,
            };
            let judge = Judge { bvh: &self.bvh, tolerance: self.tolerance };
            judge.judge(ray, &View::Known(self.exact(ray)), theirs.map(sight).as_ref())
        }
    }

    /// The distance at which a ray beside the axis meets a sphere smaller or larger than 1.
    fn met(radius: f64, beside: f64) -> Option<f64> {
        let square = radius * radius - beside * beside;
        (square >= 0.0).then(|| 3.0 - square.sqrt())
    }

    #[test]
    fn a_tolerance_off_is_the_same_place_up_to_the_outline() {
        for size in [1e-8, 1.0, 1e8] {
            let setting = Setting::new(size);
            for radius in [1.0 - 1e-3, 1.0 + 1e-3] {
                for beside in [0.0, 0.5, 0.9, 0.99, 0.998, 0.9989] {
                    let theirs = met(radius, beside).map(|distance| distance * size);
                    let verdict = setting.verdict(&Setting::ray(size, beside), theirs);
                    assert_eq!(verdict, Verdict::Same, "{size:e} {radius} {beside}");
                }
            }
            // Between both outlines.
            let (inner, outer) = (Setting::ray(size, 0.9995), Setting::ray(size, 1.0005));
            assert_eq!(setting.verdict(&inner, None), Verdict::Lost(Cause::Silhouette));
            let theirs = met(1.001, 1.0005).map(|distance| distance * size);
            assert_eq!(setting.verdict(&outer, theirs), Verdict::Invented(Cause::Silhouette));
            assert_eq!(setting.verdict(&outer, None), Verdict::Nothing);
        }
    }

    #[test]
    fn gaps_are_no_silhouettes() {
        let setting = Setting::new(1.0);
        let ray = Setting::ray(1.0, 0.5);
        let judge = Judge { bvh: &setting.bvh, tolerance: setting.tolerance };
        assert_eq!(judge.judge(&ray, &View::Doubtful, None), Verdict::Open);
        // The triangles lack the front, or show something where nothing is.
        assert_eq!(setting.verdict(&ray, None), Verdict::Lost(Cause::Gap));
        let back = 6.0 - met(1.0, 0.5).unwrap();
        assert_eq!(setting.verdict(&ray, Some(back)), Verdict::Lost(Cause::Gap));
        assert_eq!(setting.verdict(&ray, Some(1.0)), Verdict::Invented(Cause::Gap));
        let beside = Setting::ray(1.0, 1.5);
        assert_eq!(setting.verdict(&beside, Some(2.0)), Verdict::Invented(Cause::Gap));
    }
}
