//! What rays ask for.

/// What a ray asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Its first hit.
    #[default]
    First,
    /// Any hit.
    Any,
    /// All hits. Of a fast kernel: those of a single ray that are certified, and the leaves where
    /// there may be others.
    All,
}
