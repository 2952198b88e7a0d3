//! The faces of a cage, some at a time: what refinement makes of a few is small, and is soon done
//! with.

use std::collections::VecDeque;
use std::sync::atomic::AtomicUsize;

use rayon::prelude::*;

use super::Cage;
use super::error::LimitError;
use super::limit_surface::{LimitSurface, Patches};
use super::topology::{NONE, Topology};
use super::tree::Tree;

/// The most batches, and the least corners of faces in one. The trees of a batch then hold a small
/// part of what the surface takes, and each processor still gets several. Faces at the rim of a
/// batch are refined with their neighbours in others, so that small batches would cost time.
const MOST: usize = 64;
const LEAST_CORNERS: usize = 512;

/// The patches of all faces, within a share of the tolerance; they do not depend on the batches.
/// `refine` adds those of a batch of faces, given in their order, to a tree.
pub(super) fn patches(
    (cage, batches): (&Cage, &[Vec<u32>]),
    degree: usize,
    (tolerance, share): (f64, f64),
    refine: impl Fn(&[u32], &mut Tree<'_>) -> Result<(), LimitError> + Sync,
) -> Result<LimitSurface, LimitError> {
    let (magnitude, smallest) = (cage.magnitude(), cage.smallest_tolerance());
    if !(tolerance >= smallest && tolerance > 0.0 && tolerance.is_finite()) {
        return Err(LimitError::Tolerance { tolerance, magnitude, smallest });
    }
    let topology = &cage.mesh().topology;
    let (count, size) = (AtomicUsize::new(0), cage.largest_side());
    let of_batch = |faces: &Vec<u32>| -> Result<Patches, LimitError> {
        let mut tree = Tree::new(degree, (tolerance, share), size, &count);
        refine(faces, &mut tree)?;
        Ok(tree.patches())
    };
    let parts: Vec<_> = batches.par_iter().map(of_batch).collect();

    // All batches together may need too many patches; which of them finds out is up to the threads.
    let too_many = |error: &&LimitError| matches!(error, LimitError::TooManyPatches { .. });
    if let Some(error) = parts.iter().filter_map(|part| part.as_ref().err()).find(too_many) {
        return Err(error.clone());
    }
    let parts = parts.into_iter().collect::<Result<Vec<Patches>, LimitError>>()?;

    let units = first_units(topology).last().copied().unwrap_or(0);
    let surface = LimitSurface::gathered((degree, tolerance), units, cage.control_net(), &parts);
    // u counts unit squares and must still distinguish the places within the smallest patches.
    let smallest = surface.patches.iter().flat_map(|p| p.rect.size).fold(1.0, f64::min);
    if smallest < units as f64 * SMALLEST_SIDE {
        return Err(LimitError::TooDeep { tolerance, levels: -smallest.log2() as u32 });
    }
    Ok(surface)
}

/// The smallest side of a patch, per unit square: 2⁸ places within it can be told apart.
const SMALLEST_SIDE: f64 = 1.0 / (1_u64 << 44) as f64;

/// The first unit square of each face, and the number of all.
pub(super) fn first_units(topology: &Topology) -> Vec<usize> {
    let mut units = vec![0];
    for face in 0..topology.face_count() {
        let sides = topology.face_range(face).len();
        units.push(units[face] + if sides == 4 { 1 } else { sides });
    }
    units
}

/// Groups of faces that lie together, each in the order of the faces.
pub(super) fn batches(topology: &Topology) -> Vec<Vec<u32>> {
    let wanted = topology.corner_count().div_ceil(MOST).max(LEAST_CORNERS);
    let mut is_queued = vec![false; topology.face_count()];
    let mut batches = Vec::new();
    let (mut batch, mut corners) = (Vec::new(), 0);
    for start in 0..topology.face_count() as u32 {
        let mut queue = VecDeque::new();
        if !std::mem::replace(&mut is_queued[start as usize], true) {
            queue.push_back(start);
        }
        while let Some(face) = queue.pop_front() {
            let range = topology.face_range(face as usize);
            corners += range.len();
            batch.push(face);
            if corners >= wanted {
                corners = 0;
                batches.push(std::mem::take(&mut batch));
            }
            for twin in range.map(|corner| topology.twin(corner as u32)).filter(|&it| it != NONE) {
                let next = topology.face_of(twin);
                if !std::mem::replace(&mut is_queued[next as usize], true) {
                    queue.push_back(next);
                }
            }
        }
    }
    batches.push(batch);
    batches.iter_mut().for_each(|batch| batch.sort_unstable());
    batches
}

#[cfg(test)]
mod tests {
    use super::super::tests::{bumpy, cage, sheet_parts, zoo};
    use super::*;

    #[test]
    fn each_face_is_in_one_batch() {
        let cage = cage(&sheet_parts(41, 41, bumpy));
        let batches = batches(&cage.mesh().topology);
        assert!(batches.len() > 5 && batches.len() <= MOST + 1, "{}", batches.len());
        assert!(batches.iter().all(|batch| batch.is_sorted() && batch.len() < 200));
        let mut all = batches.concat();
        all.sort_unstable();
        assert_eq!(all, (0..1600).collect::<Vec<_>>());
    }

    /// Bit for bit.
    #[test]
    fn patches_do_not_depend_on_batches() {
        for (name, parts) in zoo() {
            let cage = cage(&parts);
            let faces = || 0..cage.face_count() as u32;
            let whole = vec![faces().collect::<Vec<u32>>()];
            let single: Vec<Vec<u32>> = faces().rev().map(|face| vec![face]).collect();
            let odd: Vec<Vec<u32>> =
                [1, 0].map(|odd| faces().filter(|face| face % 2 == odd).collect()).into();
            let accuracy = (1e-3, 0.25);
            let expected = cage.catmull_clark_patches(accuracy, &whole).unwrap();
            for batches in [&single, &odd] {
                let found = cage.catmull_clark_patches(accuracy, batches).unwrap();
                assert!(found == expected, "{name}");
            }
            if let Ok(expected) = cage.doo_sabin_patches(accuracy, &whole) {
                let found = cage.doo_sabin_patches(accuracy, &single).unwrap();
                assert!(found == expected, "{name}, Doo–Sabin");
            }
        }
    }
}
