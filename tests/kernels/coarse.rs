//! Leaves that are approximated coarsely, as in surfaces of so many pieces that there is no room for
//! finer ones. Where rays meet them is known in closed form.

use glam::{DVec3, DVec4};
use nurbray::geometry::{KnotVector, NurbsSurface};
use nurbray::intersect::{Answer, Coherence, Kernel, Occlusion, Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::answers::{occlusions, one_by_one, trace};
use crate::random::Random;

/// How high the waves are: not much higher, and pieces would be divided into leaves.
const HEIGHT: f64 = 5e-4;

/// How many pieces there are each way: together more than are ever divided without need.
const PIECES: usize = 64;

/// How far rays reach, in units of their directions, which move them by about one: two pieces.
const REACH: f64 = 4.0;

/// Rays that leave a hit are known to leave the sheet if they are clear of it so far from there.
const LEFT: f64 = 1e-4;

/// The sheet `z = HEIGHT Tₙ(x)`, where `Tₙ` is Chebyshev's polynomial of degree `n` on every second
/// piece, and mirrored on the others; pieces have sides of 2. A cubic through Chebyshev points is
/// off by up to twice the height: it is `−T₃` for `T₅`, and 0 for `T₄`.
struct Sheet {
    waves: usize,
    surface: NurbsSurface,
}

impl Sheet {
    /// Of degree 5 by 1: `T₅`, or rational, `T₄` with weights from 0.8 to 1.2.
    fn new(rational: bool) -> Self {
        let (waves, x) = (if rational { 4 } else { 5 }, [-1.0, 1.0]);
        // T₀ = 1, T₁ = x, Tₖ₊₁ = 2 x Tₖ − Tₖ₋₁.
        let (mut before, mut wave) = (vec![1.0], x.to_vec());
        for _ in 1..waves {
            let (twice, raised) = (product(&[-2.0, 2.0], &wave), product(&before, &[1.0; 3]));
            let next = twice.iter().zip(&raised).map(|(a, b)| a - b).collect();
            before = std::mem::replace(&mut wave, next);
        }
        let weight: &[f64] = if rational { &[0.8, 1.2] } else { &[1.0] };
        let weighted = |of: &[f64]| {
            let of = product(of, weight);
            product(&of, &[1.0; 6][..7 - of.len()])
        };
        let [xs, zs, ws] = [&x[..], &wave, &[1.0]].map(weighted);

        // Piece by piece; mirrored ones run through the same coefficients backwards.
        let mut net: Vec<DVec4> = Vec::new();
        for piece in 0..PIECES {
            let middle = 2.0 * piece as f64 + 1.0 - PIECES as f64;
            for i in usize::from(piece > 0)..6 {
                let (k, sign) = if piece % 2 == 0 { (i, 1.0) } else { (5 - i, -1.0) };
                let x = middle * ws[k] + sign * xs[k];
                net.extend((0..=PIECES).map(|j| {
                    let y = 2.0 * j as f64 - PIECES as f64;
                    DVec4::new(x, y * ws[k], HEIGHT * zs[k], ws[k])
                }));
            }
        }
        let knots = |degree: usize| {
            let inner = (1..PIECES).flat_map(|knot| vec![knot as f64; degree]);
            let ends = |knot: f64| std::iter::repeat_n(knot, degree + 1);
            let all = ends(0.0).chain(inner).chain(ends(PIECES as f64));
            KnotVector::new(degree, all.collect()).unwrap()
        };
        let surface = NurbsSurface::from_homogeneous(knots(5), knots(1), net).unwrap();
        Self { waves, surface }
    }

    /// How far a point is above the sheet.
    fn above(&self, point: DVec3) -> f64 {
        let (mut before, mut wave) = (1.0, on_piece(point.x));
        for _ in 1..self.waves {
            (before, wave) = (wave, 2.0 * on_piece(point.x) * wave - before);
        }
        point.z - HEIGHT * wave
    }

    /// The ray parameters from `least` on at which a ray meets the sheet; `None` where the ray may
    /// just touch it, or ends on it.
    fn roots(&self, ray: &Ray, least: f64) -> Option<Vec<f64>> {
        const STEPS: usize = 1000;
        let above = |t: f64| self.above(ray.origin() + t * ray.direction());
        let step = |k: usize| least + (REACH - least) * k as f64 / STEPS as f64;
        let crease =
            |k: usize| (2.0 * k as f64 - PIECES as f64 - ray.origin().x) / ray.direction().x;
        let creases = (0..=PIECES).map(crease).filter(|t| (least..REACH).contains(t));
        let mut places: Vec<f64> = (0..=STEPS).map(step).chain(creases).collect();
        places.sort_by(f64::total_cmp);
        let heights: Vec<f64> = places.iter().map(|&t| above(t)).collect();
        // Where it stays on one side, and as near as it bends within two steps.
        let touches = heights.windows(3).any(|near| {
            let bend = (near[0] - 2.0 * near[1] + near[2]).abs();
            let on_one_side = near.iter().all(|h| *h > 0.0) || near.iter().all(|h| *h < 0.0);
            on_one_side && near[1].abs() < bend
        });
        let last = heights.len() - 1;
        let ends_there = heights[0].abs().min(heights[last].abs()) < 1e-9;
        if touches || ends_there {
            return None;
        }
        let crossed = (0..last).filter(|&k| (heights[k] < 0.0) != (heights[k + 1] < 0.0));
        let root = |k: usize| {
            let [mut a, mut b] = [places[k], places[k + 1]];
            for _ in 0..50 {
                let middle = 0.5 * (a + b);
                let is_before = (above(middle) < 0.0) == (heights[k] < 0.0);
                (a, b) = if is_before { (middle, b) } else { (a, middle) };
            }
            a
        };
        Some(crossed.map(root).collect())
    }

    /// As [`roots`](Self::roots), without the one that the ray leaves. From there it is off by
    /// `g t`, and by at most `HEIGHT Tₙ″ t² / 2` in addition, with `Tₙ″ ≤ n² (n² − 1) / 3 ≤ 200`: it
    /// does not come back at once where `|g t|` is the larger one. Nothing is said beside creases.
    fn roots_left(&self, ray: &Ray) -> Option<Vec<f64>> {
        let off = self.above(ray.origin() + LEFT * ray.direction());
        let is_clear = off.abs() > 200.0 * HEIGHT * LEFT * LEFT;
        let is_inside = on_piece(ray.origin().x).abs() < 1.0 - 2.0 * LEFT;
        (is_clear && is_inside).then(|| self.roots(ray, LEFT)).flatten()
    }
}

/// The place on a piece, from −1 to 1, that has this `x`.
fn on_piece(x: f64) -> f64 {
    let from_last_but_one = (x + PIECES as f64).rem_euclid(4.0);
    if from_last_but_one < 2.0 { from_last_but_one - 1.0 } else { 3.0 - from_last_but_one }
}

/// The Bernstein coefficients of a product of two polynomials, given by theirs.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let choose =
        |n: usize, k: usize| -> f64 { (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product() };
    let (p, q) = (a.len() - 1, b.len() - 1);
    let mut sums = vec![0.0; p + q + 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            sums[i + j] += choose(p, i) * a * (choose(q, j) * b);
        }
    }
    sums.iter().enumerate().map(|(k, sum)| sum / choose(p + q, k)).collect()
}

/// A ray from here, as flat as the waves or steeper.
fn ray(origin: DVec3, along: DVec3) -> Ray {
    Ray::with_range(origin, along, 0.0, REACH).unwrap()
}

/// A direction that is about as steep as a power of ten in this range.
fn direction(random: &mut Random, [from, to]: [f64; 2]) -> DVec3 {
    let steepness = random.sign() * random.power_of_ten(from, to);
    DVec3::new(random.sign(), random.between(-0.3, 0.3), steepness)
}

/// As flat as the waves, or steeper.
const FLAT: [f64; 2] = [-4.5, 0.0];

/// Just steep enough to be certified, or a little more: such rays may meet the approximation beyond
/// the leaf.
const STEEP: [f64; 2] = [-2.3, -1.2];

/// Rays that aim near the waves, in turn with steeper ones at points of the sheet, most of them near
/// a crease between pieces.
fn rays(sheet: &Sheet, random: &mut Random) -> Vec<Query> {
    let one = |k: usize| {
        let from_end = random.power_of_ten(-4.0, [0.0, -1.5][k % 2]);
        let x = random.pick(&[1.0 - from_end, from_end - 1.0, 2.0 * from_end - 1.0]);
        let x = 2.0 * random.below(20) as f64 - 21.0 + x;
        let target = DVec3::new(x, random.between(-20.0, 20.0), 0.0);
        let wave = -sheet.above(target);
        let z = [HEIGHT * random.between(-1.2, 1.2), wave][k % 2];
        let along = direction(random, [FLAT, STEEP][k % 2]);
        Query::primary(ray(target + z * DVec3::Z - 2.0 * along, along))
    };
    (0..1000).map(one).collect()
}

/// Rays, and the ray parameters of all roots of each.
struct Asked {
    queries: Vec<Query>,
    roots: Vec<Vec<f64>>,
}

impl Asked {
    fn new(
        queries: impl IntoIterator<Item = Query>,
        roots: impl Fn(&Ray) -> Option<Vec<f64>>,
    ) -> Self {
        let known = queries.into_iter().filter_map(|query| Some((query, roots(query.ray())?)));
        let (queries, roots) = known.unzip();
        Self { queries, roots }
    }

    fn pairs(&self) -> impl Iterator<Item = (&Query, &Vec<f64>)> {
        self.queries.iter().zip(&self.roots)
    }

    /// Checks that the first root is reported, or doubt, and that doubts are rare.
    fn check(&self, way: &str, answers: &[Answer]) {
        for ((query, roots), answer) in self.pairs().zip(answers) {
            let found = answer.hit.as_ref().map(|hit| hit.t);
            let is_first = match (found, roots.first()) {
                (Some(t), Some(root)) => (t - root).abs() < 1e-8,
                (found, root) => found.is_none() && root.is_none(),
            };
            assert!(is_first || answer.doubtful, "{way}: {found:?} of {roots:?}, {query:?}");
        }
        let doubtful = answers.iter().filter(|answer| answer.doubtful).count();
        assert!(100 * doubtful < answers.len(), "{way}: {doubtful} doubtful");
    }

    /// Checks that rays that meet something are told from those that do not.
    fn check_occlusions(&self, way: &str, occlusions: &[Occlusion]) {
        for ((query, roots), hidden) in self.pairs().zip(occlusions) {
            let is_told = hidden.occluded != roots.is_empty();
            assert!(is_told || hidden.doubtful, "{way}: {hidden:?} of {roots:?}, {query:?}");
        }
    }
}

#[test]
fn roots_off_a_coarse_approximation_are_neither_lost_nor_invented() {
    for rational in [false, true] {
        let sheet = Sheet::new(rational);
        let bvh = SurfaceBvh::build(std::slice::from_ref(&sheet.surface)).unwrap();
        assert_eq!(bvh.leaves().len(), PIECES * PIECES);
        let mut random = Random::new(5);
        let primary = Asked::new(rays(&sheet, &mut random), |ray| sheet.roots(ray, 0.0));
        let hits = one_by_one(&bvh, Kernel::Scalar, &primary.queries);
        let hits = hits.iter().filter_map(|answer| answer.hit.as_ref());
        let leaving =
            hits.map(|hit| Query::leaving(ray(hit.point, direction(&mut random, FLAT)), hit));
        let leaving = Asked::new(leaving, |ray| sheet.roots_left(ray));
        let count = |asked: &Asked, n| asked.roots.iter().filter(|roots| roots.len() == n).count();
        assert!(count(&primary, 1) > 500 && count(&leaving, 0) > 400 && count(&leaving, 1) > 50);
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            for asked in [&primary, &leaving] {
                let queries = &asked.queries;
                let way = format!("rational {rational}, {kernel}, one by one");
                asked.check(&way, &one_by_one(&bvh, kernel, queries));
                asked.check_occlusions(&way, &occlusions(&bvh, kernel, queries));
                for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                    let way = format!("rational {rational}, {kernel}, {coherence:?}");
                    asked.check(&way, &trace(&bvh, kernel, coherence, queries));
                    let mut hidden = Vec::new();
                    bvh.tracer_with(kernel).occlusions(queries, coherence, &mut hidden);
                    asked.check_occlusions(&way, &hidden);
                }
            }
        }
    }
}
