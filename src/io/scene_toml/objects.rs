//! Objects in a scene file: where they go, and the shapes that are written as numbers.

use std::path::Path;
use std::sync::Arc;

use toml::Spanned;

use super::keys::{Grid, NurbsKeys, ObjectKeys, ShapeKeys, ShapeSource, TriangleKeys};
use super::kinds::OneOf;
use super::transforms::TransformKeys;
use super::values::Measures;
use super::{LoadError, Reader};
use crate::geometry::is_usable_weight;
use crate::io::keyed::Keyed;
use crate::io::nearby::stem;
use crate::scene::{Knots, Net, Object, Part, Place, Shape, Transform, TriangleNet, Written};

impl Reader<'_, '_> {
    pub(super) fn object(&mut self, Keyed(keys): Keyed<ObjectKeys>) -> Result<Object, LoadError> {
        let name = keys.name.map(|name| self.name(name)).transpose()?;
        let material = keys.material.map(|material| self.written(material, |name| name));
        let transform = keys.transform.into_iter().map(|step| self.transform(step)).collect();
        let place = self.source.place(keys.shape.span().start);
        let called = name.as_ref().map(|name| name.value.as_str());
        let OneOf(shape) = keys.shape.into_inner();
        let (default_name, mut parts) = self.shape(called, place, shape)?;
        if let Some(trims) = keys.trims {
            self.trim(trims, &mut parts)?;
        }
        let (reverse, swap_uv) = (keys.reverse, keys.swap_uv);
        Ok(Object { name, default_name, parts, transform, material, reverse, swap_uv })
    }

    pub(super) fn transform(&self, OneOf(step): OneOf<TransformKeys>) -> Written<Transform> {
        match step {
            TransformKeys::Translate(by) => self.written(by, |by| Transform::Translate(by.0)),
            TransformKeys::Rotate(Keyed(keys)) => {
                let degrees = keys.degrees.0;
                self.written(keys.axis, |axis| Transform::Rotate { axis: axis.0, degrees })
            }
            TransformKeys::Scale(by) => self.written(by, |by| Transform::Scale(by.0)),
            TransformKeys::Matrix(rows) => {
                self.written(rows, |rows| Transform::Matrix(rows.0.map(|row| row.0.map(|x| x.0))))
            }
        }
    }

    /// Returns the surfaces of a shape, and before them the name of an object that has none.
    fn shape(
        &mut self,
        called: Option<&str>,
        place: Place,
        shape: ShapeKeys,
    ) -> Result<(String, Vec<Part>), LoadError> {
        let here = place.clone();
        let only = |shape| vec![Part { name: String::new(), place: here, shape, trims: None }];
        match shape.source() {
            ShapeSource::Named(named, measures) => {
                let measures = self.measures(measures);
                Ok((named.name().to_owned(), only(Shape::Named(named, measures))))
            }
            ShapeSource::Nurbs(keys) => {
                let Keyed(keys) = *keys;
                let net = self.net(called.unwrap_or("nurbs"), keys)?;
                Ok(("nurbs".to_owned(), only(Shape::Net(Arc::new(net)))))
            }
            ShapeSource::Triangle(keys) => {
                let Keyed(keys) = *keys;
                let triangle = self.triangle(keys);
                Ok(("triangle".to_owned(), only(Shape::Triangle(Arc::new(triangle)))))
            }
            ShapeSource::Subdivision(scheme, keys) => {
                let Keyed(keys) = *keys;
                let (name, surface) = self.subdivision(scheme, (called, &place), keys)?;
                Ok((name, only(Shape::Subdivision(Arc::new(surface)))))
            }
            ShapeSource::Built(keys) => {
                let mut measures = Measures::new();
                let construction = keys.construction(self, &mut measures)?;
                let name = construction.name().to_owned();
                let measures = self.measures(measures);
                Ok((name, only(Shape::Built(Arc::new(construction), measures))))
            }
            ShapeSource::File(file) => {
                let place = self.source.place(file.span().start);
                let path = Path::new(file.get_ref());
                let stem = stem(path);
                let model = (self.read_model)(path, called.unwrap_or(&stem), &place)?;
                self.notes.extend(model.notes);
                Ok((stem, model.parts))
            }
        }
    }

    /// The measures, which have names in errors, each with its place.
    fn measures(&self, measures: Measures) -> Vec<Written<&'static str>> {
        let place = |(name, offset)| Written::new(name, self.source.place(offset));
        measures.into_iter().map(place).collect()
    }

    fn net(&self, called: &str, keys: NurbsKeys) -> Result<Net, LoadError> {
        let offset = keys.points.span().start;
        let knots = [keys.knots_u, keys.knots_v].map(|knots| match knots {
            Some(knots) => self.written(knots, |knots| knots.0),
            // No knots are written: errors point at the net that these are made for.
            None => Written::new(Knots::ClampedUniform, self.source.place(offset)),
        });
        let size = self.size(called, "points", keys.points.get_ref())?;
        let points = flat(keys.points.get_ref()).map(|point| point.0).collect();
        let points = Written::new(points, self.source.place(offset));
        let weights =
            keys.weights.map(|weights| self.weights(called, weights, size)).transpose()?;
        let place = self.source.place(keys.degree.span().start);
        let degree = keys.degree.get_ref().0;
        let degree = degree.map(|degree| Written::new(degree as usize, place.clone()));
        Ok(Net { degree, knots, size, points, weights })
    }

    /// A triangle's numbers, each with its place: errors name one of them.
    fn triangle(&self, keys: TriangleKeys) -> TriangleNet {
        let place = self.source.place(keys.points.span().start);
        let points = keys.points.into_inner().into_iter();
        let points = points.map(|point| self.written(point, |point| point.0)).collect();
        let points = Written::new(points, place);
        let weights = keys.weights.map(|weights| {
            let place = self.source.place(weights.span().start);
            let weights = weights.into_inner().into_iter();
            let weights = weights.map(|weight| self.written(weight, |weight| weight)).collect();
            Written::new(weights, place)
        });
        let degree = self.written(keys.degree, |degree| degree.0 as usize);
        TriangleNet { degree, points, weights }
    }

    /// The rows and columns of a grid, which must be the same for every row.
    fn size<T>(&self, called: &str, key: &str, grid: &Grid<T>) -> Result<[usize; 2], LoadError> {
        let columns = grid.first().map_or(0, |row| row.get_ref().len());
        let ragged = grid.iter().enumerate().find(|(_, row)| row.get_ref().len() != columns);
        match ragged {
            None => Ok([grid.len(), columns]),
            Some((index, row)) => {
                let found = row.get_ref().len();
                let message = format!(
                    "surface \"{called}\": row {index} of {key} has {found}, but row 0 has {columns}"
                );
                Err(LoadError::malformed(self.source.place(row.span().start), message))
            }
        }
    }

    /// The weights; their place is that of the first unusable one, if there is one.
    fn weights(
        &self,
        called: &str,
        weights: Spanned<Grid<Spanned<f64>>>,
        size: [usize; 2],
    ) -> Result<Written<Vec<f64>>, LoadError> {
        let place = self.source.place(weights.span().start);
        let weights = weights.into_inner();
        let found = self.size(called, "weights", &weights)?;
        if found != size {
            let message = format!(
                "surface \"{called}\": {} × {} weights for {} × {} points",
                found[0], found[1], size[0], size[1]
            );
            return Err(LoadError::malformed(place, message));
        }
        let unusable = flat(&weights).find(|w| !is_usable_weight(*w.get_ref()));
        let place = unusable.map_or(place, |weight| self.source.place(weight.span().start));
        Ok(Written::new(flat(&weights).map(|weight| *weight.get_ref()).collect(), place))
    }
}

/// A grid's entries, v fastest.
fn flat<T>(grid: &Grid<T>) -> impl Iterator<Item = &T> {
    grid.iter().flat_map(|row| row.get_ref())
}
