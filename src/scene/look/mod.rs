//! What a picture is seen with: the camera, the lights, and the materials of surfaces. A scene as
//! written names them, a world ready to trace holds them; so they are at the ground, and know
//! nothing of the other groups.

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
