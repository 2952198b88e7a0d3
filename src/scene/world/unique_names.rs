//! Names of objects and surfaces: unique, and found without a long search.

use std::collections::{HashMap, HashSet};

use crate::scene::errors::{SceneError, SceneFault};
use crate::scene::written::Place;

/// Refuses names that are given twice.
pub(super) fn check_unique<'a>(
    what: &'static str,
    names: impl Iterator<Item = (&'a str, &'a Place)>,
) -> Result<(), SceneError> {
    let mut seen = HashMap::new();
    for (name, place) in names {
        if let Some(first) = seen.insert(name, place) {
            let (name, first) = (name.to_owned(), first.clone());
            let fault = SceneFault::Duplicate { what, name, first };
            return Err(SceneError::new(place.clone(), fault));
        }
    }
    Ok(())
}

/// Joins the name of a part and that of a surface within it; either may be empty.
pub(super) fn joined(part: &str, made: &str) -> String {
    match (part, made) {
        (part, "") => part.to_owned(),
        ("", made) => made.to_owned(),
        (part, made) => format!("{part}/{made}"),
    }
}

/// The names that are taken.
pub(super) struct Naming {
    taken: HashSet<String>,
    /// The last number tried after each name: the numbers before it are taken, and a model may call
    /// thousands of its surfaces alike.
    tried: HashMap<String, usize>,
}

impl Naming {
    /// Starts with these names taken.
    pub(super) fn new(taken: impl Iterator<Item = String>) -> Self {
        Self { taken: taken.collect(), tried: HashMap::new() }
    }

    /// Returns the name itself if it is free, else the first of `name 2`, `name 3`, … that is, and
    /// takes it.
    pub(super) fn free(&mut self, name: &str) -> String {
        if self.taken.insert(name.to_owned()) {
            return name.to_owned();
        }
        let number = self.tried.entry(name.to_owned()).or_insert(1);
        loop {
            *number += 1;
            let numbered = format!("{name} {number}");
            if self.taken.insert(numbered.clone()) {
                return numbered;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_free_number_is_taken_whoever_took_those_before() {
        let mut names = Naming::new(["a", "a 3", "a 2 2"].map(str::to_owned).into_iter());
        let found = ["a", "a", "b", "a 2", "a", "b"].map(|name| names.free(name));
        assert_eq!(found, ["a 2", "a 4", "b", "a 2 3", "a 5", "b 2"]);
    }

    #[test]
    fn many_of_one_name_take_no_time() {
        // If each search began at 2, they would take minutes.
        let mut names = Naming::new(std::iter::empty());
        let last = (0..200_000).map(|_| names.free("a")).last();
        assert_eq!(last.as_deref(), Some("a 200000"));
    }
}
