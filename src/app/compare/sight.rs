//! What each pixel sees: the surface itself, or triangles in its place.

use glam::DVec3;
use nurbray::intersect::{Answer, SurfaceBvh};
use nurbray::io::EmbreeHit;
use nurbray::io::mesh::GridMesh;
use nurbray::math::Ray;
use rayon::prelude::*;

use super::super::race::Rays;

/// Rays a thread takes at a time; it changes no answer.
const CHUNK: usize = 4096;

/// Rounding of the distances that Embree finds in f32, relative: its sums of a few products lose a
/// few ulp.
const F32_ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// The same of distances from where a ray begins, in f64.
const F64_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// What one ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sight {
    /// How far away it is, in scene units.
    pub(super) distance: f64,
    /// Where, on the ray.
    pub(super) point: DVec3,
    /// The unit normal, interpolated on a triangle; NaN where there is none.
    pub(super) normal: DVec3,
    /// The unit normal of the triangle hit; on a surface, the same as `normal`.
    pub(super) facet: DVec3,
    /// How far off rounding may have put a triangle's distance; 0 for a surface, which is the
    /// truth.
    pub(super) rounding: f64,
    /// The distance from the ray of the surface point at the reported `(u, v)`; 0 for a
    /// triangle, which has no such point.
    pub(super) residual: f64,
}

/// What a ray meets on the surfaces, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum View {
    /// This hit, or a miss.
    Known(Option<Sight>),
    /// Floating point could not decide: the rival cannot be blamed for another answer.
    Doubtful,
}

impl View {
    fn new(answer: &Answer, ray: &Ray) -> Self {
        match answer.doubtful {
            true => Self::Doubtful,
            false => Self::Known(on_surface(answer, ray)),
        }
    }

    /// The hit, if there is one for certain.
    pub(super) fn sight(&self) -> Option<&Sight> {
        match self {
            Self::Known(sight) => sight.as_ref(),
            Self::Doubtful => None,
        }
    }
}

/// How many views are doubtful.
pub(super) fn doubtful(views: &[View]) -> usize {
    views.iter().filter(|&&view| view == View::Doubtful).count()
}

/// What the rays meet on the surfaces.
pub(super) fn exact(bvh: &SurfaceBvh, rays: &Rays) -> Vec<View> {
    let (queries, coherence) = (&rays.queries[..], rays.neighbours.first_hits);
    let chunks = queries.par_chunks(CHUNK).map(|queries| {
        let mut answers = Vec::new();
        bvh.tracer().first_hits(queries, coherence, &mut answers);
        answers
    });
    let answers = chunks.collect::<Vec<_>>().concat();
    let both = answers.iter().zip(queries);
    both.map(|(answer, query)| View::new(answer, query.ray())).collect()
}

/// What a ray meets on a surface.
pub(super) fn on_surface(answer: &Answer, ray: &Ray) -> Option<Sight> {
    let hit = answer.hit?;
    let point = ray.at(hit.t);
    Some(Sight {
        distance: hit.t * ray.direction().length(),
        point,
        normal: hit.normal,
        facet: hit.normal,
        rounding: 0.0,
        residual: point.distance(hit.point),
    })
}

/// What a ray meets on triangles, which have the normals of the surfaces.
pub(super) fn on_mesh(hit: &EmbreeHit, ray: &Ray, meshes: &[GridMesh]) -> Sight {
    let vertex = hit.on(meshes);
    let unit = ray.direction().length();
    Sight {
        distance: hit.t * unit,
        point: ray.at(hit.t),
        normal: vertex.map_or(DVec3::NAN, |vertex| vertex.normal),
        facet: hit.geometric_normal.normalize_or(DVec3::NAN),
        rounding: unit * (F32_ROUNDING * (hit.t - hit.start) + F64_ROUNDING * hit.t),
        residual: 0.0,
    }
}

impl Sight {
    /// The sine of the angle between a ray and the surface; 1 where there is no normal.
    pub(super) fn incidence(&self, ray: &Ray) -> f64 {
        let sine = (self.normal.dot(ray.direction()) / ray.direction().length()).abs();
        if sine.is_nan() { 1.0 } else { sine }
    }
}

/// The angle between two unit normals in degrees, whichever sides they point to.
///
/// Computed from the chord between them, at most √2: the arc cosine has no digits left for small
/// angles. NaN if either normal is.
pub(super) fn degrees(a: DVec3, b: DVec3) -> f64 {
    let chord = (a - b).length().min((a + b).length());
    2.0 * (0.5 * chord).asin().to_degrees()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use nurbray::geometry::shapes;
    use nurbray::intersect::Query;
    use nurbray::io::EmbreePart;
    use nurbray::io::mesh::TessellationPlan;

    use super::*;

    #[test]
    fn what_is_doubtful_is_not_known() {
        let ray = Ray::new(DVec3::new(0.1, 0.2, 3.0), DVec3::NEG_Z).unwrap();
        let sphere = shapes::sphere(1.0).unwrap();
        let bvh = SurfaceBvh::build(&[sphere]).unwrap();
        let met = bvh.tracer().first_hit(&Query::primary(ray));
        let known = View::new(&met, &ray);
        assert!((known.sight().unwrap().point.length() - 1.0).abs() < 1e-15);

        let answer = Answer { doubtful: true, ..met };
        let missing = Answer { hit: None, doubtful: true };
        let views = [answer, missing].map(|answer| View::new(&answer, &ray));
        assert_eq!(views, [View::Doubtful; 2]);
        assert!(views[0].sight().is_none());
        let nothing = View::new(&Answer::default(), &ray);
        assert_eq!(nothing, View::Known(None));
        assert_eq!(doubtful(&[views[0], known, nothing]), 1);
    }

    /// From far away, Embree's rays begin beside the scene: its rounding is that of a ray from
    /// there. What is lost does not pass for rounding.
    #[test]
    fn rounding_does_not_grow_with_the_way_to_the_scene() {
        let plane = shapes::plane(2.0, 2.0).unwrap();
        let plan = TessellationPlan::to_distance(&[plane], 0.1).unwrap();
        let meshes = plan.detailed_meshes().unwrap();
        let rounding = |away: f64, length: f64| {
            let ray = Ray::new(DVec3::new(0.1, 0.2, away), -length * DVec3::Z).unwrap();
            let hit = EmbreeHit {
                t: away / length,
                start: (away - 3.0).max(0.0) / length,
                mesh: 0,
                part: EmbreePart::Grid,
                primitive: 0,
                place: DVec2::splat(0.25),
                geometric_normal: DVec3::Z,
            };
            on_mesh(&hit, &ray, &meshes).rounding
        };
        let near = rounding(3.0, 1.0);
        assert!(near > 1e-7 && near < 2e-6, "{near:e}");
        for away in [3.0, 1e3, 1e6, 1e9] {
            for length in [0.5, 1.0, 2.0] {
                let far = rounding(away, length);
                assert!((far - near).abs() < 1e-15 * away, "{away:e}, {length}: {far:e}");
            }
        }
    }

    #[test]
    fn small_angles_keep_their_digits() {
        for angle in [1e-9_f64, 1e-3, 0.5, 1.5] {
            let tilted = DVec3::new(angle.sin(), 0.0, angle.cos());
            for side in [tilted, -tilted] {
                let found = degrees(DVec3::Z, side);
                assert!((found / angle.to_degrees() - 1.0).abs() < 1e-13, "{angle}: {found}");
            }
        }
        assert!(degrees(DVec3::Z, DVec3::NAN).is_nan());
    }
}
