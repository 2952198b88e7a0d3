//! Rays that are hard to answer, by class, made from the surfaces' own geometry.

use std::fmt;

use glam::{DVec2, DVec3};
use nurbray::geometry::{Chart, Charts, SurfaceDerivatives};
use nurbray::math::Ray;

use crate::model::Model;
use crate::random::Random;

/// A kind of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// Between any two points of the bounding box, widened.
    Random,
    /// From outside to any point of a surface.
    Aimed,
    /// As `Aimed`, with a direction of any length from 1e-200 to 1e200.
    Lengths,
    /// To points on knot lines and on lines along which pieces are halved.
    Lines,
    /// To points where two such lines cross, the corners of surfaces among them.
    Corners,
    /// To points of the four borders: seams, free edges, poles.
    Borders,
    /// In the plane of three points of a border or knot line, to one of them.
    SeamPlanes,
    /// Parallel to an axis, through points of surfaces or in the faces of their boxes.
    Axes,
    /// Through two points of one iso-parameter line.
    Rulings,
    /// Past a point at `1 − 10⁻ᵏ` radii of curvature, so that they just enter.
    Entering(i32),
    /// Past a point at `1 + 10⁻ᵏ` radii of curvature, so that they just stay outside.
    Passing(i32),
    /// In the tangent plane of a point, through the point.
    Tangents,
    /// Starting on a surface.
    Origins,
    /// As `Aimed`, from a million sizes away.
    Far,
}

impl Class {
    pub(crate) fn all() -> Vec<Self> {
        let mut all = vec![
            Self::Random,
            Self::Aimed,
            Self::Lengths,
            Self::Lines,
            Self::Corners,
            Self::Borders,
            Self::SeamPlanes,
            Self::Axes,
            Self::Rulings,
            Self::Tangents,
            Self::Origins,
            Self::Far,
        ];
        all.extend((1..=10).flat_map(|k| [Self::Entering(k), Self::Passing(k)]));
        all
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&format!("{self:?}"))
    }
}

/// A place on a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    pub(crate) surface: usize,
    pub(crate) u: f64,
    pub(crate) v: f64,
}

/// A place on a chart, by the chart's own parameters.
#[derive(Clone, Copy, Debug)]
struct Place {
    chart: usize,
    u: f64,
    v: f64,
}

/// A ray, and the place it was aimed at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shot {
    pub(crate) ray: Ray,
    /// A point of a surface that the ray passes within rounding, and its `t`.
    pub(crate) target: Option<(Site, f64)>,
}

/// Makes rays for a model.
pub(crate) struct Rays<'a> {
    model: &'a Model,
    /// All charts, with the surface each belongs to.
    charts: Vec<(usize, Chart<'a>)>,
    center: DVec3,
    radius: f64,
    half: DVec3,
}

impl<'a> Rays<'a> {
    pub(crate) fn new(model: &'a Model) -> Self {
        let (low, high) = model.bounds();
        let surfaces = model.surfaces.iter().enumerate();
        let charts =
            surfaces.flat_map(|(k, surface)| surface.charts().into_iter().map(move |c| (k, c)));
        let (center, radius, half) = (model.center(), model.radius(), 0.5 * (high - low));
        Self { model, charts: charts.collect(), center, radius, half }
    }

    /// A ray of a class; random numbers that make none are thrown away.
    pub(crate) fn shot(&self, class: Class, random: &mut Random) -> Shot {
        loop {
            if let Some(shot) = self.try_shot(class, random) {
                return shot;
            }
        }
    }

    fn try_shot(&self, class: Class, random: &mut Random) -> Option<Shot> {
        match class {
            Class::Random => {
                let [from, to] = [0, 1].map(|_| self.center + 1.2 * self.half * random.cube());
                untargeted(from, to - from)
            }
            Class::Aimed => self.aimed(self.anywhere(random), random, 1.0),
            Class::Lengths => {
                let length = random.power_of_ten(-200.0, 200.0);
                self.aimed(self.anywhere(random), random, length)
            }
            Class::Lines => self.aimed(self.on_line(random), random, 1.0),
            Class::Corners => self.aimed(self.on_corner(random), random, 1.0),
            Class::Borders => self.aimed(self.on_border(random), random, 1.0),
            Class::SeamPlanes => self.in_seam_plane(random),
            Class::Axes => self.along_axis(random),
            Class::Rulings => self.along_ruling(random),
            Class::Entering(k) => self.grazing(f64::powi(10.0, -k), random),
            Class::Passing(k) => self.grazing(-f64::powi(10.0, -k), random),
            Class::Tangents => self.grazing(0.0, random),
            Class::Origins => {
                let sites = [self.anywhere(random), self.on_corner(random)];
                let site = random.pick(&sites);
                untargeted(self.point(site), self.radius * random.direction())
            }
            Class::Far => {
                let sites = [self.anywhere(random), self.on_corner(random)];
                let site = random.pick(&sites);
                let from = self.center + 1e6 * self.radius * random.direction();
                self.towards(site, from, 1.0)
            }
        }
    }

    fn aimed(&self, site: Place, random: &mut Random, length: f64) -> Option<Shot> {
        let distance = self.radius * random.between(0.3, 4.0);
        self.towards(site, self.center + distance * random.direction(), length)
    }

    /// From a point to a site; the direction's length is `length` times their distance.
    fn towards(&self, site: Place, from: DVec3, length: f64) -> Option<Shot> {
        let ray = Ray::new(from, (self.point(site) - from) * length).ok()?;
        Some(Shot { ray, target: Some((self.site(site), 1.0 / length)) })
    }

    fn in_seam_plane(&self, random: &mut Random) -> Option<Shot> {
        let sites = [self.on_border(random), self.on_line(random)];
        let site = random.pick(&sites);
        let along_u = random.below(2) == 0;
        let mut others = [site; 2];
        for other in &mut others {
            let within = self.anywhere_on(site.chart, random);
            if along_u {
                other.u = within.u;
            } else {
                other.v = within.v;
            }
        }
        let [p, a, b] = [site, others[0], others[1]].map(|site| self.point(site));
        let distance = self.radius * random.between(-3.0, 3.0);
        let across = ((a - p) * random.between(-1.0, 1.0) + (b - p) * random.between(-1.0, 1.0))
            .try_normalize()?;
        self.towards(site, p + distance * across, 1.0)
    }

    fn along_axis(&self, random: &mut Random) -> Option<Shot> {
        let axis = random.below(3);
        let mut direction = DVec3::ZERO;
        direction[axis] = random.sign();
        let distance = self.radius * random.between(0.5, 3.0);
        if random.below(2) == 0 {
            let sites = [self.on_line(random), self.on_corner(random)];
            let site = random.pick(&sites);
            // Whole steps along an axis leave the other coordinates as they are.
            let from = self.point(site) - distance * direction;
            let mut shot = self.towards(site, from, 1.0)?;
            shot.ray = Ray::new(from, direction).ok()?;
            shot.target =
                Some((self.site(site), (self.point(site)[axis] - from[axis]) * direction[axis]));
            return Some(shot);
        }
        let grid = DVec3::from_array([0; 3].map(|_| random.below(9) as f64 / 4.0 - 1.0));
        let mut from = self.center + grid * self.half;
        from[axis] -= distance * direction[axis];
        untargeted(from, direction)
    }

    fn along_ruling(&self, random: &mut Random) -> Option<Shot> {
        let site = self.anywhere(random);
        let within = self.anywhere_on(site.chart, random);
        let other = match random.below(2) {
            0 => Place { u: within.u, ..site },
            _ => Place { v: within.v, ..site },
        };
        let (a, b) = (self.point(site), self.point(other));
        let before = (b - a).try_normalize()? * self.radius * random.between(0.0, 2.0);
        untargeted(a - before, b - a)
    }

    /// Along a tangent of a surface, `depth` radii of curvature below it: on the side of its
    /// centre of curvature.
    fn grazing(&self, depth: f64, random: &mut Random) -> Option<Shot> {
        let sites = [self.anywhere(random), self.on_line(random)];
        let site = random.pick(&sites);
        let at = self.derivatives(site);
        let normal = at.du.cross(at.dv).try_normalize()?;
        let (x, y) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        let tangent = x * at.du + y * at.dv;
        let bend = normal.dot(x * x * at.duu + 2.0 * x * y * at.duv + y * y * at.dvv);
        let curvature = bend / tangent.length_squared();
        // Nearly flat places count as spheres of the model's size.
        let curvature = curvature.signum() * curvature.abs().max(1.0 / self.radius);
        let target = at.point + depth / curvature * normal;
        let direction = tangent.try_normalize()?;
        let from = target - direction * self.radius * random.between(0.5, 3.0);
        untargeted(from, direction)
    }

    /// The place on the whole surface.
    fn site(&self, place: Place) -> Site {
        let (surface, chart) = &self.charts[place.chart];
        let uv = chart.uv(DVec2::new(place.u, place.v));
        Site { surface: *surface, u: uv.x, v: uv.y }
    }

    fn point(&self, place: Place) -> DVec3 {
        let Site { surface, u, v } = self.site(place);
        self.model.surfaces[surface].point_at(DVec2::new(u, v))
    }

    fn derivatives(&self, place: Place) -> SurfaceDerivatives {
        let Site { surface, u, v } = self.site(place);
        self.model.surfaces[surface].derivatives(DVec2::new(u, v))
    }

    fn anywhere(&self, random: &mut Random) -> Place {
        let chart = random.below(self.charts.len());
        self.anywhere_on(chart, random)
    }

    fn anywhere_on(&self, chart: usize, random: &mut Random) -> Place {
        let [[u0, u1], [v0, v1]] = self.charts[chart].1.surface.domain();
        Place { chart, u: random.between(u0, u1), v: random.between(v0, v1) }
    }

    fn on_line(&self, random: &mut Random) -> Place {
        let site = self.anywhere(random);
        let corner = self.division(site, random);
        match random.below(2) {
            0 => Place { u: corner.u, ..site },
            _ => Place { v: corner.v, ..site },
        }
    }

    fn on_corner(&self, random: &mut Random) -> Place {
        let site = self.anywhere(random);
        self.division(site, random)
    }

    fn on_border(&self, random: &mut Random) -> Place {
        let site = self.anywhere(random);
        let [u, v] = self.charts[site.chart].1.surface.domain();
        match random.below(4) {
            0 => Place { u: u[0], ..site },
            1 => Place { u: u[1], ..site },
            2 => Place { v: v[0], ..site },
            _ => Place { v: v[1], ..site },
        }
    }

    /// Both parameters moved to knots, or to points that halve a span up to four times.
    fn division(&self, site: Place, random: &mut Random) -> Place {
        let surface = &self.charts[site.chart].1.surface;
        let [u, v] = [surface.knots_u(), surface.knots_v()].map(|knots| {
            let spans: Vec<_> = knots.spans().map(|span| (span.start, span.end)).collect();
            let (start, end) = random.pick(&spans);
            let parts = 1 << random.below(5);
            let part = random.below(parts + 1) as f64 / parts as f64;
            if part == 1.0 { end } else { start + part * (end - start) }
        });
        Place { u, v, ..site }
    }
}

fn untargeted(from: DVec3, direction: DVec3) -> Option<Shot> {
    Some(Shot { ray: Ray::new(from, direction).ok()?, target: None })
}
