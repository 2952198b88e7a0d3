//! Frames that move along a path without turning about it.

use glam::DVec3;

use super::path::direction;
use super::{ConstructError, DirectionOf};
use crate::geometry::NurbsCurve;
use crate::math::unit;

/// A frame on a path: `normal × side = tangent`, all of length 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) origin: DVec3,
    pub(crate) tangent: DVec3,
    pub(crate) normal: DVec3,
}

impl Frame {
    pub(crate) fn side(&self) -> DVec3 {
        self.tangent.cross(self.normal)
    }

    /// The frame at the start of a path, its side as near to `up` as it can be.
    pub(crate) fn first(path: &NurbsCurve, up: Option<DVec3>) -> Result<Self, ConstructError> {
        let [start, _] = path.domain();
        let tangent = direction(path, start)?;
        let steep = tangent.z.abs() > STEEP;
        let wanted = up.unwrap_or(if steep { DVec3::Y } else { DVec3::Z });
        let Some(upward) = unit(wanted) else {
            return Err(ConstructError::Direction { what: DirectionOf::Up, vector: wanted });
        };
        let across = upward - upward.dot(tangent) * tangent;
        let apart = across.length() > SAME_WAY; // false for NaN
        if !apart {
            return Err(ConstructError::Up { path: "path", up: wanted, tangent });
        }
        let side = across.normalize();
        Ok(Self { origin: path.point_at(start), tangent, normal: side.cross(tangent) })
    }

    /// The frame at another point of the path, reached by reflecting this one in the plane
    /// between the points, then in the plane that turns the tangent into the one there
    /// (Wang, Jüttler, Zheng, Liu 2008). Its error is of fifth order in the step.
    fn reflected_to(&self, origin: DVec3, tangent: DVec3) -> Self {
        let mirrored = |vector: DVec3, across: DVec3| {
            vector - 2.0 / across.length_squared() * across.dot(vector) * across
        };
        let Some(step) = unit(origin - self.origin) else {
            return Self { origin, tangent, normal: self.normal };
        };
        let (normal, back) = (mirrored(self.normal, step), mirrored(self.tangent, step));
        let turned = mirrored(normal, tangent - back);
        let normal = (turned - turned.dot(tangent) * tangent).normalize();
        Self { origin, tangent, normal }
    }
}

/// The steepness (z of the unit tangent) from which y is the default upward direction: less than
/// 26° from the vertical, y is better conditioned than z.
const STEEP: f64 = 0.9;

/// An upward direction nearer to the path's own than this (in radians) is unusable.
const SAME_WAY: f64 = 1e-6;

/// The frames of one smooth piece of a path.
#[derive(Clone, Debug)]
pub(crate) struct PieceFrames {
    pub(crate) curve: NurbsCurve,
    /// At evenly spaced parameters.
    samples: Vec<Frame>,
}

/// The largest change of the frame at the end of a piece when the step is halved, in radians. This
/// change is sixteen times the error that remains.
const SETTLED: f64 = 1e-11;

/// The first and the largest number of steps along one piece: 2¹⁴ steps of fourth order leave
/// nothing but rounding errors, however much a piece of a spline turns.
const STEPS: (usize, usize) = (16, 1 << 14);

impl PieceFrames {
    /// The frames of a piece, starting with `first`; steps are halved until the last frame settles.
    pub(crate) fn new(curve: NurbsCurve, first: Frame) -> Result<Self, ConstructError> {
        let mut steps = STEPS.0;
        let mut samples = walked(&curve, first, steps)?;
        while steps < STEPS.1 {
            steps *= 2;
            let finer = walked(&curve, first, steps)?;
            let change = samples[steps / 2].normal.distance(finer[steps].normal);
            samples = finer;
            if change <= SETTLED {
                break;
            }
        }
        Ok(Self { curve, samples })
    }

    /// The frame at a parameter of the piece.
    pub(crate) fn at(&self, t: f64) -> Result<Frame, ConstructError> {
        let [start, end] = self.curve.domain();
        let last = self.samples.len() - 1;
        let share = ((t - start) / (end - start)).clamp(0.0, 1.0);
        let below = self.samples[((share * last as f64) as usize).min(last)];
        Ok(below.reflected_to(self.curve.point_at(t), direction(&self.curve, t)?))
    }

    /// The frame at the end of the piece.
    pub(crate) fn last(&self) -> Frame {
        self.samples[self.samples.len() - 1]
    }
}

fn walked(curve: &NurbsCurve, first: Frame, steps: usize) -> Result<Vec<Frame>, ConstructError> {
    let [start, end] = curve.domain();
    let mut frame = first;
    let mut frames = Vec::with_capacity(steps + 1);
    frames.push(first);
    for k in 1..=steps {
        let t = if k == steps { end } else { start + (end - start) * k as f64 / steps as f64 };
        frame = frame.reflected_to(curve.point_at(t), direction(curve, t)?);
        frames.push(frame);
    }
    Ok(frames)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along a helix, the rotation-minimising frame turns against the Frenet frame by the
    /// torsion: 2π b / √(a² + b²) in one turn of radius a and rise 2π b.
    #[test]
    fn a_helix_turns_the_frame_by_its_torsion() {
        let (a, b) = (1.0, 0.4);
        let points: Vec<DVec3> = (0..=200)
            .map(|k| {
                let angle = f64::from(k) / 200.0 * std::f64::consts::TAU;
                DVec3::new(a * angle.cos(), a * angle.sin(), b * angle)
            })
            .collect();
        let helix = NurbsCurve::through(&points, 5).unwrap();
        // Outward at the start, like the reversed Frenet normal.
        let mut frame = Frame::first(&helix, Some(DVec3::Z)).unwrap();
        let start = frame;
        for piece in helix.bezier_pieces() {
            frame = PieceFrames::new(piece, frame).unwrap().last();
        }
        let turned = std::f64::consts::TAU * b / a.hypot(b);
        let expected = turned.cos() * start.normal - turned.sin() * start.side();
        assert!(frame.normal.distance(expected) < 1e-6, "{} {expected}", frame.normal);
        assert!(frame.normal.dot(frame.tangent).abs() < 1e-15);
    }

    #[test]
    fn up_must_not_be_the_way() {
        let line = NurbsCurve::polyline(&[DVec3::ZERO, DVec3::Z]).unwrap();
        let frame = Frame::first(&line, None).unwrap();
        assert_eq!((frame.normal, frame.side(), frame.tangent), (DVec3::X, DVec3::Y, DVec3::Z));
        assert_eq!(
            Frame::first(&line, Some(2.0 * DVec3::Z)).unwrap_err().to_string(),
            "up (0, 0, 2) runs along the path, whose direction there is (0, 0, 1): \
             choose another one"
        );
        for (up, written) in [(DVec3::NAN, "(NaN, NaN, NaN)"), (DVec3::ZERO, "(0, 0, 0)")] {
            assert_eq!(
                Frame::first(&line, Some(up)).unwrap_err().to_string(),
                format!("up {written}: it must be finite and not zero")
            );
        }
    }
}
