//! What a picture may hold besides colour, and the names of its channels.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::scene::UnknownName;

/// A kind of data about what a pixel shows ("arbitrary output variable").
///
/// `Z`, `P`, `N`, `uv` and `id` all describe *one* hit: that of the pixel's first sample
/// (in sample order) that hits anything. So they agree with each other, ids stay whole
/// and no point lies between two surfaces. `Albedo` is a colour and is averaged as the
/// picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Aov {
    /// The distance from the camera (perspective) or its film (orthographic) to the hit,
    /// along the ray, in scene units; +∞ where nothing is hit. It is not the depth along the view,
    /// as the `t` of [`Camera::ray`](crate::scene::Camera::ray) is.
    Z,
    /// The point hit, in world coordinates; 0 where nothing is hit. It has 32 bits: see
    /// [`Film::coarse_points`](super::Film::coarse_points).
    P,
    /// The unit normal `S_u × S_v`, as oriented by the surface, in world coordinates; 0
    /// where nothing is hit or there is no normal.
    N,
    /// The parameters of the hit in the surface's own knot domain; 0 where nothing is hit.
    Uv,
    /// The share of light sent back, averaged over all samples: those that hit nothing
    /// count as 0, as they do in premultiplied colour.
    Albedo,
    /// Which surface was hit, counted from 0 as everywhere; −1 where nothing is hit.
    /// Whole up to 2²⁴.
    Id,
    /// The share of samples of which a ray, to a light perhaps, has a doubtful answer: averaged
    /// over all samples, those that hit nothing among them.
    Doubt,
}

impl Aov {
    /// Every kind, in the order to list them.
    pub const ALL: &'static [Self] =
        &[Self::Z, Self::P, Self::N, Self::Uv, Self::Albedo, Self::Id, Self::Doubt];

    /// Its name on the command line and the first part of its channels' names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Z => "Z",
            Self::P => "P",
            Self::N => "N",
            Self::Uv => "uv",
            Self::Albedo => "Albedo",
            Self::Id => "id",
            Self::Doubt => "doubt",
        }
    }

    /// Its channels.
    pub fn channels(self) -> &'static [Channel] {
        use Channel::*;
        match self {
            Self::Z => &[Z],
            Self::P => &[PX, PY, PZ],
            Self::N => &[NX, NY, NZ],
            Self::Uv => &[U, V],
            Self::Albedo => &[AlbedoR, AlbedoG, AlbedoB],
            Self::Id => &[Id],
            Self::Doubt => &[Doubt],
        }
    }
}

impl fmt::Display for Aov {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One number of each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the names say it; `Aov` and `Film` say what they hold")]
pub enum Channel {
    R,
    G,
    B,
    A,
    Z,
    PX,
    PY,
    PZ,
    NX,
    NY,
    NZ,
    U,
    V,
    AlbedoR,
    AlbedoG,
    AlbedoB,
    Id,
    Doubt,
}

impl Channel {
    /// The channels every picture has.
    pub const COLOR: &'static [Self] = &[Self::R, Self::G, Self::B, Self::A];

    /// Its name in an EXR file.
    pub fn name(self) -> &'static str {
        match self {
            Self::R => "R",
            Self::G => "G",
            Self::B => "B",
            Self::A => "A",
            Self::Z => "Z",
            Self::PX => "P.X",
            Self::PY => "P.Y",
            Self::PZ => "P.Z",
            Self::NX => "N.X",
            Self::NY => "N.Y",
            Self::NZ => "N.Z",
            Self::U => "uv.U",
            Self::V => "uv.V",
            Self::AlbedoR => "Albedo.R",
            Self::AlbedoG => "Albedo.G",
            Self::AlbedoB => "Albedo.B",
            Self::Id => "id",
            Self::Doubt => "doubt",
        }
    }

    /// Whether it holds colour or coverage, for which 16 bits are enough; the others are
    /// measurements.
    pub(crate) fn is_color(self) -> bool {
        use Channel::*;
        matches!(self, R | G | B | A | AlbedoR | AlbedoG | AlbedoB)
    }
}

/// A set of kinds of data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AovSet(u8);

impl AovSet {
    /// None: colour and coverage only.
    pub const NONE: Self = Self(0);

    /// Every kind there is.
    pub fn all() -> Self {
        Aov::ALL.iter().copied().collect()
    }

    /// All that describes what was hit: what other programs look for beside colour.
    pub fn of_hits() -> Self {
        Aov::ALL.iter().copied().filter(|&aov| aov != Aov::Doubt).collect()
    }

    /// This set and one kind more.
    #[must_use]
    pub fn with(self, aov: Aov) -> Self {
        Self(self.0 | 1 << aov as u8)
    }

    /// Whether a kind is in the set.
    pub fn contains(self, aov: Aov) -> bool {
        self.0 & (1 << aov as u8) != 0
    }

    /// Whether nothing is in the set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The kinds in the set, in the order of [`Aov::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Aov> {
        Aov::ALL.iter().copied().filter(move |aov| self.contains(*aov))
    }

    /// All channels of a picture with these data, colour first.
    pub fn channels(self) -> impl Iterator<Item = Channel> {
        let data = self.iter().flat_map(|aov| aov.channels().iter().copied());
        Channel::COLOR.iter().copied().chain(data)
    }
}

impl FromIterator<Aov> for AovSet {
    fn from_iter<I: IntoIterator<Item = Aov>>(aovs: I) -> Self {
        aovs.into_iter().fold(Self::NONE, Self::with)
    }
}

impl fmt::Display for AovSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("none");
        }
        let names: Vec<_> = self.iter().map(Aov::name).collect();
        f.write_str(&names.join(","))
    }
}

/// Why words are no set of AOVs.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum AovListError {
    /// There is no AOV of that name.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// There is no name where one should be.
    #[error(
        "a name is missing: Z, P, N, uv, Albedo, id, doubt with commas between them, all, or none"
    )]
    NoName,
    /// `all` or `none` in a list.
    #[error("\"{0}\" says all there is to say: it cannot be in a list")]
    NotAlone(&'static str),
}

/// Names with commas between them, in any case (`z,N,Albedo`), or `all`, or `none`.
impl FromStr for AovSet {
    type Err = AovListError;

    fn from_str(list: &str) -> Result<Self, AovListError> {
        const SETS: [&str; 2] = ["all", "none"];
        let set = |name: &str| SETS.into_iter().find(|set| set.eq_ignore_ascii_case(name.trim()));
        match set(list) {
            Some("all") => return Ok(Self::all()),
            Some(_) => return Ok(Self::NONE),
            None => {}
        }
        let known: Vec<_> = Aov::ALL.iter().map(|aov| aov.name()).chain(SETS).collect();
        let find = |name: &str| {
            let name = name.trim();
            let aov = Aov::ALL.iter().find(|aov| aov.name().eq_ignore_ascii_case(name));
            match (aov, set(name)) {
                (Some(aov), _) => Ok(*aov),
                (None, Some(set)) => Err(AovListError::NotAlone(set)),
                (None, None) if name.is_empty() => Err(AovListError::NoName),
                (None, None) => Err(UnknownName::new("AOV", name, &known).into()),
            }
        };
        list.split(',').map(find).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read_and_written() {
        let set: AovSet = "id, z,Albedo,Z".parse().unwrap();
        assert_eq!(set.to_string(), "Z,Albedo,id");
        assert_eq!("all".parse(), Ok(AovSet::all()));
        assert_eq!(AovSet::all().to_string().parse(), Ok(AovSet::all()));
        assert_eq!("none".parse(), Ok(AovSet::NONE));
        assert!(AovSet::NONE.is_empty() && !set.is_empty());
    }

    #[test]
    fn unknown_names_get_the_nearest() {
        let message = |list: &str| list.parse::<AovSet>().unwrap_err().to_string();
        assert_eq!(message("Z,albeda"), "unknown AOV \"albeda\"; did you mean \"Albedo\"?");
        assert_eq!(
            message("Q"),
            "unknown AOV \"Q\"; known: Z, P, N, uv, Albedo, id, doubt, all, none"
        );
        let missing = "a name is missing: Z, P, N, uv, Albedo, id, doubt with commas between them, \
                       all, or none";
        for list in ["", " ", "Z,,N", "Z,"] {
            assert_eq!(message(list), missing, "{list}");
        }
        assert_eq!(message("Z,All"), "\"all\" says all there is to say: it cannot be in a list");
    }

    #[test]
    fn channels_have_the_names_of_the_format() {
        let names = |set: AovSet| set.channels().map(Channel::name).collect::<Vec<_>>().join(" ");
        let expected = "R G B A Z P.X P.Y P.Z N.X N.Y N.Z uv.U uv.V Albedo.R Albedo.G Albedo.B id";
        assert_eq!(names(AovSet::of_hits()), expected);
        assert_eq!(names(AovSet::all()), format!("{expected} doubt"));
        assert_eq!(AovSet::NONE.channels().count(), 4);
    }
}
