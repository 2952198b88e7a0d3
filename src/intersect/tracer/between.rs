//! Whether a hit sees another one, or a place that may lie on a surface.

use glam::DVec3;

use super::Tracer;
use crate::intersect::{Hit, Occlusion, Query};
use crate::math::Ray;

/// The cosine between ray and normal below which the ray grazes the surface it ends on: a place
/// across that surface says little about the place along the ray.
const GRAZING: f64 = 1e-6;

impl Tracer<'_> {
    /// Whether anything lies between two hits.
    ///
    /// Neither hit is in its own way, and no epsilon keeps the ray away from them: what is met
    /// first is compared with where the ray is meant to end. It is that place if it is as close to
    /// it, across the surface there, as the errors of both allow. (A ray to a hit with an end at
    /// that hit, as in `Ray::with_range(p, q - p, 0.0, 1.0)`, is no substitute: rounding decides
    /// whether it meets the surface at its end, so most of its answers are doubtful.)
    ///
    /// The answer is doubtful where that of the ray is, and where a ray that grazes the surface at
    /// its end meets something else that may be in that surface's plane. So it is, as a rule,
    /// between two hits on one plane: the ray runs in the surface. Two hits at one place see each
    /// other.
    pub fn occluded_between(&mut self, from: &Hit, to: &Hit) -> Occlusion {
        let across = self.across(to);
        let end = End { point: to.point, normal: to.normal, across, error: to.root.error };
        self.occluded_before(from, to.point, |_| end)
    }

    /// Whether anything lies between a hit and a place, such as that of a lamp.
    ///
    /// Where the place lies on a surface, this is not in its way, on whichever side the hit is; nor
    /// is what lies in front of that surface by no more than a few error bounds. Otherwise the
    /// answer is that of [`occluded`](Self::occluded) for a ray that ends at the place, which would
    /// be doubtful on a surface.
    pub fn occluded_up_to(&mut self, from: &Hit, place: DVec3) -> Occlusion {
        if let Ok(ray) = Ray::with_range(from.point, place - from.point, 0.0, 1.0) {
            let occlusion = self.occluded(&Query::leaving(ray, from));
            if !occlusion.doubtful {
                return occlusion;
            }
        }
        // It is on the surface that is met there, if it lies in its tangent plane.
        self.occluded_before(from, place, |met| End {
            point: place,
            normal: met.normal,
            across: 0.0,
            error: 0.0,
        })
    }

    /// Whether anything lies between a hit and a place; `end` says what the ray should end on, given
    /// what it meets.
    fn occluded_before(
        &mut self,
        from: &Hit,
        place: DVec3,
        end: impl FnOnce(&Hit) -> End,
    ) -> Occlusion {
        let way = place - from.point;
        let Ok(ray) = Ray::new(from.point, way) else {
            // The same point; or hits that no tracer has made.
            return Occlusion { occluded: false, doubtful: !way.is_finite() };
        };
        let answer = self.first_hit(&Query::leaving(ray, from));
        let Some(met) = answer.hit.filter(|hit| hit.t < 1.0) else {
            return Occlusion { occluded: false, doubtful: answer.doubtful };
        };
        match Met::of(&met, &end(&met), &ray) {
            Met::End => Occlusion { occluded: false, doubtful: answer.doubtful },
            Met::PerhapsEnd => Occlusion { occluded: true, doubtful: true },
            Met::Elsewhere => Occlusion { occluded: true, doubtful: answer.doubtful },
        }
    }

    /// How far the point of a hit may be off its surface: if that is one of ours, no more than
    /// rounding, from however far away it was found.
    fn across(&self, hit: &Hit) -> f64 {
        let (root, set) = (&hit.root, &self.bvh.set);
        let own = (root.set == set.id()).then(|| {
            let patch = &set.pieces()[root.piece as usize].patch;
            patch.error_bound(hit.point.abs().max_element())
        });
        own.map_or(root.across(), |own| own.min(root.across()))
    }
}

/// Where a ray is meant to end.
struct End {
    point: DVec3,
    /// The normal of the surface there, or NaN.
    normal: DVec3,
    /// How far the point may be off that surface, and how far along the ray that found it.
    across: f64,
    error: f64,
}

/// How a hit lies to the place where its ray is meant to end.
enum Met {
    /// It is that place.
    End,
    /// It is elsewhere on the ray, but not known to be off the surface there.
    PerhapsEnd,
    Elsewhere,
}

impl Met {
    fn of(met: &Hit, to: &End, ray: &Ray) -> Self {
        // The ray's direction is off by the rounding of both points.
        let size = ray.origin().abs().max(to.point.abs()).max_element();
        let rounding = 4.0 * f64::EPSILON * size;
        let off = met.point - to.point;
        let reach = 2.0 * (met.root.across() + to.across) + rounding;
        if to.normal.is_nan() || met.normal.is_nan() {
            let farthest = 2.0 * (met.root.error + to.error) + rounding;
            return match off.length() {
                length if length <= reach => Self::End,
                length if length <= farthest => Self::PerhapsEnd,
                _ => Self::Elsewhere,
            };
        }
        let direction = ray.direction().normalize_or_zero();
        let is_in_plane = off.dot(to.normal).abs() <= reach;
        let is_steep = direction.dot(to.normal).abs() > GRAZING;
        if !is_in_plane {
            Self::Elsewhere
        } else if is_steep || off.length() <= 2.0 * reach {
            Self::End
        } else {
            Self::PerhapsEnd
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::construct::{self, Axis};
    use crate::geometry::{KnotVector, NurbsCurve, Surface, shapes};
    use crate::intersect::SurfaceBvh;

    /// A place on a surface, as a ray from the outside finds it.
    fn hit(bvh: &SurfaceBvh, from: DVec3, towards: DVec3) -> Option<Hit> {
        let ray = Ray::new(from, towards - from).ok()?;
        bvh.tracer().first_hit(&ray).hit
    }

    /// Points of a sphere, seen from inside.
    #[test]
    fn all_points_of_a_convex_body_see_each_other() {
        for size in [1e-6, 1.0, 1e6] {
            let bvh = SurfaceBvh::build(&[shapes::sphere(size).unwrap()]).unwrap();
            let places: Vec<Hit> = (0..60)
                .map(|k| {
                    let (sin, cos) = (2.4 * f64::from(k)).sin_cos();
                    let z = (f64::from(k) + 0.5) / 30.0 - 1.0;
                    let at = DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + z * DVec3::Z;
                    hit(&bvh, DVec3::ZERO, size * at).unwrap()
                })
                .collect();
            let mut tracer = bvh.tracer();
            for a in &places {
                for b in &places {
                    let seen = tracer.occluded_between(a, b);
                    assert_eq!(seen, Occlusion::default(), "{} to {}", a.point, b.point);
                }
            }
        }
    }

    /// Lamps on surfaces light what is on either side, up to what is really in the way.
    #[test]
    fn a_place_on_a_surface_is_seen() {
        let at = |z: f64, size: f64| {
            let lifted = DAffine3::from_translation(z * DVec3::Z);
            shapes::plane(size, size).unwrap().transformed(&lifted).unwrap()
        };
        let surfaces = [
            at(-2.0, 9.0).into(),
            at(0.0, 2.0).into(),
            at(-1.0, 0.1).into(),
            Surface::from(shapes::sphere(0.25).unwrap()),
        ];
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        let mut tracer = bvh.tracer();
        let open = Occlusion { occluded: false, doubtful: false };
        let hidden = Occlusion { occluded: true, doubtful: false };
        let mut by_range = 0;
        for k in 0..400 {
            let (x, y) = (f64::from(k % 20) / 5.0 - 1.9, f64::from(k / 20) / 5.0 - 1.9);
            let below = DVec3::new(x, y, -1.5);
            let from = hit(&bvh, below, below - DVec3::Z).unwrap();
            // On the ceiling, beside the ball that hangs through it.
            let lamp = DVec3::new(0.6, 0.3, 0.0);
            let middle = 0.5 * (lamp + from.point); // at the height of the small plate
            let shaded = middle.x.abs().max(middle.y.abs()) < 0.05;
            let expected = if shaded { hidden } else { open };
            assert_eq!(tracer.occluded_up_to(&from, lamp), expected, "{}", from.point);
            let ray = Ray::with_range(from.point, lamp - from.point, 0.0, 1.0).unwrap();
            by_range += usize::from(tracer.occluded(&Query::leaving(ray, &from)).doubtful);
            // Above the ceiling, and on the ball: its lower side is seen, where the small plate is
            // not in between, its other side is not.
            let above = tracer.occluded_up_to(&from, lamp + 1e-9 * DVec3::Z);
            assert_eq!(above, hidden);
            let on_ball = DVec3::new(0.15, 0.0, -0.2);
            let faces = on_ball.dot(from.point - on_ball) > 0.0;
            let share = (-1.0 - on_ball.z) / (from.point.z - on_ball.z);
            let at_plate = on_ball.lerp(from.point, share);
            let shaded = at_plate.x.abs().max(at_plate.y.abs()) < 0.05;
            let expected = if shaded || !faces { hidden } else { open };
            assert_eq!(tracer.occluded_up_to(&from, on_ball), expected, "{}", from.point);
        }
        assert!(by_range > 300, "{by_range}: the range alone would do");
    }

    /// The tip of a spike has no normal, and how far along a ray from above it was met is not
    /// known: that is no reason to look through a disk that hides it.
    #[test]
    fn a_disk_hides_the_tip_of_a_spike() {
        let profile = [[0.0, 1.0], [0.0, 0.0], [2.0, 0.0], [2.0, 2.0]];
        let points = profile.map(|[x, z]| DVec3::new(x, 0.0, z)).to_vec();
        let profile = NurbsCurve::new(KnotVector::bezier(3).unwrap(), points, None).unwrap();
        let axis = Axis::new(DVec3::ZERO, DVec3::Z).unwrap();
        let spike = || construct::revolve(&profile, &axis, 360.0).unwrap();
        let disk = |z| {
            let lifted = DAffine3::from_translation(z * DVec3::Z);
            shapes::disk(1.0).unwrap().transformed(&lifted).unwrap()
        };
        let hidden = SurfaceBvh::build(&[spike(), disk(3.0), disk(4.0)]).unwrap();
        let from = hit(&hidden, DVec3::new(0.1, 0.2, 5.0), DVec3::new(0.1, 0.2, 4.0)).unwrap();
        let tip = SurfaceBvh::build(&[spike()]).unwrap();
        let tip = hit(&tip, 2.0 * DVec3::Z, DVec3::Z).unwrap();
        assert!(tip.normal.is_nan());
        let seen = hidden.tracer().occluded_between(&from, &tip);
        assert!(seen.occluded, "{seen:?}");
        let back = hidden.tracer().occluded_between(&tip, &from);
        assert!(back.occluded || back.doubtful, "{back:?}");

        let open = SurfaceBvh::build(&[spike(), disk(4.0)]).unwrap();
        let seen = open.tracer().occluded_between(&from, &tip);
        assert!(!seen.occluded || seen.doubtful, "{seen:?}");
    }

    /// A hit's ray may have come from so far away that it was off by more than there is between two
    /// layers; the hit's point is known better.
    #[test]
    fn a_layer_hides_a_hit_that_was_found_from_afar() {
        let at = |z: f64| {
            let lifted = DAffine3::from_translation(z * DVec3::Z);
            shapes::plane(2.0, 2.0).unwrap().transformed(&lifted).unwrap()
        };
        for distance in [1.0, 1e3, 1e6, 1e9] {
            for gap in [1e-3, 1e-6, 1e-9, 1e-12] {
                let bvh = SurfaceBvh::build(&[at(0.0), at(gap), at(1.0)]).unwrap();
                let below = DVec3::new(0.1, 0.2, -distance);
                let to = hit(&bvh, below, below + DVec3::Z).unwrap();
                let above = DVec3::new(-0.3, 0.1, 2.0);
                let from = hit(&bvh, above, above - DVec3::Z).unwrap();
                assert_eq!((to.surface, from.surface), (0, 2));
                let mut tracer = bvh.tracer();
                for seen in
                    [tracer.occluded_between(&from, &to), tracer.occluded_between(&to, &from)]
                {
                    let hidden = Occlusion { occluded: true, doubtful: false };
                    assert_eq!(seen, hidden, "{distance:e}, {gap:e}");
                }
            }
        }
    }

    proptest! {
        /// A ball hides one plate from another where it is nearer to the line between two of their
        /// points than its radius.
        #[test]
        fn a_ball_between_two_plates(
            [ax, ay, bx, by] in [-3.0..3.0, -3.0..3.0, -3.0..3.0, -3.0..3.0f64],
        ) {
            let lifted = DAffine3::from_translation(2.0 * DVec3::Z);
            let middle = DAffine3::from_translation(DVec3::Z);
            let plate = || shapes::plane(6.0, 6.0).unwrap();
            let surfaces: Vec<Surface> = vec![
                plate().into(),
                plate().transformed(&lifted).unwrap().into(),
                shapes::sphere(0.5).unwrap().transformed(&middle).unwrap().into(),
            ];
            let bvh = SurfaceBvh::build(&surfaces).unwrap();
            let (a, b) = (DVec3::new(ax, ay, 0.0), DVec3::new(bx, by, 2.0));
            // From outside, straight through the plates.
            let from = hit(&bvh, a - DVec3::Z, a).unwrap();
            let to = hit(&bvh, b + DVec3::Z, b).unwrap();
            let nearest = (DVec3::Z - a).reject_from(b - a).length();
            prop_assume!((nearest - 0.5).abs() > 1e-9);
            let expected = Occlusion { occluded: nearest < 0.5, doubtful: false };
            prop_assert_eq!(bvh.tracer().occluded_between(&from, &to), expected);
            prop_assert_eq!(bvh.tracer().occluded_between(&to, &from), expected);
        }
    }
}
