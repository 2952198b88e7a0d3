//! Surfaces made from curves, or by other forms than a control net, as written.

use glam::DVec3;

use super::{CurveSpec, Written};
use crate::geometry::MatrixForm;
use crate::geometry::construct::{NetStyle, RibbonStyle, SweepOptions, TubeStyle};

/// Surfaces made from curves, of which [`construct`](crate::geometry::construct) says how each is
/// made and how it runs, and patches in matrix form or in powers of u and v.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Construction {
    /// A profile turned about an axis.
    Revolution {
        /// The profile.
        profile: CurveSpec,
        /// A point of the axis.
        through: DVec3,
        /// The axis' direction.
        axis: DVec3,
        /// The angle.
        degrees: f64,
    },
    /// A profile moved along a vector.
    Extrusion {
        /// The profile.
        profile: CurveSpec,
        /// The vector.
        by: DVec3,
    },
    /// Straight lines from one curve to another.
    Ruled {
        /// The first curve.
        from: CurveSpec,
        /// The second curve.
        to: CurveSpec,
    },
    /// A Coons patch between four borders: those of constant u, then of constant v.
    Coons(Box<[CurveSpec; 4]>),
    /// A surface through section curves.
    Loft {
        /// The sections in turn.
        sections: Vec<CurveSpec>,
        /// The degree across; as high as the sections allow up to 3 if not given.
        degree: Option<usize>,
    },
    /// A patch in matrix form.
    MatrixForm {
        /// What its vectors mean.
        form: MatrixForm,
        /// Its geometry matrix, row by row.
        geometry: Vec<Vec<DVec3>>,
    },
    /// A patch by the coefficients of the powers of its parameters: a row for each power of u, from
    /// `u⁰` on, in it those of `v⁰`, `v¹`, …
    Power {
        /// Those of its numerator.
        coefficients: Vec<Vec<DVec3>>,
        /// Those of its denominator; `[[1.0]]` for a polynomial.
        denominator: Vec<Vec<f64>>,
        /// Where u begins and ends, and v.
        domain: [[f64; 2]; 2],
    },
    /// A profile carried along a path.
    Sweep {
        /// The profile.
        profile: CurveSpec,
        /// The path.
        path: CurveSpec,
        /// How it is carried.
        options: SweepOptions,
    },
    /// A round tube around a curve.
    Tube {
        /// The curve.
        curve: CurveSpec,
        /// How thick, and how it ends.
        style: TubeStyle,
    },
    /// A flat band along a curve.
    Ribbon {
        /// The curve.
        curve: CurveSpec,
        /// How wide, and how it is turned.
        style: RibbonStyle,
    },
    /// The control polygon of a curve.
    Polygon {
        /// The curve.
        curve: CurveSpec,
        /// How thick.
        style: NetStyle,
    },
    /// The control nets of another object's surfaces.
    Net {
        /// The object's name.
        of: Written<String>,
        /// How often cages of subdivision surfaces are refined first; 0 draws them as they are.
        steps: usize,
        /// How thick.
        style: NetStyle,
    },
    /// The trim edges of another object's surfaces, as tubes.
    TrimCurves {
        /// The object's name.
        of: Written<String>,
        /// How thick, and how they end.
        style: TubeStyle,
    },
    /// Curves of constant parameter on another object's surfaces, where trims keep them, as
    /// tubes.
    IsoCurves {
        /// The object's name.
        of: Written<String>,
        /// The values of `u` that are fixed.
        u: Vec<f64>,
        /// The values of `v` that are fixed.
        v: Vec<f64>,
        /// The values of `w = 1 − u − v` that are fixed on triangular patches.
        w: Vec<f64>,
        /// How thick, and how they end.
        style: TubeStyle,
    },
}

impl Construction {
    /// Its name in scenes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Revolution { .. } => "revolution",
            Self::Extrusion { .. } => "extrusion",
            Self::Ruled { .. } => "ruled",
            Self::Coons(_) => "coons",
            Self::Loft { .. } => "loft",
            Self::MatrixForm { .. } => "matrix_form",
            Self::Power { .. } => "power",
            Self::Sweep { .. } => "sweep",
            Self::Tube { .. } => "tube",
            Self::Ribbon { .. } => "ribbon",
            Self::Polygon { .. } => "polygon",
            Self::Net { .. } => "net",
            Self::TrimCurves { .. } => "trim_curves",
            Self::IsoCurves { .. } => "iso_curves",
        }
    }

    /// Whether it makes a drawing of lines, from many surfaces that run into each other: tubes,
    /// ribbons, nets.
    pub fn is_drawing(&self) -> bool {
        let curve = matches!(self, Self::Tube { .. } | Self::Ribbon { .. } | Self::Polygon { .. });
        curve || self.draws().is_some()
    }

    /// The number of control points of its curves, or of vectors that it is given by.
    pub fn point_count(&self) -> usize {
        if let Self::MatrixForm { geometry: rows, .. } | Self::Power { coefficients: rows, .. } =
            self
        {
            return rows.iter().map(Vec::len).fold(0, usize::saturating_add);
        }
        let counts = self.curves().into_iter().map(|(_, curve)| curve.point_count());
        counts.fold(0, usize::saturating_add)
    }

    /// Its curves with what errors call them.
    pub fn curves(&self) -> Vec<(String, &CurveSpec)> {
        let curves = match self {
            Self::Revolution { profile, .. } | Self::Extrusion { profile, .. } => {
                vec![("profile", profile)]
            }
            Self::Ruled { from, to } => vec![("from", from), ("to", to)],
            Self::Coons(borders) => {
                let names = ["border u0", "border u1", "border v0", "border v1"];
                names.into_iter().zip(borders.iter()).collect()
            }
            Self::Loft { sections, .. } => {
                let numbered = sections.iter().enumerate();
                return numbered.map(|(k, curve)| (format!("section {k}"), curve)).collect();
            }
            Self::Sweep { profile, path, .. } => vec![("profile", profile), ("path", path)],
            Self::Tube { curve, .. } | Self::Ribbon { curve, .. } | Self::Polygon { curve, .. } => {
                vec![("curve", curve)]
            }
            Self::MatrixForm { .. }
            | Self::Power { .. }
            | Self::Net { .. }
            | Self::TrimCurves { .. }
            | Self::IsoCurves { .. } => Vec::new(),
        };
        curves.into_iter().map(|(name, curve)| (name.to_owned(), curve)).collect()
    }

    /// The name of the object whose surfaces it draws, if it draws another's.
    pub fn draws(&self) -> Option<&Written<String>> {
        match self {
            Self::Net { of, .. } | Self::TrimCurves { of, .. } | Self::IsoCurves { of, .. } => {
                Some(of)
            }
            _ => None,
        }
    }
}
