//! Tables that must be tables, and objects that must be objects.
//!
//! Readers that serde derives are more lenient than their messages: a list of values in the
//! order of the keys passes for a table. No author of a scene means that.

use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, MapAccess, Visitor};

/// The keys of a table (TOML) or an object (JSON); anything else, a list too, is refused.
#[derive(Default)]
pub(super) struct Keyed<T>(pub(super) T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Keyed<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        keyed(deserializer, "a table").map(Keyed)
    }
}

/// Reads the keys of a table, which errors call `table`.
pub(super) fn keyed<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
    table: &'static str,
) -> Result<T, D::Error> {
    struct Visit<T> {
        table: &'static str,
        keys: PhantomData<T>,
    }

    impl<'de, T: Deserialize<'de>> Visitor<'de> for Visit<T> {
        type Value = T;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(self.table)
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
            T::deserialize(MapAccessDeserializer::new(map))
        }
    }
    deserializer.deserialize_map(Visit { table, keys: PhantomData })
}
