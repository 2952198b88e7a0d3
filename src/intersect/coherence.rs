//! How neighbouring rays are best traced.

use super::SurfaceBvh;

/// Whether neighbouring rays of a batch are alike, so that packets pay off.
///
/// A batch is traced in the order in which it is given:
///
/// - Of coherent rays, 64 consecutive ones make a packet. Packets are fast where their rays meet
///   the same leaves, so the pixels of a picture should come in squares of 8 × 8, or in Z-order,
///   not row after row.
/// - Of incoherent rays, up to 256 consecutive ones are traced side by side, where that pays off:
///   for first hits with AVX-512 or in scenes of 2¹⁴ leaves and more, for occlusion in scenes of
///   2¹⁷ leaves and more; else each by itself.
/// - Batches of a few thousand rays are long enough. The answers to longer ones leave the
///   processor's caches before the caller reads them.
///
/// The last digits of a ray's answer may differ between packets, batches of incoherent rays, and
/// the ray by itself. Within either kind of batch they do not depend on the other rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Coherence {
    /// Neighbours have similar origins, and similar directions (primary rays, shadow rays of one
    /// light) or at least meet mostly the same leaves, as short rays do: see
    /// [`SurfaceBvh::neighbours`].
    Coherent,
    /// Nothing is known.
    #[default]
    Incoherent,
}

/// How rays of neighbouring pixels are best traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbours {
    /// For first hits.
    pub first_hits: Coherence,
    /// For the occlusion of rays that leave such hits.
    pub occlusions: Coherence,
    /// For the occlusion of rays that leave such hits in arbitrary directions.
    pub scattered: Coherence,
}

/// Packets pay off where a leaf is at least this many rays wide. Measured on sheets: packets take
/// 1.2 times as long as batches of incoherent rays at a width of about 1.7, 1.9 times at 0.8, six
/// times at 0.4.
const FIRST_HITS: f64 = 2.0;

/// The same for rays that leave hits: the rays of a packet begin in as many leaves as the packet
/// has met, and pass by the boxes of all their neighbours. Measured: packets take 0.9 to 1 times as
/// long as batches at a width of about 2.4, 1.1 times at 1.2.
const OCCLUSIONS: f64 = 2.0;

/// The same for rays that leave hits in arbitrary directions. Measured: packets take 0.4 to 0.7
/// times as long as batches where leaves are 5 to 40 rays wide, 0.7 to 0.9 times at 1.4 to 3.4.
const SCATTERED: f64 = 1.5;

impl SurfaceBvh {
    /// How neighbouring rays, in rows and columns, are best traced if they are `spacing` scene
    /// units apart where they meet the surfaces: in packets only if leaves are several rays wide.
    ///
    /// The result is the same for all rays of a picture, so that no ray depends on what else is
    /// traced.
    pub fn neighbours(&self, spacing: f64) -> Neighbours {
        let told = |least: f64| {
            // False for a spacing that is not a number.
            let narrow = self.leaf_width < least * spacing;
            if narrow { Coherence::Incoherent } else { Coherence::Coherent }
        };
        Neighbours {
            first_hits: told(FIRST_HITS),
            occlusions: told(OCCLUSIONS),
            scattered: told(SCATTERED),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;

    #[test]
    fn packets_are_for_rays_closer_than_leaves() {
        let surfaces = [shapes::sphere(1.0).unwrap()];
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        // The width if as many leaves share the sphere's area evenly.
        let even = (4.0 * std::f64::consts::PI / bvh.leaves().len() as f64).sqrt();
        let width = bvh.leaf_width;
        assert!((0.8..1.6).contains(&(width / even)), "{width} of {even}");

        let of = |spacing: f64| bvh.neighbours(spacing);
        assert_eq!(of(0.1 * width).occlusions, Coherence::Coherent);
        assert_eq!(of(0.1 * width).scattered, Coherence::Coherent);
        assert_eq!(of(0.6 * width).scattered, Coherence::Coherent);
        assert_eq!(of(width).scattered, Coherence::Incoherent);
        assert_eq!(of(0.3 * width).first_hits, Coherence::Coherent);
        assert_eq!(of(0.3 * width).occlusions, Coherence::Coherent);
        assert_eq!(of(width).occlusions, Coherence::Incoherent);
        assert_eq!(of(width).first_hits, Coherence::Incoherent);
        assert_eq!(of(f64::NAN).first_hits, Coherence::Coherent);
    }
}
