//! The rays of each class, made from the surfaces' own geometry.

use glam::DVec3;
use nurbray::geometry::{Surface, SurfaceDerivatives};
use nurbray::intersect::{Query, Tracer};
use nurbray::math::Ray;

use super::super::random::Random;
use super::class::Class;
use super::sites::{Site, Sites};

/// The most tries for one ray. A try fails if its random numbers make no ray: a normal is
/// undefined, two points coincide, or a first ray misses. One ray in a thousand of a reasonable
/// model needs a second try.
const TRIES: u64 = 16;

/// How many sizes of the model away the rays of [`Class::Far`] start.
const FAR: f64 = 1e6;

/// A ray to trace, and what is known of the answer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shot {
    /// The ray, and the root it leaves, if it leaves one.
    pub(crate) query: Query,
    /// A point of a surface that the ray passes within rounding, and its `t`.
    pub(crate) target: Option<(Site, f64)>,
    /// Where the hit was found that the ray leaves.
    pub(crate) start: Option<Site>,
}

impl Shot {
    /// A ray of which nothing more is known.
    pub(crate) fn of(query: Query) -> Self {
        Self { query, target: None, start: None }
    }
}

/// Makes rays that are hard for one model: always the same ones for the same seed.
#[derive(Debug)]
pub(crate) struct RaySource<'a> {
    sites: Sites<'a>,
    seed: u64,
}

impl<'a> RaySource<'a> {
    /// A source of rays for these surfaces; `None` if there is no surface.
    pub(crate) fn new(surfaces: &'a [Surface], seed: u64) -> Option<Self> {
        Some(Self { sites: Sites::new(surfaces)?, seed })
    }

    /// The classes this model has rays of: poles need a collapsed edge, seams a border, and trim
    /// edges need trims.
    pub(crate) fn classes(&self) -> Vec<Class> {
        let exists = |class: &Class| match class {
            Class::Poles => self.sites.has_poles(),
            Class::Borders | Class::SeamPlanes => self.sites.has_borders(),
            Class::TrimEdges => self.sites.has_trim_edges(),
            _ => true,
        };
        Class::all().filter(exists).collect()
    }

    /// Ray `index` of a class. The tracer finds the hits that secondary rays leave.
    ///
    /// Returns `None` if no ray came out of several tries.
    pub(crate) fn shot(&self, class: Class, index: u64, tracer: &mut Tracer<'_>) -> Option<Shot> {
        (0..TRIES).find_map(|attempt| {
            let stream = class.stream() + (attempt << 32); // the first try is the plain stream
            let mut random = Random::new(self.seed, stream, index);
            match class {
                Class::Leaving => self.leaving(&mut random, tracer),
                _ => self.primary(class, &mut random),
            }
        })
    }

    fn primary(&self, class: Class, random: &mut Random) -> Option<Shot> {
        let sites = &self.sites;
        let ray = match class {
            Class::Aimed => return self.through(sites.anywhere(random), random),
            Class::Lengths => return self.of_any_length(random),
            Class::Ranges => return self.with_range(random),
            Class::Borders => {
                let border = sites.border(random)?;
                return self.through(sites.on_border(random, border), random);
            }
            Class::Lines => return self.through(sites.on_line(random), random),
            Class::TrimEdges => return self.through(sites.on_trim_edge(random)?, random),
            Class::Corners => return self.through(sites.on_corner(random), random),
            Class::Poles => return self.through(sites.on_pole(random)?, random),
            Class::Far => return self.far_away(random),
            Class::Random | Class::Leaving => self.random(random),
            Class::SeamPlanes => self.in_seam_plane(random),
            Class::Axes => self.along_axis(random),
            Class::Chords => {
                let [a, b] = sites.on_one_line(random).map(|site| sites.point(site));
                self.along(random, a, b - a)
            }
            Class::Grazing(k) => self.grazing(random, k),
            Class::Tangents => {
                let surface = sites.derivatives(sites.anywhere(random));
                let direction = tangent(&surface, random)?;
                self.along(random, surface.point, direction)
            }
            Class::Origins => {
                let site = self.anywhere_or_on_line(random);
                Ray::new(sites.point(site), random.direction()).ok()
            }
        };
        ray.map(|ray| Shot::of(Query::primary(ray)))
    }

    /// From a sphere of twice the model's radius to a point of its box.
    fn random(&self, random: &mut Random) -> Option<Ray> {
        let (center, half) = (self.sites.center(), self.sites.half_extent());
        let origin = center + 2.0 * self.sites.radius() * random.direction();
        let [x, y, z] = [(); 3].map(|()| random.between(-1.0, 1.0));
        Ray::new(origin, center + half * DVec3::new(x, y, z) - origin).ok()
    }

    /// Through a point of a surface in any direction.
    fn through(&self, site: Site, random: &mut Random) -> Option<Shot> {
        let direction = random.direction();
        self.shoot(site, random.between(0.01, 3.0) * self.sites.radius(), direction)
    }

    fn far_away(&self, random: &mut Random) -> Option<Shot> {
        let site = self.sites.anywhere(random);
        let direction = random.direction();
        self.shoot(site, FAR * self.sites.radius(), direction)
    }

    fn of_any_length(&self, random: &mut Random) -> Option<Shot> {
        let site = self.sites.anywhere(random);
        let direction = f64::powf(10.0, random.between(-8.0, 8.0)) * random.direction();
        let t = random.between(0.01, 3.0) * self.sites.radius() / direction.length();
        self.shoot(site, t, direction)
    }

    /// From before or behind a point of a surface, with a range that may begin behind the origin
    /// and end anywhere beyond the point.
    fn with_range(&self, random: &mut Random) -> Option<Shot> {
        let site = self.sites.anywhere(random);
        let direction = random.direction();
        let mut length = || random.between(0.01, 3.0) * self.sites.radius();
        let [back, before, beyond] = [length(), length(), length()];
        let t = back * random.sign();
        let t_min = if random.coin() { t - before } else { f64::NEG_INFINITY };
        let t_max = if random.coin() { t + beyond } else { f64::INFINITY };
        let shot = self.shoot(site, t, direction)?;
        let ray = *shot.query.ray();
        let ray = Ray::with_range(ray.origin(), ray.direction(), t_min, t_max).ok()?;
        Some(Shot { query: Query::primary(ray), ..shot })
    }

    /// A ray that passes a point of a surface at `t`.
    fn shoot(&self, site: Site, t: f64, direction: DVec3) -> Option<Shot> {
        let ray = Ray::new(self.sites.point(site) - t * direction, direction).ok()?;
        Some(Shot { target: Some((site, t)), ..Shot::of(Query::primary(ray)) })
    }

    /// Through a point, from up to three radii before it.
    fn along(&self, random: &mut Random, point: DVec3, direction: DVec3) -> Option<Ray> {
        let direction = direction.try_normalize()?;
        let back = random.between(0.01, 3.0) * self.sites.radius();
        Ray::new(point - back * direction, direction).ok()
    }

    /// A point of a surface; half of the time one where pieces meet or are halved.
    fn anywhere_or_on_line(&self, random: &mut Random) -> Site {
        if random.coin() { self.sites.anywhere(random) } else { self.sites.on_line(random) }
    }

    /// Through two points of the plane of three points of one border. If the border is a plane
    /// curve, the ray lies in its plane, and meets the surface only where that plane cuts it.
    fn in_seam_plane(&self, random: &mut Random) -> Option<Ray> {
        let border = self.sites.border(random)?;
        let [a, b, c] = [(); 3].map(|()| self.sites.point(self.sites.on_border(random, border)));
        let (b, c) = (b - a, c - a);
        if random.coin() {
            return self.along(random, a, b); // a chord of the border itself
        }
        let target = a + random.unit() * b + random.unit() * c;
        let direction = random.between(-1.0, 1.0) * b + random.between(-1.0, 1.0) * c;
        self.along(random, target, direction)
    }

    /// A ray parallel to an axis: through one point, or with one coordinate taken from a second
    /// point, so that the ray runs in faces and edges of the boxes around pieces and leaves.
    fn along_axis(&self, random: &mut Random) -> Option<Ray> {
        let [a, b] = [(); 2].map(|()| match random.coin() {
            true => self.sites.point(self.sites.on_corner(random)),
            false => self.sites.point(self.sites.anywhere(random)),
        });
        let axis = random.below(3);
        let mut direction = DVec3::ZERO;
        direction[axis] = random.sign();
        let mut origin = a;
        if random.coin() {
            origin[(axis + 1) % 3] = b[(axis + 1) % 3];
        }
        origin[axis] -= direction[axis] * random.between(0.01, 3.0) * self.sites.radius();
        Ray::new(origin, direction).ok()
    }

    /// Past the silhouette at a point: in a tangent direction, 10⁻ᵏ radii of curvature to the
    /// inside or the outside. On a sphere these are the rays at 1 ∓ 10⁻ᵏ radii of its centre.
    fn grazing(&self, random: &mut Random, k: u8) -> Option<Ray> {
        let surface = self.sites.derivatives(self.anywhere_or_on_line(random));
        let normal = surface.du.cross(surface.dv).try_normalize()?;
        let [a, b] = [(); 2].map(|()| random.between(-1.0, 1.0));
        let direction = a * surface.du + b * surface.dv;

        // The normal curvature in this direction: the second fundamental form over the first.
        let bend = a * a * surface.duu + 2.0 * a * b * surface.duv + b * b * surface.dvv;
        let curvature = normal.dot(bend) / direction.length_squared();
        let radius = (1.0 / curvature.abs()).min(self.sites.radius()); // flat: the model's size

        let towards_center = normal * curvature.signum();
        let offset = random.sign() * radius * f64::powi(10.0, -i32::from(k));
        self.along(random, surface.point + offset * towards_center, direction)
    }

    /// A ray that leaves the first hit of another, in any direction. Half of these hits are flat ones
    /// beside a line along which pieces meet, perhaps nearer than it is known where they are: if it
    /// is a crease, a ray may leave one of its sides and meet the other at once.
    fn leaving(&self, random: &mut Random, tracer: &mut Tracer<'_>) -> Option<Shot> {
        let first = if random.coin() {
            self.through(self.anywhere_or_on_line(random), random)?.query
        } else {
            Query::primary(self.flat_beside_line(random)?)
        };
        let hit = tracer.first_hit(&first).hit?;
        let ray = Ray::new(hit.point, random.direction()).ok()?;
        let start = Some(Site { surface: hit.surface as usize, uv: hit.uv });
        Some(Shot { start, ..Shot::of(Query::leaving(ray, &hit)) })
    }

    /// A ray that comes at an angle of 10⁻¹⁰ to 1 to the tangent plane, and meets it at 10⁻¹⁵ to
    /// 10⁻⁵ radii of the model from a line along which pieces meet.
    fn flat_beside_line(&self, random: &mut Random) -> Option<Ray> {
        let surface = self.sites.derivatives(self.sites.on_line(random));
        let normal = surface.du.cross(surface.dv).try_normalize()?;
        let beside = self.sites.radius() * random.power_of_ten(-15.0, -5.0);
        let point = surface.point + beside * tangent(&surface, random)?;
        let steep = random.sign() * random.power_of_ten(-10.0, 0.0);
        let direction = tangent(&surface, random)? + steep * normal;
        self.along(random, point, direction)
    }
}

/// A random unit vector in the tangent plane; `None` where there is no such plane.
fn tangent(surface: &SurfaceDerivatives, random: &mut Random) -> Option<DVec3> {
    surface.du.cross(surface.dv).try_normalize()?;
    let [a, b] = [(); 2].map(|()| random.between(-1.0, 1.0));
    (a * surface.du + b * surface.dv).try_normalize()
}

#[cfg(test)]
mod tests {
    use nurbray::geometry::{KnotVector, NurbsSurface, shapes};
    use nurbray::intersect::SurfaceBvh;

    use super::*;

    fn bvh(surfaces: &[Surface]) -> SurfaceBvh {
        SurfaceBvh::build(surfaces).unwrap()
    }

    #[test]
    fn every_class_has_rays_for_every_shape_at_every_size() {
        for scale in [1e-8, 1.0, 1e8] {
            let shapes = [
                shapes::sphere(scale),
                shapes::torus(3.0 * scale, scale),
                shapes::cylinder(scale, scale),
                shapes::plane(scale, scale),
            ];
            for shape in shapes {
                let surfaces = [shape.unwrap().into()];
                let bvh = bvh(&surfaces);
                let mut tracer = bvh.tracer();
                let source = RaySource::new(&surfaces, 1).unwrap();
                for class in source.classes() {
                    let made = (0..20).filter(|&i| source.shot(class, i, &mut tracer).is_some());
                    assert_eq!(made.count(), 20, "{} at {scale}", class.name());
                }
            }
        }
    }

    #[test]
    fn only_models_with_poles_have_rays_through_them() {
        let has_poles = |surface| {
            let surfaces = [surface];
            RaySource::new(&surfaces, 0).unwrap().classes().contains(&Class::Poles)
        };
        assert!(has_poles(shapes::sphere(1.0).unwrap().into()));
        assert!(has_poles(shapes::cone(1.0, 1.0).unwrap().into()));
        assert!(!has_poles(shapes::torus(3.0, 1.0).unwrap().into()));
        assert!(!has_poles(shapes::plane(1.0, 1.0).unwrap().into()));
    }

    #[test]
    fn random_rays_are_aimed_at_the_surface_not_at_far_control_points() {
        // The middle control point is 100 up, the surface at most 25.
        let height = |i: usize| if i == 4 { 100.0 } else { 0.0 };
        let control = (0..9).map(|i| DVec3::new((i / 3) as f64, (i % 3) as f64, height(i)));
        let knots = || KnotVector::bezier(2).unwrap();
        let hump = NurbsSurface::new(knots(), knots(), control.collect(), None).unwrap();
        let surfaces = [hump.into()];
        let sites = Sites::new(&surfaces).unwrap();
        assert!((sites.half_extent().z - 12.5).abs() < 0.1, "{}", sites.half_extent());
    }

    #[test]
    fn the_seed_and_the_index_make_the_ray() {
        let surfaces = [shapes::sphere(1.0).unwrap().into()];
        let bvh = bvh(&surfaces);
        let mut tracer = bvh.tracer();
        let mut ray = |seed, index| {
            let source = RaySource::new(&surfaces, seed).unwrap();
            *source.shot(Class::Aimed, index, &mut tracer).unwrap().query.ray()
        };
        assert_eq!(ray(1, 2), ray(1, 2));
        assert_ne!(ray(1, 2), ray(1, 3));
        assert_ne!(ray(1, 2), ray(2, 2));
    }

    #[test]
    fn aimed_rays_pass_their_target_within_rounding() {
        let surfaces = [shapes::sphere(1.0).unwrap().into()];
        let bvh = bvh(&surfaces);
        let mut tracer = bvh.tracer();
        let source = RaySource::new(&surfaces, 3).unwrap();
        for class in [Class::Aimed, Class::Lengths, Class::Borders, Class::Corners, Class::Poles] {
            for index in 0..100 {
                let shot = source.shot(class, index, &mut tracer).unwrap();
                let (site, t) = shot.target.unwrap();
                let off = shot.query.ray().at(t).distance(surfaces[0].point_at(site.uv));
                assert!(off < 4e-15, "{} {index}: {off}", class.name());
            }
        }
    }

    #[test]
    fn on_a_sphere_grazing_rays_pass_its_center_at_one_radius_more_or_less() {
        let surfaces = [shapes::sphere(2.0).unwrap().into()];
        let bvh = bvh(&surfaces);
        let mut tracer = bvh.tracer();
        let source = RaySource::new(&surfaces, 4).unwrap();
        for k in 1..=10 {
            for index in 0..50 {
                let ray = *source.shot(Class::Grazing(k), index, &mut tracer).unwrap().query.ray();
                let distance = ray.origin().cross(ray.direction()).length();
                let off = (distance / 2.0 - 1.0).abs();
                let wanted = f64::powi(10.0, -i32::from(k));
                assert!((off - wanted).abs() < 1e-14, "{k} {index}: {off}");
            }
        }
    }

    #[test]
    fn rays_of_seam_planes_lie_in_the_plane_of_a_plane_border() {
        let surfaces = [shapes::sphere(1.0).unwrap().into()];
        let bvh = bvh(&surfaces);
        let mut tracer = bvh.tracer();
        let source = RaySource::new(&surfaces, 5).unwrap();
        // The seam is half of a great circle from pole to pole; its plane is that of two of
        // its points and the centre.
        let [a, b] = [0.2, 0.4].map(|share| {
            let [u, v] = surfaces[0].domain();
            surfaces[0].point_at(glam::DVec2::new(u[0] + share * (u[1] - u[0]), v[0]))
        });
        let normal = a.cross(b).normalize();
        let in_plane =
            (0..100).filter_map(|index| source.shot(Class::SeamPlanes, index, &mut tracer));
        for shot in in_plane {
            let ray = shot.query.ray();
            assert!(normal.dot(ray.origin()).abs() < 1e-13, "{ray:?}");
            assert!(normal.dot(ray.direction()).abs() < 1e-12, "{ray:?}");
        }
    }
}
