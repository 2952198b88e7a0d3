//! What a picture is seen with: the camera, the lights, and the materials of surfaces. A scene as
//! written holds them as well as a world ready to trace; so they come first, and know nothing of
//! the other groups.

mod camera;
mod light;
mod material;

pub(in crate::scene) use camera::VIEW_FROM;
pub use camera::{Camera, CameraError, Projection, View};
pub(in crate::scene) use light::check_amount;
pub use light::{Light, LightError, Rgb};
pub(crate) use light::{MAX_INTENSITY, MAX_LIGHT};
pub(crate) use material::share;
pub use material::{Material, Texture};
