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
        residual: point.distance(hit.point),
    })
}

/// What a ray meets on triangles, which have the normals of the surfaces.
pub(super) fn on_mesh(hit: &EmbreeHit, ray: &Ray, meshes: &[GridMesh]) -> Sight {
    let vertex = hit.on(meshes);
    Sight {
        distance: hit.t * ray.direction().length(),
        point: ray.at(hit.t),
        normal: vertex.normal,
        facet: hit.geometric_normal.normalize_or(DVec3::NAN),
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
    use nurbray::geometry::shapes;
    use nurbray::intersect::Query;

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
