//! What a host gives to its shaders besides points, and what it hears from them.

use super::points::{Points, RAY_TYPES};
use super::report::Report;
use crate::ir::op::AttributeType;
use crate::lang::symbols::{Strings, Symbol};
use crate::ops::matrix::{IDENTITY, Matrix, inverse, multiply};
use crate::texture::Texture;
use std::collections::HashMap;
use std::sync::Arc;

/// What shaders ask beside their points. Every question is asked once a batch, for all its lanes; what no shader of a group
/// asks is never computed. Many threads ask at the same time.
pub trait Host: Send + Sync {
    /// The matrix from a named space to "common", rows on the left (`p M`), one for all points of a batch; nothing for a space that
    /// is not known. By default there are those of [`built_in_space`].
    fn space(&self, name: &str, points: &Points) -> Option<Matrix> {
        let _ = points;
        built_in_space(name)
    }

    /// Answers for an attribute: of the scene, of a named object, or, with an empty object, of what each point lies on. By default
    /// there is none.
    fn attribute(&self, asked: &AttributeRequest<'_>, answer: &mut AttributeAnswer<'_>) {
        let _ = (asked, answer);
    }

    /// The bits of [`Points::ray_type`] that a name of `raytype` stands for, 0 for an unknown one. By default those of
    /// [`RAY_TYPES`].
    fn ray_type(&self, name: &str) -> i32 {
        RAY_TYPES.iter().find(|(known, _)| *known == name).map_or(0, |(_, bits)| *bits)
    }

    /// Answers for a message of a named source, as `getmessage("trace", "hitdist", …)` asks; the source stands for the object. By
    /// default there is none.
    fn message(&self, asked: &AttributeRequest<'_>, answer: &mut AttributeAnswer<'_>) {
        let _ = (asked, answer);
    }

    /// The texture of a name, which need not be a file's; or why there is none. By default there are none.
    ///
    /// # Errors
    /// One clause for the person who wrote the shader.
    fn texture(&self, name: &str) -> Result<Arc<Texture>, String> {
        Err(format!("there is no texture `{name}`: this host has none"))
    }

    /// What rays of `trace` meet: true for each that meets something. By default none does.
    fn trace(&self, asked: &TraceRequest<'_>) -> Vec<bool> {
        vec![false; asked.lanes.len()]
    }

    /// The text of a file that a shader names as its dictionary; by default there are no files.
    ///
    /// # Errors
    /// One clause for the person who wrote the shader.
    fn read_text(&self, name: &str) -> Result<String, String> {
        Err(format!("there is no file `{name}`: this host has none"))
    }

    /// Is the label of a closure of this name written where it has none? By default no label is.
    fn prints_label(&self, closure: &str) -> bool {
        let _ = closure;
        false
    }

    /// Does whoever waits for the batch not want it any more, as when the time is up? Asked now and then while a shader loops; the
    /// batch then ends without results, see [`super::Machine::given_up`].
    fn gives_up(&self) -> bool {
        false
    }

    /// Hears what one batch has said, lane by lane, and may take it; what it leaves waits in the machine for
    /// [`super::Machine::take_reports`]. Not called for a batch that says nothing.
    fn hear(&self, reports: &mut Vec<Report>) {
        let _ = reports;
    }
}

/// The spaces that are there without being named, all equal to common: "common", "world", "object" and "shader".
pub fn built_in_space(name: &str) -> Option<Matrix> {
    matches!(name, "" | "common" | "world" | "object" | "shader").then_some(IDENTITY)
}

/// The matrix from one space to another, both given as the way to common.
pub(super) fn between(from: Option<Matrix>, to: Option<Matrix>) -> Option<Matrix> {
    Some(multiply(&from?, &inverse(&to?)))
}

/// The value of a named attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// Ints.
    Ints(Vec<i32>),
    /// Floats.
    Floats(Vec<f32>),
    /// Strings.
    Strings(Vec<String>),
}

/// An attribute that shaders ask for.
#[derive(Clone, Copy, Debug)]
pub struct AttributeRequest<'a> {
    /// The object's name; empty for what is being shaded, and then the scene.
    pub object: &'a str,
    /// The attribute's name.
    pub name: &'a str,
    /// The type and how many numbers it has; only a value of this shape is an answer.
    pub ty: AttributeType,
    /// The element that is asked for, of an array of such values; whoever answers may give all of the array.
    pub element: Option<usize>,
    /// True when derivatives are read as well; floats only.
    pub slopes: bool,
    /// The points of the batch.
    pub points: &'a Points,
}

/// Rays that shaders of a batch send out.
#[derive(Clone, Copy, Debug)]
pub struct TraceRequest<'a> {
    /// The lanes that ask, a ray each.
    pub lanes: &'a [usize],
    /// Origin, direction, and the least and the most distance of a hit, in units of the direction's length.
    pub rays: &'a [[f32; 8]],
    /// The points of the batch.
    pub points: &'a Points,
}

/// Where the answer for an attribute goes, lane by lane. A lane without an answer has no such attribute.
pub struct AttributeAnswer<'a> {
    pub(super) ty: AttributeType,
    pub(super) element: Option<usize>,
    pub(super) lanes: &'a [usize],
    pub(super) found: &'a mut [i32],
    /// A column a number, then, when they are asked for, its derivatives along x and along y.
    pub(super) floats: &'a mut [Vec<f32>],
    pub(super) ints: &'a mut [Vec<i32>],
    pub(super) strings: &'a mut Strings,
}

impl std::fmt::Debug for AttributeAnswer<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AttributeAnswer").field("ty", &self.ty).field("lanes", &self.lanes).finish_non_exhaustive()
    }
}

impl<'a> AttributeAnswer<'a> {
    /// The lanes that ask.
    pub fn lanes(&self) -> &'a [usize] {
        self.lanes
    }

    /// Answers with one value in all lanes, whose derivatives are zero. A value of another shape is no answer.
    pub fn all(&mut self, value: &Attribute) {
        for &lane in self.lanes {
            match value {
                Attribute::Ints(values) => self.ints(lane, values),
                Attribute::Floats(values) => self.floats(lane, values),
                Attribute::Strings(values) => self.strings(lane, values),
            }
        }
    }

    /// Of the values of an array those of the element that is asked for.
    fn part<'v, T>(&self, values: &'v [T]) -> &'v [T] {
        let count = self.ty.kind().1 as usize;
        match self.element {
            None => values,
            Some(_) if count == 0 || !values.len().is_multiple_of(count) => &[],
            Some(element) => values.chunks(count).nth(element).unwrap_or(&[]),
        }
    }

    /// Answers with floats in one lane.
    pub fn floats(&mut self, lane: usize, values: &[f32]) {
        let values = self.part(values);
        if self.ty == AttributeType::Floats(values.len() as u32) {
            self.floats.iter_mut().zip(values).for_each(|(column, &value)| column[lane] = value);
            self.found[lane] = 1;
        }
    }

    /// Gives the derivatives of the floats in one lane, per pixel along the screen's x and y; without it they are zero.
    pub fn slopes(&mut self, lane: usize, dx: &[f32], dy: &[f32]) {
        let (dx, dy) = (self.part(dx), self.part(dy));
        let AttributeType::Floats(count) = self.ty else { return };
        let count = count as usize;
        if self.floats.len() == 3 * count && dx.len() == count && dy.len() == count {
            let columns = self.floats[count..].iter_mut();
            columns.zip(dx.iter().chain(dy)).for_each(|(column, &slope)| column[lane] = slope);
        }
    }

    /// Answers with ints in one lane.
    pub fn ints(&mut self, lane: usize, values: &[i32]) {
        let values = self.part(values);
        if self.ty == AttributeType::Ints(values.len() as u32) {
            self.ints.iter_mut().zip(values).for_each(|(column, &value)| column[lane] = value);
            self.found[lane] = 1;
        }
    }

    /// Answers with strings in one lane.
    pub fn strings<T: AsRef<str>>(&mut self, lane: usize, values: &[T]) {
        let values = self.part(values);
        if self.ty == AttributeType::Strings(values.len() as u32) {
            for (column, value) in self.ints.iter_mut().zip(values) {
                let Symbol(number) = self.strings.symbol(value.as_ref());
                column[lane] = number;
            }
            self.found[lane] = 1;
        }
    }
}

/// A host of two tables: named spaces, and attributes that are the same at every point.
#[derive(Clone, Debug, Default)]
pub struct PlainHost {
    /// The matrix from each named space to "common"; the built-in ones need not be named.
    pub spaces: HashMap<String, Matrix>,
    /// Attributes by name, whatever the object.
    pub attributes: HashMap<String, Attribute>,
}

impl Host for PlainHost {
    fn space(&self, name: &str, _points: &Points) -> Option<Matrix> {
        self.spaces.get(name).copied().or_else(|| built_in_space(name))
    }

    fn attribute(&self, asked: &AttributeRequest<'_>, answer: &mut AttributeAnswer<'_>) {
        if let Some(value) = self.attributes.get(asked.name) {
            answer.all(value);
        }
    }
}
