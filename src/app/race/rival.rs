//! The rival's side of a race: Embree, on grids of triangles, and triangles alone beside trims.

use std::time::Duration;

use anyhow::{Context, anyhow};
use glam::DVec3;
use nurbray::geometry::trim::TrimError;
use nurbray::intersect::{Coherence, Query};
use nurbray::io::mesh::{MeshError, TessellationPlan};
use nurbray::io::{Embree, EmbreeHit, EmbreePrimitive, EmbreeRays, EmbreeScene, PacketWidth};
use nurbray::math::Ray;
use rayon::prelude::*;

use super::super::failure::{Failure, OrFail};
use super::clock::seconds_a_pass;
use super::model::Model;
use super::outcome::Outcome;
use super::ray_set::{Calls, Question};
use super::rays::{CHUNK, Rays};
use super::steps::repeat;

/// How far above a surface rays that leave it begin, along its normal, in tolerances. Triangles lie
/// up to one tolerance above it. If rays began later on their own way instead, flat ones on concave
/// surfaces would meet the triangles that they start from, at any tolerance.
pub(crate) const CLEARANCE: f64 = 2.0;

/// How often, and for how long each time, a packet width is tried. The best one is measured
/// properly later; among those that are nearly as good, any will do.
const HEATS: usize = 3;
const HEAT: Duration = Duration::from_millis(50);

/// A tessellation in Embree's hierarchy.
#[derive(Debug)]
pub(crate) struct Rival {
    scene: EmbreeScene,
    /// The tolerance as a fraction of the diagonal.
    pub(crate) tolerance: f64,
    /// The tolerance in scene units.
    pub(crate) distance: f64,
    /// The number of triangles.
    pub(crate) triangles: usize,
    /// Seconds to find out how finely to cut.
    pub(crate) plan_seconds: f64,
    /// Seconds to make the vertices on one thread, fill the buffers and commit the scene.
    pub(crate) build_seconds: f64,
    /// Seconds to fill the buffers and commit the scene.
    pub(crate) commit_seconds: f64,
    /// Memory of vertices, grids, faces and hierarchy.
    pub(crate) bytes: usize,
}

impl Rival {
    /// Tessellates the surfaces of a model to within `tolerance`, a fraction of its diagonal, and
    /// builds the hierarchy, again and again for about as long as `budget`. Vertices have positions
    /// only: Embree needs no more. Also returns the plan, from which their normals can be made.
    ///
    /// # Errors
    /// When the mesh becomes too large.
    pub(crate) fn build(
        embree: &Embree,
        model: &Model,
        tolerance: f64,
        budget: Duration,
    ) -> Result<(Self, TessellationPlan), Failure> {
        let context = || format!("{}: tolerance {tolerance:e}", model.name);
        let fault = |error| fault(error, context());
        let distance = tolerance * model.diagonal;
        let (plan, plan_seconds) = repeat(budget, || {
            TessellationPlan::to_distance(&model.surfaces, distance).map_err(fault)
        })?;
        let (meshes, mesh_seconds) = repeat(budget, || plan.meshes().map_err(fault))?;
        let others = embree.bytes();
        let (scene, commit_seconds) = repeat(budget, || {
            embree.scene(&meshes, EmbreePrimitive::Grid).with_context(context).or_failed()
        })?;
        let rival = Self {
            scene,
            tolerance,
            distance,
            triangles: meshes.iter().map(|mesh| mesh.triangles().count()).sum(),
            plan_seconds,
            build_seconds: mesh_seconds + commit_seconds,
            commit_seconds,
            bytes: embree.bytes().saturating_sub(others),
        };
        Ok((rival, plan))
    }

    /// Makes rays ready, in packets of the width that suits them best.
    pub(crate) fn enter(&self, rays: &Rays) -> Entry<'_> {
        let of_width = |width| Entry::new(self, rays, width);
        let widths = match rays.set.calls() {
            Calls::OneByOne => &[PacketWidth::One][..],
            Calls::Batch(_) => &[PacketWidth::One, PacketWidth::Eight, PacketWidth::Sixteen],
        };
        let timed = widths.iter().map(|&width| {
            let mut entry = of_width(width);
            entry.pass(); // warm-up
            let heats = (0..HEATS).map(|_| seconds_a_pass(&mut || entry.pass(), HEAT));
            (heats.fold(f64::INFINITY, f64::min), entry)
        });
        let best = timed.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or_else(|| of_width(PacketWidth::One), |(_, entry)| entry)
    }
}

/// Makes a mesh error bad input if the tolerance asked for is too fine for any mesh, else failed
/// work.
fn fault(error: MeshError, context: String) -> Failure {
    let too_fine = matches!(
        error,
        MeshError::TooManyVertices { .. }
            | MeshError::GridSides { .. }
            | MeshError::Tolerance { .. }
            | MeshError::Trims(TrimError::Tolerance { .. })
    );
    let error = match error {
        // It names the tolerance in (u, v) that follows from the one given.
        MeshError::Trims(TrimError::Tolerance { limit, .. }) => {
            anyhow!("a surface's trim curves would need more than {limit} points")
        }
        error => error.into(),
    };
    let error = error.context(context);
    if too_fine { Failure::Input(error) } else { Failure::Work(error) }
}

/// The rival on one set of rays.
#[derive(Debug)]
pub(crate) struct Entry<'a> {
    rival: &'a Rival,
    question: Question,
    width: PacketWidth,
    /// The lengths of the rays' directions: what a `t` of 1 means.
    lengths: Vec<f64>,
    chunks: Vec<EmbreeRays>,
    /// How far off the surface that they leave the rays begin, in scene units.
    pub(crate) offset: f64,
}

impl<'a> Entry<'a> {
    /// Makes rays ready, in packets of the width given.
    pub(crate) fn new(rival: &'a Rival, rays: &Rays, width: PacketWidth) -> Self {
        let question = rays.set.question();
        let coherence = match rays.set.calls() {
            Calls::Batch(coherence) => coherence,
            Calls::OneByOne => Coherence::Incoherent,
        };
        let offset = if rays.facing.is_empty() { 0.0 } else { CLEARANCE * rival.distance };
        let moved = |(index, query): (usize, &Query)| {
            rays.facing
                .get(index)
                .map_or(*query.ray(), |facing| above(query.ray(), offset * *facing))
        };
        let starts = (0..rays.len()).into_par_iter().step_by(CHUNK);
        let chunks = starts.map(|start| {
            let queries = rays.queries.iter().enumerate().skip(start).take(CHUNK);
            let rays: Vec<Ray> = queries.map(moved).collect();
            rival.scene.rays(&rays, width, coherence)
        });
        let chunks = chunks.collect();
        let length = |query: &Query| query.ray().direction().length();
        let lengths = rays.queries.iter().map(length).collect();
        Self { rival, question, width, lengths, chunks, offset }
    }

    /// How many rays a packet holds.
    pub(crate) fn width(&self) -> u32 {
        match self.width {
            PacketWidth::One => 1,
            PacketWidth::Eight => 8,
            PacketWidth::Sixteen => 16,
        }
    }

    /// Traces all rays once, on the threads of the current pool. The answers stay in the packets.
    pub(crate) fn pass(&mut self) {
        let scene = &self.rival.scene;
        let chunks = self.chunks.par_iter_mut().with_max_len(1);
        match self.question {
            Question::FirstHit => chunks.for_each(|rays| scene.intersect(rays)),
            Question::AnyHit => chunks.for_each(|rays| scene.occluded(rays)),
        }
    }

    /// The first hits found in the last pass, ray by ray.
    pub(crate) fn hits(&self) -> impl Iterator<Item = Option<EmbreeHit>> {
        self.chunks.iter().flat_map(EmbreeRays::hits)
    }

    /// The outcomes of the rays in the last pass.
    pub(crate) fn outcomes(&self) -> Vec<Outcome> {
        let certain = |distance| Outcome { distance, incidence: 1.0, doubtful: false };
        match self.question {
            Question::FirstHit => {
                let hits = self.chunks.iter().flat_map(EmbreeRays::hits).zip(&self.lengths);
                hits.map(|(hit, length)| certain(hit.map(|hit| hit.t * length))).collect()
            }
            Question::AnyHit => {
                let occlusions = self.chunks.iter().flat_map(EmbreeRays::occlusions);
                occlusions.map(|occluded| certain(occluded.then_some(0.0))).collect()
            }
        }
    }
}

/// The ray, moved.
fn above(ray: &Ray, by: DVec3) -> Ray {
    let origin = ray.origin() + by;
    Ray::with_range(origin, ray.direction(), ray.t_min(), ray.t_max()).unwrap_or(*ray)
}
