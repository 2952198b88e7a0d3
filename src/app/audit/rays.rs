//! The rays of each class, made from the surfaces' own geometry.

use glam::DVec3;
use nurbray::geometry::{NurbsSurface, SurfaceDerivatives};
use nurbray::intersect::{Query, Tracer};
use nurbray::math::Ray;

use super::class::Class;
use super::random::Random;
use super::sites::{Site, Sites};

/// How often a ray is tried anew whose random numbers make none: a normal that is undefined, two
/// points that coincide, a first ray that misses. One ray in a thousand of a reasonable model
/// needs a second try.
const TRIES: u64 = 16;

/// How many sizes of the model away the rays of [`Class::Far`] start.
const FAR: f64 = 1e6;

/// Makes rays that are hard for one model: always the same ones for the same seed.
#[derive(Debug)]
pub(crate) struct RaySource<'a> {
    sites: Sites<'a>,
    seed: u64,
}

impl<'a> RaySource<'a> {
    /// A source of rays for these surfaces; `None` if there is no surface.
    pub(crate) fn new(surfaces: &'a [NurbsSurface], seed: u64) -> Option<Self> {
        Some(Self { sites: Sites::new(surfaces)?, seed })
    }

    /// The classes this model has rays of: without a collapsed edge there are no poles.
    pub(crate) fn classes(&self) -> Vec<Class> {
        Class::all().filter(|&class| class != Class::Poles || self.sites.has_poles()).collect()
    }

    /// Ray `index` of a class. The tracer finds the hits that secondary rays leave.
    ///
    /// Returns `None` if no ray came out of several tries.
    pub(crate) fn query(&self, class: Class, index: u64, tracer: &mut Tracer<'_>) -> Option<Query> {
        (0..TRIES).find_map(|attempt| {
            let stream = class.stream() + (attempt << 32); // the first try is the plain stream
            let mut random = Random::new(self.seed, stream, index);
            match class {
                Class::Leaving => self.leaving(&mut random, tracer),
                _ => self.ray(class, &mut random).map(Query::primary),
            }
        })
    }

    fn ray(&self, class: Class, random: &mut Random) -> Option<Ray> {
        let sites = &self.sites;
        match class {
            Class::Random | Class::Leaving => self.random(random),
            Class::Aimed => self.through(random, sites.anywhere(random)),
            Class::Lengths => self.of_any_length(random),
            Class::Borders => self.through(random, sites.on_border(random).1),
            Class::Lines => self.through(random, sites.on_line(random)),
            Class::Corners => self.through(random, sites.on_corner(random)),
            Class::Poles => self.through(random, sites.on_pole(random)?),
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
                let site = if random.coin() { sites.anywhere(random) } else { sites.on_line(random) };
                Ray::new(sites.point(site), random.direction()).ok()
            }
            Class::Far => {
                let target = sites.point(sites.anywhere(random));
                let direction = random.direction();
                Ray::new(target - FAR * sites.radius() * direction, direction).ok()
            }
        }
    }

    /// From a sphere of twice the model's radius to a point of its bounding box.
    fn random(&self, random: &mut Random) -> Option<Ray> {
        let (centre, half) = (self.sites.centre(), self.sites.half_extent());
        let origin = centre + 2.0 * self.sites.radius() * random.direction();
        let [x, y, z] = [(); 3].map(|()| random.between(-1.0, 1.0));
        Ray::new(origin, centre + half * DVec3::new(x, y, z) - origin).ok()
    }

    fn through(&self, random: &mut Random, site: Site) -> Option<Ray> {
        let direction = random.direction();
        self.along(random, self.sites.point(site), direction)
    }

    /// Through a point, from up to three radii before it.
    fn along(&self, random: &mut Random, point: DVec3, direction: DVec3) -> Option<Ray> {
        let direction = direction.try_normalize()?;
        let back = random.between(0.01, 3.0) * self.sites.radius();
        Ray::new(point - back * direction, direction).ok()
    }

    fn of_any_length(&self, random: &mut Random) -> Option<Ray> {
        let ray = self.through(random, self.sites.anywhere(random))?;
        let length = f64::powf(10.0, random.between(-8.0, 8.0));
        Ray::new(ray.origin(), length * ray.direction()).ok()
    }

    /// Through two points of the plane of three points of one border. If the border is a plane
    /// curve, the ray lies in its plane, and meets the surface on the border or not at all.
    fn in_seam_plane(&self, random: &mut Random) -> Option<Ray> {
        let (border, first) = self.sites.on_border(random);
        let a = self.sites.point(first);
        let [b, c] = [(); 2].map(|()| self.sites.along(random, &border)).map(|t| {
            let point = self.sites.point(border.site(t));
            point - a
        });
        if random.coin() {
            return self.along(random, a, b); // a chord of the border itself
        }
        let target = a + random.unit() * b + random.unit() * c;
        let direction = random.between(-1.0, 1.0) * b + random.between(-1.0, 1.0) * c;
        self.along(random, target, direction)
    }

    /// Parallel to an axis: through one point, or with one coordinate of each of two points, so
    /// that the ray runs in faces and edges of the boxes around pieces and leaves.
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
        let site = if random.coin() {
            self.sites.anywhere(random)
        } else {
            self.sites.on_line(random)
        };
        let surface = self.sites.derivatives(site);
        let normal = surface.du.cross(surface.dv).try_normalize()?;
        let [a, b] = [(); 2].map(|()| random.between(-1.0, 1.0));
        let direction = a * surface.du + b * surface.dv;

        // The normal curvature in this direction: the second fundamental form over the first.
        let bend = a * a * surface.duu + 2.0 * a * b * surface.duv + b * b * surface.dvv;
        let curvature = normal.dot(bend) / direction.length_squared();
        let radius = (1.0 / curvature.abs()).min(self.sites.radius()); // flat: the model's size

        let towards_centre = normal * curvature.signum();
        let offset = random.sign() * radius * f64::powi(10.0, -i32::from(k));
        self.along(random, surface.point + offset * towards_centre, direction)
    }

    /// A ray that leaves the first hit of another, in any direction.
    fn leaving(&self, random: &mut Random, tracer: &mut Tracer<'_>) -> Option<Query> {
        let site = if random.coin() {
            self.sites.anywhere(random)
        } else {
            self.sites.on_line(random)
        };
        let primary = self.through(random, site)?;
        let hit = tracer.first_hit(&Query::primary(primary)).hit?;
        let ray = Ray::new(hit.point, random.direction()).ok()?;
        Some(Query::leaving(ray, &hit))
    }
}

/// A random unit vector in the tangent plane; `None` where there is no such plane.
fn tangent(surface: &SurfaceDerivatives, random: &mut Random) -> Option<DVec3> {
    surface.du.cross(surface.dv).try_normalize()?;
    let [a, b] = [(); 2].map(|()| random.between(-1.0, 1.0));
    (a * surface.du + b * surface.dv).try_normalize()
}
