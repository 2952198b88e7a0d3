//! Rays past the corners of closed bodies of trimmed planes: each enters as often as it leaves, or
//! is in doubt.

use std::f64::consts::PI;

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};
use nurbray::geometry::trim::{Kept, TrimLoop};
use nurbray::geometry::{KnotVector, NurbsSurface, Surface};
use nurbray::intersect::{Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::ask::{build, trimmed};
use crate::random::Random;

/// A body with flat faces, whose corners are given by their places among its vertices.
struct Body {
    vertices: Vec<DVec3>,
    faces: Vec<Vec<usize>>,
}

impl Body {
    fn tetrahedron() -> Self {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [3, 1, 2]];
        Self { vertices, faces: faces.map(Vec::from).to_vec() }
    }

    /// Triangles from a star to a point above it, and the star.
    fn spiked(spikes: usize) -> Self {
        let count = 2 * spikes;
        let around = |k: usize| {
            let radius = [1.0, 0.4][k % 2];
            (radius * DVec2::from_angle(PI * k as f64 / spikes as f64)).extend(0.0)
        };
        let vertices = (0..count).map(around).chain([DVec3::Z]).collect();
        let sides = (0..count).map(|k| vec![count, k, (k + 1) % count]);
        Self { vertices, faces: sides.chain([(0..count).rev().collect()]).collect() }
    }

    /// Triangles from a star to a point above and to one below it.
    fn spindle(spikes: usize) -> Self {
        let Self { mut vertices, mut faces } = Self::spiked(spikes);
        let count = 2 * spikes;
        faces.truncate(count);
        faces.extend((0..count).map(|k| vec![count + 1, (k + 1) % count, k]));
        vertices.push(DVec3::NEG_Z);
        Self { vertices, faces }
    }

    /// Two pyramids, base on base.
    fn double_pyramid(sides: usize) -> Self {
        let around = |k: usize| DVec2::from_angle(2.0 * PI * k as f64 / sides as f64).extend(0.0);
        let vertices = (0..sides).map(around).chain([DVec3::Z, DVec3::NEG_Z]).collect();
        let both = |k: usize| {
            let next = (k + 1) % sides;
            [vec![sides, k, next], vec![sides + 1, next, k]]
        };
        Self { vertices, faces: (0..sides).flat_map(both).collect() }
    }

    fn placed(mut self, map: DAffine3) -> Self {
        self.vertices.iter_mut().for_each(|vertex| *vertex = map.transform_point3(*vertex));
        self
    }

    /// Its faces, each cut out of a larger parallelogram.
    fn surfaces(&self, random: &mut Random) -> Vec<Surface> {
        let face = |face: &Vec<usize>| {
            let corners: Vec<DVec3> = face.iter().map(|&k| self.vertices[k]).collect();
            cut_out(&corners, random)
        };
        self.faces.iter().map(face).collect()
    }

    /// A corner, and the unit vector along an edge from it.
    fn corner(&self, random: &mut Random) -> (DVec3, DVec3) {
        let face = &self.faces[random.below(self.faces.len())];
        let k = random.below(face.len());
        let [at, next] = [face[k], face[(k + 1) % face.len()]].map(|k| self.vertices[k]);
        (at, (next - at).normalize())
    }
}

fn cut_out(corners: &[DVec3], random: &mut Random) -> Surface {
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let turns = |k: usize| {
        let next = corners[(k + 1) % corners.len()];
        (corners[k] - middle).cross(next - middle)
    };
    let normal = (0..corners.len()).map(turns).sum::<DVec3>().normalize();
    let size = corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
    let turned = |angle: f64, v: DVec3| DQuat::from_axis_angle(normal, angle) * v;
    let u = turned(random.between(0.0, 7.0), (corners[0] - middle).normalize());
    let v = turned(random.between(0.9, 2.2), u);
    let long = size / u.cross(v).length();
    let [u, v] = [u, v].map(|along| long * random.between(1.5, 3.0) * along);
    let steps = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
    let net = steps.map(|(a, b)| middle + a * u + b * v).to_vec();
    let knots = || KnotVector::bezier(1).unwrap();
    let plane = NurbsSurface::new(knots(), knots(), net, None).unwrap();
    let to_plane = DMat3::from_cols(u, v, normal).inverse();
    let place = |corner: &DVec3| 0.5 + 0.5 * (to_plane * (*corner - middle)).truncate();
    let places: Vec<DVec2> = corners.iter().map(place).collect();
    trimmed(plane, Kept::Odd, &[TrimLoop::polygon(&places).unwrap()]).into()
}

/// What is said of the rays past the corners of a body.
#[derive(Debug, Default)]
struct Told {
    odd: usize,
    doubtful: usize,
    rays: usize,
}

impl Told {
    fn doubt(&self) -> f64 {
        self.doubtful as f64 / self.rays as f64
    }
}

/// Asks about rays from outside that pass beside an edge by up to a few roundings `unit`, at a
/// distance of `from` to `to` roundings from its corner.
fn told(body: &Body, bvh: &SurfaceBvh, [from, to]: [f64; 2], rays: usize) -> Told {
    let mut random = Random::new(23);
    let mut tracer = bvh.tracer();
    let (mut told, mut hits) = (Told { rays, ..Told::default() }, Vec::new());
    let magnitude = body.vertices.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
    for _ in 0..rays {
        let (corner, edge) = body.corner(&mut random);
        let (direction, away) = (random.direction(), random.between(3.0, 8.0));
        // C ε M of bilinear surfaces.
        let unit = 12.0 * f64::EPSILON * (magnitude + away);
        let along = unit * random.power_of_ten(from.log10(), to.log10());
        let aside = unit * random.power_of_ten(-1.5, 0.7);
        let target = corner + along * edge + aside * random.perpendicular(direction);
        let origin = corner - away * direction;
        let ray = Ray::new(origin, target - origin).unwrap();
        let doubtful = tracer.all_hits(&Query::primary(ray), &mut hits);
        let leaves = hits.iter().map(|hit| hit.normal.dot(ray.direction()).signum());
        told.doubtful += usize::from(doubtful);
        told.odd += usize::from(!doubtful && leaves.sum::<f64>() != 0.0);
    }
    told
}

#[test]
fn rays_past_corners_enter_as_often_as_they_leave() {
    let turned = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.1);
    let map = DAffine3::from_scale_rotation_translation(
        DVec3::splat(1.3),
        turned,
        DVec3::new(0.3, -0.2, 0.4),
    );
    let mut random = Random::new(22);
    for (name, body) in [
        ("tetrahedron", Body::tetrahedron()),
        ("star", Body::spiked(5)),
        ("spindle", Body::spindle(3)),
        ("octahedron", Body::double_pyramid(4)),
        ("double pyramid", Body::double_pyramid(7)),
    ] {
        let body = body.placed(map);
        let bvh = build(&body.surfaces(&mut random));
        for range in [[0.1, 1.0], [1.0, 10.0], [10.0, 100.0], [100.0, 1000.0]] {
            let told = told(&body, &bvh, range, 12_000);
            println!("{name}, {range:?}: {told:?}");
            assert_eq!(told.odd, 0, "{name}, {range:?}: {told:?}");
        }
        // Along the edges, far from their corners.
        let told = told(&body, &bvh, [1e9, 1e10], 12_000);
        assert!(told.odd == 0 && told.doubt() < 0.05, "{name}: {told:?}");
    }
}
