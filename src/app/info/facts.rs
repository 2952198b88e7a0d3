//! Facts about each surface that is ready to trace.

use glam::DVec3;
use nurbray::geometry::trim::Kept;
use nurbray::geometry::{Charts, Surface};
use nurbray::math::Aabb;
use nurbray::patch::{Leaf, Piece};
use nurbray::scene::World;
use rayon::prelude::*;

use super::extent::{extent, extent_of_parts};
use super::side::Side;
use super::which::Which;

/// Facts about all surfaces.
#[derive(Clone, Debug)]
pub(super) struct Facts {
    /// The surfaces, in the order hits count them.
    pub(super) surfaces: Vec<SurfaceFacts>,
    /// Memory of everything that is ready to trace, the hierarchy too.
    pub(super) bytes: usize,
    /// The box all surfaces just fit in.
    pub(super) bounds: Aabb,
}

/// Facts about one surface.
#[derive(Clone, Debug)]
pub(super) struct SurfaceFacts {
    pub(super) index: usize,
    pub(super) name: String,
    pub(super) material: String,
    pub(super) degree: [usize; 2],
    pub(super) rational: bool,
    /// Control points in all.
    pub(super) points: usize,
    /// Control points in u and in v, where they form a net.
    pub(super) size: Option<[usize; 2]>,
    pub(super) domain: [[f64; 2]; 2],
    pub(super) pieces: usize,
    pub(super) leaves: usize,
    /// Memory of its control points, trims, pieces and leaves.
    pub(super) bytes: usize,
    /// The box it just fits in.
    pub(super) bounds: Aabb,
    /// The borders that are one point, and that point.
    pub(super) collapsed: Vec<(Which, DVec3)>,
    /// How far it may be from what the scene asks for.
    pub(super) deviation: f64,
    /// The patches of a limit surface, and how many of them are exact.
    pub(super) patches: Option<[usize; 2]>,
    /// Facts about its trims, if it has any.
    pub(super) trims: Option<TrimFacts>,
}

/// Facts about a surface's trims.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrimFacts {
    /// Which side of the loops stays.
    pub(super) kept: Kept,
    /// Loops, copies by periods included.
    pub(super) loops: usize,
    /// Loops, as written, that run outside the domain only.
    pub(super) outside: usize,
    /// Monotone segments of all loops.
    pub(super) segments: usize,
    /// The widest gap that was closed, as a part of its loop's extent.
    pub(super) widest_gap: f64,
    pub(super) bytes: usize,
    /// Leaves that a trim curve passes through.
    pub(super) mixed: usize,
}

impl Facts {
    /// Collects the facts.
    pub(super) fn new(world: &World) -> Self {
        let mut surfaces: Vec<SurfaceFacts> =
            (0..world.surfaces().len()).map(|index| authored(world, index)).collect();
        let patches = world.bvh().patches();
        for surface in &mut surfaces {
            surface.pieces = patches.pieces_of(surface.index).len();
            surface.bytes = patches.bytes_of(surface.index);
        }
        // The leaves of trimmed surfaces, whose kept parts give the surfaces' bounds.
        let mut trimmed: Vec<Vec<&Leaf>> = vec![Vec::new(); surfaces.len()];
        for leaf in world.bvh().leaves() {
            let surface = &mut surfaces[patches.pieces()[leaf.piece as usize].surface as usize];
            surface.leaves += 1;
            surface.bytes += size_of::<Leaf>();
            if let Some(trims) = &mut surface.trims {
                trims.mixed += usize::from(leaf.is_trimmed());
                trimmed[surface.index].push(leaf);
            }
        }
        surfaces.par_iter_mut().zip(&trimmed).for_each(|(surface, leaves)| {
            let pieces = &patches.pieces()[patches.pieces_of(surface.index)];
            surface.bounds = match surface.trims {
                None => extent(pieces.iter().map(|piece| &piece.patch)),
                Some(_) => extent_of_parts(leaves.iter().map(|leaf| {
                    let piece = &patches.pieces()[leaf.piece as usize];
                    (&piece.patch, kept_part(piece, leaf.rect()))
                })),
            };
        });
        let bounds = surfaces.iter().map(|surface| surface.bounds);
        let bounds = bounds.fold(Aabb::EMPTY, Aabb::union);
        Self { surfaces, bytes: world.bvh().bytes(), bounds }
    }

    /// The diagonal of the bounding box.
    pub(super) fn size(&self) -> f64 {
        self.bounds.size().length()
    }

    /// Control points of all surfaces.
    pub(super) fn control_points(&self) -> usize {
        self.surfaces.iter().map(|surface| surface.points).sum()
    }

    /// Bézier pieces of all surfaces.
    pub(super) fn pieces(&self) -> usize {
        self.surfaces.iter().map(|surface| surface.pieces).sum()
    }

    /// Leaves of all surfaces.
    pub(super) fn leaves(&self) -> usize {
        self.surfaces.iter().map(|surface| surface.leaves).sum()
    }
}

/// The facts about a surface as authored; its pieces are counted elsewhere.
fn authored(world: &World, index: usize) -> SurfaceFacts {
    let instance = &world.surfaces()[index];
    let surface = &instance.surface;
    let charts = surface.charts();
    let sides = Side::all(surface, &charts).into_iter();
    let collapsed = sides.filter_map(|side| Some((side.which(), side.kept_pole()?))).collect();
    SurfaceFacts {
        index,
        name: instance.name.clone(),
        material: world.materials()[instance.material].name.clone(),
        degree: surface.degree(),
        rational: surface.is_rational(),
        points: surface.point_count(),
        size: surface.nurbs().map(|surface| surface.size()),
        domain: surface.domain(),
        pieces: 0,
        leaves: 0,
        bytes: 0,
        bounds: Aabb::EMPTY,
        collapsed,
        deviation: instance.deviation,
        patches: match surface {
            Surface::Limit(limit) => Some([limit.patches().len(), limit.exact_count()]),
            _ => None,
        },
        trims: surface.trimmed().map(|trimmed| {
            let trims = trimmed.trims();
            TrimFacts {
                kept: trims.kept(),
                loops: trims.loop_count(),
                outside: trims.outside_loop_count(),
                segments: trims.segment_count(),
                widest_gap: trims.widest_gap(),
                bytes: trims.bytes(),
                mixed: 0,
            }
        }),
    }
}

/// The part of a rectangle of a piece's unit square that the piece's trims keep; the whole
/// rectangle if that part is empty, as where the two just touch.
fn kept_part(piece: &Piece, rect: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let Some(kept) = piece.kept_part(rect) else { return rect };
    let part = [0, 1].map(|k| [rect[k][0].max(kept[k][0]), rect[k][1].min(kept[k][1])]);
    if part.iter().all(|[from, to]| from < to) { part } else { rect }
}
