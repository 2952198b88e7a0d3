//! Basis functions to plot.

use crate::geometry::{
    BasisFunctions, CurveError, KnotError, KnotVector, MAX_DEGREE, RationalBasis, periodic_values,
};
use crate::scene::errors::{PlotError, SceneError};
use crate::scene::written::{
    BasisSpec, Knots, MAX_FUNCTIONS, Place, evenly_spaced, knot_vector, wrapped,
};

/// Basis functions to plot.
#[derive(Clone, Debug, PartialEq)]
pub struct PlottedBasis {
    /// The functions.
    pub functions: PlottedFunctions,
    /// Whether they are drawn off the domain, too, wherever they do not vanish.
    pub support: bool,
    /// Which derivative of them is drawn; 0 for the functions themselves.
    pub derivative: usize,
}

/// The functions of a basis.
#[derive(Clone, Debug, PartialEq)]
pub enum PlottedFunctions {
    /// Functions without weights.
    Polynomial(BasisFunctions),
    /// Rational functions, of which some may vanish because of their weights.
    Rational(RationalBasis),
}

impl From<&KnotVector> for PlottedBasis {
    fn from(knots: &KnotVector) -> Self {
        Self {
            functions: PlottedFunctions::Polynomial(knots.into()),
            support: false,
            derivative: 0,
        }
    }
}

impl PlottedBasis {
    /// The degree.
    pub fn degree(&self) -> usize {
        match &self.functions {
            PlottedFunctions::Polynomial(functions) => functions.degree(),
            PlottedFunctions::Rational(basis) => basis.knots().degree(),
        }
    }

    /// All knots, in order.
    pub fn knots(&self) -> &[f64] {
        match &self.functions {
            PlottedFunctions::Polynomial(functions) => functions.knots(),
            PlottedFunctions::Rational(basis) => basis.knots().values(),
        }
    }

    /// How many functions there are.
    pub fn count(&self) -> usize {
        self.knots().len() - self.degree() - 1
    }

    /// Where functions are drawn: on the domain, or from the first knot to the last.
    pub fn shown(&self) -> [f64; 2] {
        let knots = self.knots();
        match self.support {
            true => [knots[0], knots[knots.len() - 1]],
            false => [knots[self.degree()], knots[self.count()]],
        }
    }

    /// Whether the functions have weights that differ.
    pub fn is_rational(&self) -> bool {
        match &self.functions {
            PlottedFunctions::Polynomial(_) => false,
            PlottedFunctions::Rational(basis) => {
                basis.weights().iter().any(|&weight| weight != basis.weights()[0])
            }
        }
    }

    /// Whether a function is 0 everywhere: its knots are all equal, or its weight is 0, or there is
    /// none of that number.
    pub fn vanishes(&self, index: usize) -> bool {
        match &self.functions {
            PlottedFunctions::Polynomial(functions) => functions.vanishes(index),
            PlottedFunctions::Rational(basis) => {
                basis.weights().get(index).is_none_or(|&weight| weight == 0.0)
            }
        }
    }

    /// The value or derivative of a function that is drawn, at a parameter where it is drawn.
    pub fn value(&self, index: usize, t: f64) -> f64 {
        match &self.functions {
            PlottedFunctions::Polynomial(functions) => {
                functions.derivative(index, self.derivative, t)
            }
            PlottedFunctions::Rational(basis) => basis.derivative(index, self.derivative, t),
        }
    }
}

impl BasisSpec {
    /// Returns the basis; `fails` makes the error about the plot.
    ///
    /// # Errors
    /// When the numbers of functions, knots and weights do not match, or some are not valid.
    pub(super) fn checked(
        &self,
        fails: impl Fn(&Place, PlotError) -> SceneError,
    ) -> Result<PlottedBasis, SceneError> {
        let functions = self.functions().map_err(|(place, error)| fails(place, error))?;
        let derivative = self.derivative.as_ref().map_or(0, |order| order.value);
        if let Some(order) = self.derivative.as_ref().filter(|order| order.value > self.degree) {
            let error = PlotError::Derivative { found: order.value, degree: self.degree };
            return Err(fails(&order.place, error));
        }
        Ok(PlottedBasis { functions, support: self.support, derivative })
    }

    fn functions(&self) -> Result<PlottedFunctions, (&Place, PlotError)> {
        let count = self.point_count()?;
        let at_knots = |error: KnotError| (&self.knots.place, PlotError::Basis(error.into()));
        let Some(weights) = &self.weights else {
            let functions = self.polynomial(count).map_err(at_knots)?;
            return Ok(PlottedFunctions::Polynomial(functions));
        };
        let knots = knot_vector(self.degree, &self.knots.value, count).map_err(at_knots)?;
        let sizes = [count, knots.point_count()].map(|count| [1, count]);
        let basis = RationalBasis::new(knots, wrapped(&weights.value, sizes[0], sizes[1]));
        let at_weights = |error: CurveError| (&weights.place, PlotError::Basis(error));
        Ok(PlottedFunctions::Rational(basis.map_err(at_weights)?))
    }

    /// The number of control points, from those of `count`, `knots` and `weights` that are given.
    fn point_count(&self) -> Result<usize, (&Place, PlotError)> {
        let (degree, knots) = (self.degree, &self.knots);
        let weights = self.weights.as_ref();
        if let Some(weights) = weights.filter(|_| self.support) {
            return Err((&weights.place, PlotError::WeightedSupport));
        }
        let listed = self.listed();
        if let (None, Some(found), 0..=MAX_DEGREE) = (self.count, listed, degree) {
            if found < degree + 2 {
                let error = KnotError::NoFunction { knots: found, degree };
                return Err((&knots.place, PlotError::Basis(error.into())));
            }
            if found < 2 * degree + 2 && !self.support {
                return Err((&knots.place, PlotError::NoDomain { knots: found, degree }));
            }
        }
        let of_knots = match &knots.value {
            Knots::Periodic(period) => Some(period.len().saturating_sub(1)),
            _ => listed.map(|knots| knots.saturating_sub(degree.saturating_add(1))),
        };
        if let (Some(weights), Some(points)) = (weights, self.count.or(of_knots)) {
            let found = weights.value.len();
            if found != points {
                let error = match self.count {
                    Some(count) => PlotError::Count { count, weights: found },
                    None => PlotError::Weights { weights: found, points, degree },
                };
                return Err((&weights.place, error));
            }
        }
        let of_weights = weights.map(|weights| weights.value.len());
        let count = self.count.or(of_weights).or(of_knots);
        let count = count.ok_or((&knots.place, PlotError::NoCount))?;
        if count > MAX_FUNCTIONS {
            return Err((&knots.place, PlotError::Functions { count }));
        }
        Ok(count)
    }

    /// The number of knots that are listed, other than those of a period.
    fn listed(&self) -> Option<usize> {
        match &self.knots.value {
            Knots::ClampedUniform
            | Knots::Standard
            | Knots::Uniform
            | Knots::PeriodicUniform
            | Knots::Periodic(_) => None,
            Knots::Values(values) => Some(values.len()),
            Knots::Multiplicities(pairs) => {
                Some(pairs.iter().map(|&(_, times)| times).fold(0, usize::saturating_add))
            }
        }
    }

    /// `count` functions without weights. Unless all of their support is drawn, there must be a
    /// domain.
    fn polynomial(&self, count: usize) -> Result<BasisFunctions, KnotError> {
        let degree = self.degree;
        if degree > MAX_DEGREE {
            return Err(KnotError::BasisDegree { degree });
        }
        let closes = self.knots.value.are_closed();
        if !closes && self.support && count == 0 {
            return Err(KnotError::NoPoints);
        }
        if !closes && !self.support && count < degree + 1 {
            return Err(KnotError::TooFewPoints { points: count, degree });
        }
        if let Some(knots) = self.listed().filter(|&knots| knots != count + degree + 1) {
            return Err(KnotError::Count { knots, points: count, degree });
        }
        let values = match &self.knots.value {
            Knots::ClampedUniform if degree == 0 => {
                (0..=count).map(|index| index as f64 / count as f64).collect()
            }
            Knots::ClampedUniform => KnotVector::clamped_uniform(degree, count)?.values().to_vec(),
            Knots::Standard if degree == 0 => (0..=count).map(|index| index as f64).collect(),
            Knots::Standard => KnotVector::standard(degree, count)?.values().to_vec(),
            Knots::Uniform => (0..=count + degree).map(|index| index as f64).collect(),
            Knots::PeriodicUniform => periodic_values(degree, &evenly_spaced(count))?,
            Knots::Periodic(period) if period.len() != count + 1 => {
                return Err(KnotError::PeriodCount { knots: period.len(), points: count });
            }
            Knots::Periodic(period) => periodic_values(degree, period)?,
            Knots::Values(values) => values.clone(),
            Knots::Multiplicities(pairs) => {
                if let Some(&(knot, _)) = pairs.iter().find(|&&(_, times)| times == 0) {
                    return Err(KnotError::NoMultiplicity { knot });
                }
                let runs = pairs.iter().map(|&(knot, times)| std::iter::repeat_n(knot, times));
                runs.flatten().collect()
            }
        };
        let (start, end) = (values[degree], values[values.len() - 1 - degree]);
        let functions = BasisFunctions::new(degree, values)?;
        if start == end && !self.support {
            return Err(KnotError::EmptyDomain { start, end, degree, last: count });
        }
        Ok(functions)
    }
}
