//! What files hold that is not shown.

use std::fmt;

use super::place::{Place, with_place};

/// Something in a file that is not shown as it is written there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportNote {
    /// Where it is.
    pub place: Place,
    /// What it is.
    pub what: String,
    /// Why it is not shown.
    pub why: String,
}

impl fmt::Display for ImportNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        with_place(f, &self.place, &format_args!("{}: {}", self.what, self.why))
    }
}
