//! Traversal of the tree by one ray: the readable specification.

use glam::DVec3;

use crate::geometry::MAX_DEGREE;
use crate::intersect::tree::nodes::{BlockLeaves, Child, ChildCode, Node, Tree};
use crate::math::{RayFrame, rounding};
use crate::patch::{OrientedBox, ScaledFrame};

impl Tree {
    /// Visits the leaves whose boxes the ray may meet, nearer boxes first.
    ///
    /// `visit` is given a leaf, its oriented box and the coordinates of that box, and returns how
    /// far along the ray, in scene units, anything is still of interest. Every leaf whose node
    /// begins before that is visited, and no node's entry is computed later than the true one: so a
    /// result that is the least of all does not depend on the tree. Returns the number of nodes
    /// looked at.
    pub(crate) fn traverse(
        &self,
        ray: &RayFrame,
        stack: &mut Vec<(f64, ChildCode)>,
        mut visit: impl FnMut(u32, (&OrientedBox, &ScaledFrame)) -> f64,
    ) -> u64 {
        let (mut frame, mut slabs) = (self.frame(), BoxTest::new(self.frame(), ray));
        let mut limit = ray.z_range[1];
        let mut visited = 0;
        stack.clear();
        stack.extend(self.root().map(|root| (f64::NEG_INFINITY, root)));
        while let Some((entry, code)) = stack.pop() {
            if entry > limit {
                continue;
            }
            match code.child() {
                Child::Node(index) => {
                    visited += 1;
                    let node = &self.nodes[index as usize];
                    let bottom = stack.len();
                    let met = node.filled().filter_map(|k| {
                        let entry = slabs.entry(node, k)?;
                        Some((entry, node.child[k]))
                    });
                    stack.extend(met);
                    // The nearest child is popped first.
                    stack[bottom..].sort_by(|a, b| b.0.total_cmp(&a.0));
                }
                Child::Block(index) => {
                    let BlockLeaves { first, count } = self.leaves(index);
                    for lane in 0..count {
                        let oriented = self.blocks[index as usize].oriented(lane);
                        limit = limit.min(visit(first + lane as u32, (&oriented, frame)));
                    }
                }
                Child::Region(index, way) => {
                    let (region, next) = self.enter(index, way);
                    stack.extend(next.map(|code| (f64::NEG_INFINITY, code)));
                    (frame, slabs) = (&region.frame, BoxTest::new(&region.frame, ray));
                }
            }
        }
        visited
    }
}

/// How far from a box a ray may pass and still be said to meet it, per unit of the largest
/// coordinate: the error bound of a point of a surface of the highest degree, and almost as much
/// again for the rounding of the origin and of the test itself, a few operations.
const BOX_ROUNDING: f64 = 512.0 * rounding::UNIT_ROUNDOFF;
const _: () = assert!(BOX_ROUNDING > 1.5 * rounding::residual_factor(MAX_DEGREE, MAX_DEGREE));

/// A ray prepared for box tests in scaled coordinates.
struct BoxTest {
    /// The origin, moved by the rounding error of the test towards either side.
    origin_low: DVec3,
    origin_high: DVec3,
    inverse: DVec3,
    /// Takes scaled lengths to scene units.
    unscale: f64,
    /// The range of `z`, in scaled units.
    range: [f64; 2],
}

impl BoxTest {
    fn new(frame: &ScaledFrame, ray: &RayFrame) -> Self {
        let origin = frame.scaled(ray.origin);
        // Rounding of the subtraction, and of the surface's own points for this origin.
        let center = frame.center.abs().max_element();
        let error = BOX_ROUNDING
            * ((ray.magnitude + center) * frame.scale + origin.abs().max_element() + 1.0);
        Self {
            origin_low: origin + error,
            origin_high: origin - error,
            inverse: 1.0 / ray.axis,
            unscale: 1.0 / frame.scale,
            range: ray.z_range.map(|z| z * frame.scale),
        }
    }

    /// The distance at which the ray enters a child's box, in scene units and never too late;
    /// `None` for a miss.
    ///
    /// A direction component of zero gives an infinite inverse; a NaN arises only when the
    /// widened origin lies exactly in a padded face, where nothing is: then the other face alone
    /// decides, and a miss is right.
    fn entry(&self, node: &Node, k: usize) -> Option<f64> {
        let plane = |side: usize| {
            let at = |axis: usize| f64::from(node.planes[axis][side][k]);
            DVec3::new(at(0), at(1), at(2))
        };
        let low = (plane(0) - self.origin_low) * self.inverse;
        let high = (plane(1) - self.origin_high) * self.inverse;
        let mut near = self.range[0];
        let mut far = self.range[1];
        for k in 0..3 {
            near = near.max(low[k].min(high[k]));
            far = far.min(low[k].max(high[k]));
        }
        // Both may be infinite, where two components of the direction are zero: their sum must not
        // be.
        let rounding = |z: f64| 8.0 * f64::EPSILON * z.abs().min(f64::MAX);
        let rounded = rounding(near) + rounding(far);
        let missed = near > far + rounded;
        (!missed).then_some((near - rounded) * self.unscale)
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::{Kernel, SurfaceBvh};
    use crate::math::Ray;

    #[test]
    fn rays_along_an_axis_visit_no_more_than_others() {
        let spheres: Vec<_> = (0..400)
            .map(|k| {
                let at = DVec3::new(f64::from(k % 20), f64::from(k / 20), 0.0);
                let shift = DAffine3::from_translation(3.0 * at);
                shapes::sphere(1.0).unwrap().transformed(&shift).unwrap()
            })
            .collect();
        let bvh = SurfaceBvh::build(&spheres).unwrap();
        let visited = |tilt: f64| {
            let mut tracer = bvh.tracer_with(Kernel::Scalar);
            for k in 0..400 {
                let (x, y) = (0.1507 * f64::from(k), 0.1507 * f64::from(400 - k));
                let ray = Ray::new(DVec3::new(x, y, 9.0), DVec3::new(tilt, tilt, -1.0)).unwrap();
                let _ = tracer.first_hit(&ray);
            }
            let statistics = tracer.statistics();
            statistics.nodes + statistics.leaf_tests
        };
        let (along, tilted) = (visited(0.0), visited(1e-9));
        assert!(along <= tilted + tilted / 10, "{along}, {tilted}");
    }
}
