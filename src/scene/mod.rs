//! What is seen: the scene as written, and the world ready to trace.

mod camera;
mod light;
mod material;
mod names;
mod settings;
mod world;

pub use camera::{Camera, CameraError, Projection, View};
pub use light::{Light, Rgb};
pub use material::{Material, Texture};
pub use names::{UnknownName, nearest};
pub use settings::{IntegratorKind, RenderDefaults};
pub use world::{Instance, World};
