//! The true crossings of a line with a closed form, and which of them are certain.

use glam::DVec3;
use nurbray::math::Ray;

use crate::double::Double;
use crate::forms::Form;
use crate::polynomial::Polynomial;

/// A closed form in its place: `scale` times as large, then moved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) form: Form,
    pub(crate) scale: f64,
    pub(crate) shift: DVec3,
}

/// A root of the closed form along the ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// The place along the line, in form sizes from its base.
    pub(crate) at: Double,
    /// The point in the form's own coordinates.
    pub(crate) point: DVec3,
    /// The unit normal, pointing outward.
    pub(crate) normal: DVec3,
    /// `|N · d|`.
    pub(crate) cosine: f64,
    /// Whether the crossing exists whatever rounding does within what is allowed: it lies well
    /// inside the border and the range, and the line dips deep enough into the form.
    pub(crate) certain: bool,
}

/// A ray as a line in the form's own coordinates, in twice the digits.
pub(crate) struct Line {
    base: [Double; 3],
    direction: [Double; 3],
    /// The ray parameter of the base.
    t_base: f64,
    /// Form sizes for one unit of `t`, a power of two times a number near 1.
    per_t: [f64; 2],
}

impl Line {
    pub(crate) fn new(placed: &Placed, ray: &Ray) -> Self {
        // Scaled by powers of two only, so that nothing is lost.
        let largest = ray.direction().abs().max_element();
        let power = largest.log2().floor().exp2();
        let direction = (ray.direction() / power).to_array();
        let scale = Double::from(placed.scale);
        let local = |x: f64, shift: f64| (Double::from(x) - Double::from(shift)).over(scale);
        let (o, c) = (ray.origin().to_array(), placed.shift.to_array());
        let origin = [0, 1, 2].map(|k| local(o[k], c[k]));

        let rough = DVec3::from_array(origin.map(Double::round));
        let along = DVec3::from_array(direction);
        let length = along.length();
        // The base is near the form, so that its coordinates are not large.
        let from_origin = -rough.dot(along) / along.length_squared();
        let step = direction.map(|d| Double::from(d).over(Double::from(length)));
        let base = [0, 1, 2].map(|k| origin[k] + step[k] * (from_origin * length));
        Self {
            base,
            direction: step,
            t_base: from_origin * placed.scale / power,
            per_t: [power, length / placed.scale],
        }
    }

    pub(crate) fn point(&self, at: Double) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| (self.base[k] + self.direction[k] * at).round()))
    }

    /// The place of a ray parameter on the line.
    pub(crate) fn place(&self, t: f64) -> Double {
        (Double::from(t) - Double::from(self.t_base)) * self.per_t[0] * self.per_t[1]
    }

    /// The form's function along the line.
    fn along(&self, form: Form) -> Polynomial {
        form.along(&[0, 1, 2].map(|k| Polynomial(vec![self.base[k], self.direction[k]])))
    }

    /// How far a point of the line is from the form, to first order.
    pub(crate) fn distance(&self, form: Form, at: Double) -> f64 {
        distance(form, &self.along(form), self.point(at), at)
    }

    /// The crossings of the line with the form, in order. `bound` is the error bound of a computed
    /// point, in form sizes.
    pub(crate) fn crossings(&self, form: Form, bound: f64) -> Vec<Crossing> {
        let along = self.along(form);
        let distance = |at: Double| distance(form, &along, self.point(at), at);
        let reach = 8.0; // the base is the line's nearest point to the form's centre
        // Turning points of the line so near to the surface that it may as well not meet it.
        let turns = along.derivative().roots(reach);
        let shallow: Vec<f64> =
            turns.iter().filter(|&&at| distance(at) <= 2.0 * bound).map(|at| at.round()).collect();
        let roots = along.roots(reach);
        let others: Vec<f64> = turns.iter().map(|at| at.round()).collect();
        roots
            .into_iter()
            .map(|at| {
                let point = self.point(at);
                let normal = form.gradient(point).normalize_or_zero();
                let direction = DVec3::from_array(self.direction.map(Double::round));
                let cosine = normal.dot(direction).abs();
                let slack = bound * (1.0 / cosine + 1.0);
                let beside = |turn: f64| {
                    let between = |x: f64| (x - at.round()) * (x - turn) < 0.0;
                    !others.iter().any(|&x| between(x))
                };
                let deep = !shallow.iter().any(|&turn| beside(turn));
                let certain = deep && slack < 0.1 && form.inside_border(point).abs() > 2.0 * slack;
                Crossing { at, point, normal, cosine, certain }
            })
            .filter(|crossing| {
                let slack = 2.0 * bound * (1.0 / crossing.cosine + 1.0);
                form.inside_border(crossing.point) >= -slack
            })
            .collect()
    }
}

/// `|F| / |∇F|`; at a cone's tip, where both vanish, the tip's own distance.
fn distance(form: Form, along: &Polynomial, point: DVec3, at: Double) -> f64 {
    (along.at(at).abs().round() / form.gradient(point).length()).min(form.tip_distance(point))
}
