//! Things of several kinds: the only key of a table names the kind.

use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::value::{EnumAccessDeserializer, MapDeserializer, StrDeserializer};
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, IgnoredAny, IntoDeserializer, MapAccess,
    VariantAccess, Visitor,
};

/// Things of several kinds, each of which is an enum's variant with one value.
pub(super) trait Kinds {
    /// The thing, with one of its kinds as an example:
    /// `a shape, as in { sphere = { radius = 1 } }`.
    const EXAMPLE: &'static str;
    /// How two such things are written.
    const APART: &'static str;

    /// What to write instead of these keys in one table.
    fn apart(_found: &[String]) -> &'static str {
        Self::APART
    }
}

/// One kind of thing: `{ kind = … }`, or `"kind"` alone if all its keys may be left out.
pub(super) struct OneOf<T>(pub(super) T);

impl<'de, T: Kinds + Deserialize<'de>> Deserialize<'de> for OneOf<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visit<T>(PhantomData<T>);

        impl<'de, T: Kinds + Deserialize<'de>> Visitor<'de> for Visit<T> {
            type Value = OneOf<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(T::EXAMPLE)
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<OneOf<T>, E> {
                let kind = NameAlone { name, error: PhantomData };
                T::deserialize(EnumAccessDeserializer::new(kind)).map(OneOf)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<OneOf<T>, A::Error> {
                let (example, apart) = (T::EXAMPLE, T::apart);
                let kind = OneKey { map, name: String::new(), example, apart };
                T::deserialize(EnumAccessDeserializer::new(kind)).map(OneOf)
            }
        }
        deserializer.deserialize_any(Visit(PhantomData))
    }
}

/// A kind given by its name alone.
struct NameAlone<'a, E> {
    name: &'a str,
    error: PhantomData<E>,
}

impl<'de, E: Error> EnumAccess<'de> for NameAlone<'_, E> {
    type Error = E;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), E> {
        let deserializer: StrDeserializer<'_, E> = self.name.into_deserializer();
        Ok((seed.deserialize(deserializer)?, self))
    }
}

impl<'de, E: Error> VariantAccess<'de> for NameAlone<'_, E> {
    type Error = E;

    fn unit_variant(self) -> Result<(), E> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, E> {
        let no_keys = std::iter::empty::<(&str, &str)>();
        seed.deserialize(MapDeserializer::<_, E>::new(no_keys)).map_err(|_| {
            let name = self.name;
            E::custom(format!("\"{name}\" alone says too little: write {{ {name} = … }}"))
        })
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, E> {
        Err(E::custom(SEVERAL_VALUES))
    }

    fn struct_variant<V: Visitor<'de>>(self, _: &[&str], _: V) -> Result<V::Value, E> {
        Err(E::custom(SEVERAL_VALUES))
    }
}

/// The one key of a table, and its value.
struct OneKey<A> {
    map: A,
    name: String,
    example: &'static str,
    apart: fn(&[String]) -> &'static str,
}

/// Reads a key, and keeps its name.
struct Named<'a, S> {
    seed: S,
    name: &'a mut String,
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Named<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, key: D) -> Result<S::Value, D::Error> {
        *self.name = String::deserialize(key)?;
        let name: StrDeserializer<'_, D::Error> = self.name.as_str().into_deserializer();
        self.seed.deserialize(name)
    }
}

impl<'de, A: MapAccess<'de>> EnumAccess<'de> for OneKey<A> {
    type Error = A::Error;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(
        mut self,
        seed: V,
    ) -> Result<(V::Value, Self), A::Error> {
        let named = Named { seed, name: &mut self.name };
        match self.map.next_key_seed(named)? {
            Some(kind) => Ok((kind, self)),
            None => Err(Error::custom(format!("found an empty table, needed {}", self.example))),
        }
    }
}

impl<'de, A: MapAccess<'de>> VariantAccess<'de> for OneKey<A> {
    type Error = A::Error;

    fn unit_variant(mut self) -> Result<(), A::Error> {
        self.map.next_value::<IgnoredAny>().map(drop)
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(
        mut self,
        seed: T,
    ) -> Result<T::Value, A::Error> {
        let value = self.map.next_value_seed(seed)?;
        let mut found = vec![self.name];
        while let Some(other) = self.map.next_key::<String>()? {
            self.map.next_value::<IgnoredAny>()?;
            found.push(other);
        }
        match found.as_slice() {
            [others @ .., last] if !others.is_empty() => {
                let (others, apart) = (others.join(", "), (self.apart)(&found));
                Err(Error::custom(format!(
                    "found the keys {others} and {last}, needed one: {apart}"
                )))
            }
            _ => Ok(value),
        }
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, A::Error> {
        Err(Error::custom(SEVERAL_VALUES))
    }

    fn struct_variant<V: Visitor<'de>>(self, _: &[&str], _: V) -> Result<V::Value, A::Error> {
        Err(Error::custom(SEVERAL_VALUES))
    }
}

/// Kinds hold one value each, as [`Kinds`] demands.
const SEVERAL_VALUES: &str = "a kind has one value";
