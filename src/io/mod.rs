//! Files: scenes and models in, pictures out.

pub mod geomdl;
mod load;
mod load_error;
#[cfg(test)]
mod mangled;
mod message;
pub mod scene_toml;
mod source;

pub use geomdl::{Model, read_geomdl};
pub use load::load_input;
pub use load_error::{LoadError, LoadFault};
pub use scene_toml::read_scene;
