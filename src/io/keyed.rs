//! Tables that must be tables, objects that must be objects, and names that must be names.
//!
//! Readers that serde derives are more lenient than their messages: a list of values in the
//! order of the keys passes for a table, and a table `{ name = {} }` for a name. No author of a
//! scene means that.

use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, Visitor};

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

/// One of the names of a unit enum, as text.
#[derive(Clone, Copy, Default)]
pub(super) struct Named<T>(pub(super) T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visit<T>(PhantomData<T>);

        impl<'de, T: Deserialize<'de>> Visitor<'de> for Visit<T> {
            type Value = Named<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a name in quotes")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<Named<T>, E> {
                let name: StrDeserializer<'_, E> = name.into_deserializer();
                T::deserialize(name).map(Named)
            }
        }
        deserializer.deserialize_any(Visit(PhantomData))
    }
}
