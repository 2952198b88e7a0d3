//! The kinds of rays an audit is made of.

/// One kind of rays; the report has a row for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// From a sphere around the model to a point in its bounding box.
    Random,
    /// In any direction through any point of a surface.
    Aimed,
    /// As `Aimed`, with a direction of length 10⁻⁸ to 10⁸.
    Lengths,
    /// As `Aimed`, from before or behind the point, with any range that it lies in.
    Ranges,
    /// Through the border of a surface: seams, shared edges, free edges.
    Borders,
    /// Through knot lines and the lines at which pieces are halved.
    Lines,
    /// Through points where two such lines meet, the corners of a surface among them.
    Corners,
    /// Through a pole, where an edge is collapsed to a point.
    Poles,
    /// In the plane of three points of one border: seam planes, planes of symmetry.
    SeamPlanes,
    /// Parallel to an axis, in the planes of bounding boxes too.
    Axes,
    /// Through two points of one iso-parameter line: rulings, chords.
    Chords,
    /// Past a silhouette, at 1 − 10⁻ᵏ and 1 + 10⁻ᵏ radii of curvature.
    Grazing(u8),
    /// In the tangent plane of a point, through that point.
    Tangents,
    /// Starting on a surface, to within rounding.
    Origins,
    /// Leaving a hit, as secondary rays do.
    Leaving,
    /// Through the edges that trims cut.
    TrimEdges,
    /// As `Aimed`, from a million sizes away.
    Far,
}

/// What is expected of a class's answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Group {
    /// Rays as pictures have them: hardly any may be doubtful.
    Random,
    /// Rays made to be difficult: few may be doubtful.
    Nasty,
    /// Rays whose first root no floating point arithmetic can decide: those that start on a
    /// surface without saying so, and exactly tangent ones, which occur in all classes. Doubt
    /// is the right answer.
    Apart,
}

impl Group {
    /// All of them, in the order of the report.
    pub(crate) const ALL: [Self; 3] = [Self::Random, Self::Nasty, Self::Apart];

    /// Its name in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Nasty => "nasty",
            Self::Apart => "apart",
        }
    }
}

/// The steepest grazing class: at 10⁻¹⁰ of a radius the two roots of a sphere lie 3e-5 radii
/// apart and are met at |N·d| = 1.4e-5, which f64 still resolves with ten digits to spare.
pub(crate) const GRAZING_STEPS: u8 = 10;

impl Class {
    /// Every class, in the order of the report.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let before = [
            Self::Random,
            Self::Aimed,
            Self::Lengths,
            Self::Ranges,
            Self::Borders,
            Self::Lines,
            Self::Corners,
            Self::Poles,
            Self::SeamPlanes,
            Self::Axes,
            Self::Chords,
            Self::TrimEdges,
        ];
        let after = [Self::Tangents, Self::Origins, Self::Leaving, Self::Far];
        let grazing = (1..=GRAZING_STEPS).map(Self::Grazing);
        before.into_iter().chain(grazing).chain(after)
    }

    /// Its name in reports.
    pub(crate) fn name(self) -> String {
        match self {
            Self::Random => "random",
            Self::Aimed => "aimed",
            Self::Lengths => "lengths",
            Self::Ranges => "ranges",
            Self::Borders => "borders",
            Self::Lines => "lines",
            Self::Corners => "corners",
            Self::Poles => "poles",
            Self::SeamPlanes => "seam-planes",
            Self::Axes => "axes",
            Self::Chords => "chords",
            Self::Grazing(k) => return format!("grazing-{k}"),
            Self::Tangents => "tangents",
            Self::Origins => "origins",
            Self::Leaving => "leaving",
            Self::TrimEdges => "trim-edges",
            Self::Far => "far",
        }
        .into()
    }

    /// What is expected of its answers.
    pub(crate) fn group(self) -> Group {
        match self {
            Self::Random | Self::Aimed => Group::Random,
            Self::Tangents | Self::Origins => Group::Apart,
            _ => Group::Nasty,
        }
    }

    /// Its share of the rays, in parts. The rays that renderers trace most have the largest share;
    /// each of the ten grazing classes has the smallest.
    pub(crate) fn parts(self) -> u64 {
        match self {
            Self::Random | Self::Aimed | Self::Leaving => 4,
            Self::Borders | Self::Lines | Self::Corners | Self::Poles | Self::TrimEdges => 2,
            Self::SeamPlanes | Self::Axes | Self::Origins => 2,
            Self::Lengths | Self::Ranges | Self::Chords | Self::Grazing(_) => 1,
            Self::Tangents | Self::Far => 1,
        }
    }

    /// The number that sets its random streams apart from those of the other classes. It must
    /// not change when classes are added: the same seed shall make the same rays.
    pub(crate) fn stream(self) -> u64 {
        match self {
            Self::Random => 0,
            Self::Aimed => 1,
            Self::Lengths => 2,
            Self::Borders => 3,
            Self::Lines => 4,
            Self::Corners => 5,
            Self::Poles => 6,
            Self::SeamPlanes => 7,
            Self::Axes => 8,
            Self::Chords => 9,
            Self::Tangents => 10,
            Self::Origins => 11,
            Self::Leaving => 12,
            Self::Far => 13,
            Self::TrimEdges => 14,
            Self::Ranges => 15,
            Self::Grazing(k) => 100 + u64::from(k),
        }
    }
}

/// Returns how many of `rays` each class gets: in proportion to its parts, `rays` in total.
pub(crate) fn shares(classes: &[Class], rays: u64) -> Vec<u64> {
    let whole: u64 = classes.iter().map(|class| class.parts()).sum();
    let mut parts = 0;
    let mut given = 0;
    classes
        .iter()
        .map(|class| {
            // Rounding the running total, not each share, leaves no ray over.
            parts += class.parts();
            let until = (u128::from(rays) * u128::from(parts) / u128::from(whole)) as u64;
            let share = until - given;
            given = until;
            share
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn names_and_streams_are_distinct() {
        let count = Class::all().count();
        assert_eq!(Class::all().map(Class::name).collect::<BTreeSet<_>>().len(), count);
        assert_eq!(Class::all().map(Class::stream).collect::<BTreeSet<_>>().len(), count);
    }

    #[test]
    fn shares_add_up() {
        let classes: Vec<Class> = Class::all().collect();
        for rays in [0, 1, 23, 1000, 999_983] {
            assert_eq!(shares(&classes, rays).iter().sum::<u64>(), rays);
        }
        let whole: u64 = classes.iter().map(|class| class.parts()).sum();
        assert_eq!(shares(&classes, whole), classes.iter().map(|c| c.parts()).collect::<Vec<_>>());
    }
}
