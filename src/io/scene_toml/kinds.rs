//! Kinds of things, told apart by the one key of a table.

use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::value::{EnumAccessDeserializer, MapDeserializer};
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, IgnoredAny, IntoDeserializer, MapAccess,
    VariantAccess, Visitor,
};

/// Things of several kinds, each of which is an enum's variant with one value.
pub(super) trait Kinds {
    /// A thing and one of its kinds: `a shape, as in { sphere = { radius = 1 } }`.
    const EXAMPLE: &'static str;
}

/// One kind of thing: `{ kind = … }`, or its name alone where its keys may all be left out.
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
                let kind = OneKey { map, example: T::EXAMPLE };
                T::deserialize(EnumAccessDeserializer::new(kind)).map(OneOf)
            }
        }
        deserializer.deserialize_any(Visit(PhantomData))
    }
}

/// A kind of which only the name is given.
struct NameAlone<'a, E> {
    name: &'a str,
    error: PhantomData<E>,
}

impl<'de, E: Error> EnumAccess<'de> for NameAlone<'_, E> {
    type Error = E;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), E> {
        let deserializer: serde::de::value::StrDeserializer<'_, E> = self.name.into_deserializer();
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
    example: &'static str,
}

impl<'de, A: MapAccess<'de>> EnumAccess<'de> for OneKey<A> {
    type Error = A::Error;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(
        mut self,
        seed: V,
    ) -> Result<(V::Value, Self), A::Error> {
        match self.map.next_key_seed(seed)? {
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
        match self.map.next_key::<IgnoredAny>()? {
            None => Ok(value),
            Some(_) => Err(Error::custom(format!("found several keys, needed {}", self.example))),
        }
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, A::Error> {
        Err(Error::custom(SEVERAL_VALUES))
    }

    fn struct_variant<V: Visitor<'de>>(self, _: &[&str], _: V) -> Result<V::Value, A::Error> {
        Err(Error::custom(SEVERAL_VALUES))
    }
}

/// Kinds hold one value each: [`Kinds`] asks for it.
const SEVERAL_VALUES: &str = "a kind has one value";
