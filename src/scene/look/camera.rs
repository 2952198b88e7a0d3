//! Where the picture is taken from.

use glam::{DVec2, DVec3};
use thiserror::Error;

use crate::math::{Ray, Shown, ShownVector, unit};

/// Where the camera stands if no place is given: a three-quarter view from the front (−y), the
/// right, and 25° above, so that three sides of a box show at three different widths.
pub(in crate::scene) const VIEW_FROM: DVec3 = DVec3::new(0.45, -0.79, 0.423);

/// A camera's place and the way it is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The eye (perspective) or the middle of the film (orthographic).
    pub look_from: DVec3,
    /// The point in the middle of the picture.
    pub look_at: DVec3,
    /// What points up in the picture; any direction not along the view.
    pub up: DVec3,
}

/// How the camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays leave one point.
    Perspective {
        /// The angle from the bottom of the picture to its top, in degrees, in [10⁻⁶, 180).
        fov: f64,
    },
    /// All rays run side by side.
    Orthographic {
        /// The length from the bottom of the picture to its top, in scene units.
        height: f64,
    },
}

/// The largest coordinate of a camera: its square is finite, and the largest surface is a
/// speck from there.
const MAX_COORDINATE: f64 = 1e100;

impl Projection {
    /// The smallest field of view in degrees, that of a coin a thousand kilometres away. A
    /// camera that shows all of a model with it stands 10⁸ model sizes away (farther for pictures
    /// higher than wide), where rounding errors are 10⁻⁸ of the size.
    pub const MIN_FOV: f64 = 1e-6;
}

/// Why numbers cannot be a camera.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A coordinate is NaN, infinite, or larger than 10¹⁰⁰.
    #[error(
        "{name} {}: coordinates must be finite, at most {MAX_COORDINATE:e}",
        ShownVector(*.value)
    )]
    Coordinate {
        /// Which vector.
        name: &'static str,
        /// Its value.
        value: DVec3,
    },
    /// The view has no direction.
    #[error("look_from and look_at are the same point {}", ShownVector(*.0))]
    NoDirection(DVec3),
    /// The view has a direction that is only a rounding error.
    #[error("look_from and look_at are the same point {} to within rounding", ShownVector(*.0))]
    RoundedDirection(DVec3),
    /// Up is zero.
    #[error("up {} is no direction: it must not be zero", ShownVector(*.0))]
    NoUp(DVec3),
    /// Up is along the view, or against it.
    #[error(
        "up {} runs along the view {}: it must point another way",
        ShownVector(*.up), ShownVector(*.forward)
    )]
    UpAlongView {
        /// Up, as given.
        up: DVec3,
        /// The unit direction of the view.
        forward: DVec3,
    },
    /// A flat picture cannot show the angle, or the angle is hardly different from 0.
    #[error(
        "fov is {}: needed is an angle from {:e} degrees up to, not including, 180",
        Shown(*.0),
        Projection::MIN_FOV
    )]
    Fov(f64),
    /// The picture has no height.
    #[error("height is {}: needed is a positive length, at most {MAX_COORDINATE:e}", Shown(*.0))]
    Height(f64),
}

/// A camera: film coordinates in, rays out.
///
/// Film coordinates are in `[0, 1]²`, x to the right and y down; the picture's centre,
/// `(½, ½)`, looks at `look_at`.
///
/// # Invariants, checked once in [`Camera::new`]
/// - `right`, `up` and `forward` are orthonormal and finite;
/// - the field of view is a usable angle, the height a positive length.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    view: View,
    projection: Projection,
    /// Half the length that the projection spans: at distance 1 in front of the eye, or in scene
    /// units.
    half: f64,
    right: DVec3,
    up: DVec3,
    /// The ray through the middle of the picture; its direction is the unit view direction.
    axis: Ray,
}

impl Camera {
    /// A camera from its view and projection; the field of view spans the picture's height.
    ///
    /// # Errors
    /// When the view has no direction to within rounding, `up` runs along it, the field of view is
    /// not in [10⁻⁶, 180) degrees, the height is not positive, or a number is not finite or beyond
    /// 10¹⁰⁰.
    pub fn new(view: View, projection: Projection) -> Result<Self, CameraError> {
        // Checked first: if the eye was placed for the projection, the eye is not to blame.
        match projection {
            Projection::Perspective { fov } if !(Projection::MIN_FOV..180.0).contains(&fov) => {
                return Err(CameraError::Fov(fov));
            }
            Projection::Orthographic { height } if !(height > 0.0 && height <= MAX_COORDINATE) => {
                return Err(CameraError::Height(height));
            }
            _ => {}
        }
        for (name, value) in
            [("look_from", view.look_from), ("look_at", view.look_at), ("up", view.up)]
        {
            let usable = value.abs().max_element() <= MAX_COORDINATE && !value.is_nan();
            if !usable {
                return Err(CameraError::Coordinate { name, value });
            }
        }

        // An orthonormal frame: right, up, forward.
        let way = view.look_at - view.look_from;
        let largest = view.look_from.abs().max(view.look_at.abs()).max_element();
        // A difference that is only a rounding error has no direction of its own.
        if way != DVec3::ZERO && way.abs().max_element() <= 8.0 * f64::EPSILON * largest {
            return Err(CameraError::RoundedDirection(view.look_from));
        }
        let forward = unit(way).ok_or(CameraError::NoDirection(view.look_from))?;
        let up = unit(view.up).ok_or(CameraError::NoUp(view.up))?;
        let right = forward.cross(up);
        // Both are unit vectors: a cross product within a few rounding errors of zero has
        // no direction of its own.
        if right.length() <= 8.0 * f64::EPSILON {
            return Err(CameraError::UpAlongView { up: view.up, forward });
        }
        let right = right.normalize();
        let up = right.cross(forward);
        let axis = Ray::new(view.look_from, forward)
            .map_err(|_| CameraError::NoDirection(view.look_from))?;
        let half = match projection {
            Projection::Perspective { fov } => (0.5 * fov.to_radians()).tan(),
            Projection::Orthographic { height } => 0.5 * height,
        };
        Ok(Self { view, projection, half, right, up, axis })
    }

    /// The ray through a point of the film, for a picture of this aspect (width / height).
    ///
    /// The direction's part along the view is of length 1. So `t` is the depth in front of the
    /// camera, not the distance along the ray, which pictures have as
    /// [`Aov::Z`](crate::render::Aov::Z). The range is all of `(0, ∞)`: nothing is clipped. Film
    /// coordinates or an aspect that are not finite give the ray through the middle.
    pub fn ray(&self, film: DVec2, aspect: f64) -> Ray {
        let x = (2.0 * film.x - 1.0) * self.half * aspect;
        let y = (1.0 - 2.0 * film.y) * self.half;

        let offset = x * self.right + y * self.up;
        let (origin, forward) = (self.axis.origin(), self.axis.direction());
        let ray = match self.projection {
            Projection::Perspective { .. } => Ray::new(origin, forward + offset),
            Projection::Orthographic { .. } => Ray::new(origin + offset, forward),
        };
        ray.unwrap_or(self.axis)
    }

    /// The distance between the rays through neighbouring pixels in the middle of a picture of this
    /// size, at `depth` in front of the camera, in scene units.
    pub fn pixel_width(&self, [width, height]: [u32; 2], depth: f64) -> f64 {
        let size = DVec2::new(f64::from(width), f64::from(height));
        let ray = |film: DVec2| self.ray(film, size.x / size.y);
        let middle = DVec2::splat(0.5);
        let (here, below) = (ray(middle), ray(middle + DVec2::new(0.0, 1.0 / size.y)));
        let turned = below.direction() - here.direction();
        (below.origin() - here.origin() + depth * turned).length()
    }

    /// The view as given.
    pub fn view(&self) -> View {
        self.view
    }

    /// The projection as given.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// The unit direction to the right in the picture.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The unit direction up in the picture.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The unit direction of the view.
    pub fn forward(&self) -> DVec3 {
        self.axis.direction()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: View =
        View { look_from: DVec3::new(0.0, -4.0, 0.0), look_at: DVec3::ZERO, up: DVec3::Z };

    #[test]
    fn the_corners_of_a_right_angled_view() {
        let camera = Camera::new(VIEW, Projection::Perspective { fov: 90.0 }).unwrap();
        let middle = camera.ray(DVec2::splat(0.5), 2.0);
        assert_eq!(middle.direction(), DVec3::Y);
        assert_eq!(middle.origin(), VIEW.look_from);
        // x to the right, y down: the top left corner looks left and up.
        let corner = camera.ray(DVec2::ZERO, 2.0).direction();
        assert!((corner - DVec3::new(-2.0, 1.0, 1.0)).length() < 1e-15, "{corner}");
        let corner = camera.ray(DVec2::ONE, 2.0).direction();
        assert!((corner - DVec3::new(2.0, 1.0, -1.0)).length() < 1e-15, "{corner}");
    }

    #[test]
    fn orthographic_rays_are_parallel_and_spread_over_the_height() {
        let camera = Camera::new(VIEW, Projection::Orthographic { height: 3.0 }).unwrap();
        let (top, bottom) =
            (camera.ray(DVec2::new(0.5, 0.0), 1.5), camera.ray(DVec2::new(0.5, 1.0), 1.5));
        assert_eq!(top.direction(), DVec3::Y);
        assert_eq!(top.origin() - bottom.origin(), DVec3::new(0.0, 0.0, 3.0));
        let (left, right) =
            (camera.ray(DVec2::new(0.0, 0.5), 1.5), camera.ray(DVec2::new(1.0, 0.5), 1.5));
        assert_eq!(right.origin() - left.origin(), DVec3::new(4.5, 0.0, 0.0));
    }

    #[test]
    fn pixels_are_as_wide_as_the_picture_divided_by_their_number() {
        let camera = Camera::new(VIEW, Projection::Perspective { fov: 90.0 }).unwrap();
        assert!((camera.pixel_width([640, 400], 4.0) - 8.0 / 400.0).abs() < 1e-15);
        let camera = Camera::new(VIEW, Projection::Orthographic { height: 3.0 }).unwrap();
        assert!((camera.pixel_width([640, 400], 4.0) - 3.0 / 400.0).abs() < 1e-15);
    }

    #[test]
    fn works_at_every_magnitude() {
        for size in [1e-8, 1.0, 1e8, 1e99] {
            let view = View { look_from: VIEW.look_from * size, up: VIEW.up / size, ..VIEW };
            let camera = Camera::new(view, Projection::Perspective { fov: 40.0 }).unwrap();
            assert_eq!(camera.ray(DVec2::splat(0.5), 1.0).direction(), DVec3::Y, "size {size}");
        }
    }

    #[test]
    fn numbers_that_are_no_film_point_give_the_axis() {
        let camera = Camera::new(VIEW, Projection::Perspective { fov: 40.0 }).unwrap();
        for film in [DVec2::NAN, DVec2::INFINITY] {
            assert_eq!(camera.ray(film, 1.0).direction(), DVec3::Y);
        }
        assert_eq!(camera.ray(DVec2::ZERO, f64::NAN).direction(), DVec3::Y);
    }

    #[test]
    fn refuses_what_is_not_a_camera() {
        let perspective = Projection::Perspective { fov: 40.0 };
        let message = |view, projection| Camera::new(view, projection).unwrap_err().to_string();
        assert_eq!(
            message(View { look_at: VIEW.look_from, ..VIEW }, perspective),
            "look_from and look_at are the same point (0, -4, 0)"
        );
        let beside = DVec3::new(0.0, (-4.0f64).next_up(), 0.0);
        assert_eq!(
            message(View { look_at: beside, ..VIEW }, perspective),
            "look_from and look_at are the same point (0, -4, 0) to within rounding"
        );
        assert_eq!(
            message(View { up: DVec3::Y, ..VIEW }, perspective),
            "up (0, 1, 0) runs along the view (0, 1, 0): it must point another way"
        );
        assert_eq!(
            message(View { up: DVec3::ZERO, ..VIEW }, perspective),
            "up (0, 0, 0) is no direction: it must not be zero"
        );
        assert_eq!(
            message(View { look_from: DVec3::new(0.0, f64::NAN, 0.0), ..VIEW }, perspective),
            "look_from (0, NaN, 0): coordinates must be finite, at most 1e100"
        );
        for fov in [0.0, 180.0, -1.0, f64::NAN] {
            assert!(Camera::new(VIEW, Projection::Perspective { fov }).is_err(), "{fov}");
        }
        assert_eq!(
            message(VIEW, Projection::Perspective { fov: 180.0 }),
            "fov is 180: needed is an angle from 1e-6 degrees up to, not including, 180"
        );
        // The eye may be where it is because of the field of view.
        let far = View { look_from: DVec3::splat(f64::INFINITY), ..VIEW };
        assert!(message(far, Projection::Perspective { fov: 0.0 }).starts_with("fov is 0: "));
        assert_eq!(
            message(VIEW, Projection::Orthographic { height: 0.0 }),
            "height is 0: needed is a positive length, at most 1e100"
        );
    }
}
