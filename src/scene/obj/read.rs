//! The statements of an OBJ file.

use super::flaw::{Attribute, LineFlaw, ObjFlaw};
use super::lines::{Lines, Words, shown};
use super::mesh::{Corner, ObjMesh, Part};
use super::notes::Note;
use super::number::{index, number};
use glam::{Vec2, Vec3};
use std::collections::{BTreeSet, HashMap};

/// The most corners of a face. Cutting ears takes time by the square of them.
const MOST_CORNERS: usize = crate::limits::CORNERS;

/// Vertices and corners are counted by 32 bits, and the last number stands for none.
const MOST: usize = u32::MAX as usize - 1;

/// Statements that change nothing of a mesh, or nothing that is shown: smoothing and merging groups, points, lines,
/// display and render hints.
const SILENT: [&[u8]; 17] = [
    b"s",
    b"p",
    b"l",
    b"mg",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"lod",
    b"shadow_obj",
    b"trace_obj",
    b"ctech",
    b"stech",
    b"usemap",
    b"maplib",
    b"vp",
    b"end",
    b"parm",
];

/// Reads the text of an OBJ file.
///
/// # Errors
/// It is no text, a number is none or not finite, an index is none or out of range. Each names its line.
pub fn read(text: &[u8]) -> Result<ObjMesh, ObjFlaw> {
    // Text has no zero bytes, and almost anything else has one early.
    if text[..text.len().min(4096)].contains(&0) {
        return Err(ObjFlaw::NotText);
    }
    let mut reader = Reader::new();
    for (line, bytes) in Lines::new(text) {
        reader.statement(line, &bytes).map_err(|flaw| ObjFlaw::Line { line, flaw })?;
    }
    reader.finish()
}

struct Reader {
    mesh: ObjMesh,
    /// Numbers of names.
    names: HashMap<String, u32>,
    /// The part that faces go to now.
    shape: u32,
    shape_name: u32,
    material: u32,
    /// The first face of it.
    first: usize,
    /// The farthest vertex of each kind that a face named before it was there, as written, and the line.
    ahead: [Option<(i64, u32)>; 3],
    /// Statements that have been noted.
    noted: BTreeSet<Vec<u8>>,
}

impl Reader {
    fn new() -> Self {
        let mesh = ObjMesh { names: vec![String::new()], ..ObjMesh::default() };
        let names = HashMap::from([(String::new(), 0)]);
        Reader { mesh, names, shape: 0, shape_name: 0, material: 0, first: 0, ahead: [None; 3], noted: BTreeSet::new() }
    }

    #[inline]
    fn statement(&mut self, line: u32, bytes: &[u8]) -> Result<(), LineFlaw> {
        let mut words = Words::new(bytes);
        let Some(statement) = words.next() else { return Ok(()) };
        match statement {
            b"v" => push(&mut self.mesh.positions, Vec3::from(numbers("v", words)?)),
            b"vn" => push(&mut self.mesh.normals, Vec3::from(numbers("vn", words)?)),
            b"vt" => push(&mut self.mesh.uvs, uv(words)?),
            b"f" | b"fo" => self.face(line, words),
            b"usemtl" => self.turn_to(self.shape, self.shape_name, |reader| reader.name(words.name())),
            b"o" | b"g" => {
                let name = self.name(words.name());
                // The same name again goes on with the same shape.
                let shape = if name == self.shape_name { self.shape } else { self.shape + 1 };
                self.turn_to(shape, name, |reader| reader.material)
            }
            b"mtllib" => {
                self.library(Note { line, text: words.name() });
                Ok(())
            }
            _ => {
                self.other(line, statement);
                Ok(())
            }
        }
    }

    /// Takes a library, once; a file that names hundreds is not meant.
    fn library(&mut self, library: Note) {
        let libraries = &mut self.mesh.libraries;
        if libraries.len() < 64 && libraries.iter().all(|known| known.text != library.text) {
            libraries.push(library);
        }
    }

    /// The number of a name.
    fn name(&mut self, name: String) -> u32 {
        let next = self.mesh.names.len() as u32;
        match self.names.entry(name) {
            std::collections::hash_map::Entry::Occupied(known) => *known.get(),
            std::collections::hash_map::Entry::Vacant(new) => {
                self.mesh.names.push(new.key().clone());
                *new.insert(next)
            }
        }
    }

    /// The faces that follow are of another shape or material.
    fn turn_to(
        &mut self,
        shape: u32,
        shape_name: u32,
        material: impl FnOnce(&mut Self) -> u32,
    ) -> Result<(), LineFlaw> {
        let material = material(self);
        if (shape, material) != (self.shape, self.material) {
            self.close_part();
        }
        (self.shape, self.shape_name, self.material) = (shape, shape_name, material);
        Ok(())
    }

    fn close_part(&mut self) {
        let Reader { shape, shape_name, material, .. } = *self;
        let faces = std::mem::replace(&mut self.first, self.mesh.ends.len())..self.mesh.ends.len();
        if !faces.is_empty() {
            self.mesh.parts.push(Part { shape, shape_name, material, faces });
        }
    }

    #[inline]
    fn face(&mut self, line: u32, words: Words) -> Result<(), LineFlaw> {
        let start = self.mesh.corners.len();
        for word in words {
            let corner = self.corner(line, word)?;
            self.mesh.corners.push(corner);
        }
        let (end, count) = (self.mesh.corners.len(), self.mesh.corners.len() - start);
        if count < 3 {
            self.mesh.corners.truncate(start);
            let corners = if count == 1 { "corner" } else { "corners" };
            self.mesh.notes.add(line, || format!("a face of {count} {corners} is left out"));
            return Ok(());
        }
        if count > MOST_CORNERS {
            return Err(LineFlaw::TooManyCorners { count, most: MOST_CORNERS });
        }
        if end > MOST {
            return Err(LineFlaw::TooMuch);
        }
        self.mesh.ends.push(end as u32);
        Ok(())
    }

    /// A corner: `V`, `V/T`, `V//N` or `V/T/N`.
    #[inline]
    fn corner(&mut self, line: u32, word: &[u8]) -> Result<Corner, LineFlaw> {
        let bad = || LineFlaw::NotAnIndex { word: shown(word) };
        let (position, mut rest) = index(word).ok_or_else(bad)?;
        let position = self.resolve(line, Attribute::Position, position)?;
        let mut others = [Corner::NONE; 2];
        for (slot, attribute) in others.iter_mut().zip([Attribute::Uv, Attribute::Normal]) {
            let [b'/', after @ ..] = rest else { break };
            rest = after;
            if !matches!(after, [] | [b'/', ..]) {
                let (written, after) = index(after).ok_or_else(bad)?;
                *slot = self.resolve(line, attribute, written)?;
                rest = after;
            }
        }
        if !rest.is_empty() {
            return Err(bad());
        }
        Ok(Corner { position, uv: others[0], normal: others[1] })
    }

    /// An index from 0 of one as written, which counts from 1, or backward from -1.
    #[inline]
    fn resolve(&mut self, line: u32, attribute: Attribute, index: i64) -> Result<u32, LineFlaw> {
        let count = self.mesh.count(attribute) as i64;
        let found = if index < 0 { count + index } else { index - 1 };
        if !(0..MOST as i64).contains(&found) {
            return Err(LineFlaw::OutOfRange { attribute, index, count: count as usize });
        }
        if found >= count {
            // It may still come.
            let ahead = &mut self.ahead[attribute as usize];
            if ahead.is_none_or(|(farthest, _)| index > farthest) {
                *ahead = Some((index, line));
            }
        }
        Ok(found as u32)
    }

    /// Notes a statement that is left out, once, unless it does not matter.
    #[cold]
    fn other(&mut self, line: u32, statement: &[u8]) {
        if SILENT.contains(&statement) || !self.noted.insert(statement[..statement.len().min(32)].to_vec()) {
            return;
        }
        // A file of nothing but nonsense should not fill the memory with it.
        if self.noted.len() > 64 {
            self.noted.clear();
        }
        let word = shown(statement);
        self.mesh.notes.add(line, || match statement {
            b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"trim" | b"hole" | b"scrv"
            | b"sp" | b"con" => format!("`{word}`: curves and surfaces are left out"),
            b"call" | b"csh" => format!("`{word}`: other files are not read"),
            _ => format!("unknown statement `{word}` is left out"),
        });
    }

    fn finish(mut self) -> Result<ObjMesh, ObjFlaw> {
        self.close_part();
        for attribute in [Attribute::Position, Attribute::Uv, Attribute::Normal] {
            let count = self.mesh.count(attribute);
            if let Some((index, line)) = self.ahead[attribute as usize].filter(|(index, _)| *index > count as i64) {
                if count == 0 && attribute != Attribute::Position {
                    // Files of subdivision surfaces do this.
                    let statement = attribute.statement();
                    self.mesh.notes.add(line, || format!("faces name `{statement}`, of which there are none"));
                    continue;
                }
                return Err(ObjFlaw::Line { line, flaw: LineFlaw::OutOfRange { attribute, index, count } });
            }
        }
        Ok(self.mesh)
    }
}

#[inline]
fn push<T>(list: &mut Vec<T>, item: T) -> Result<(), LineFlaw> {
    if list.len() >= MOST {
        return Err(LineFlaw::TooMuch);
    }
    list.push(item);
    Ok(())
}

/// Three numbers; what follows them is a weight or a colour, which meshes here do not have.
#[inline]
fn numbers(statement: &'static str, words: Words) -> Result<[f32; 3], LineFlaw> {
    let mut out = [0.0; 3];
    let mut found = 0;
    for (slot, word) in out.iter_mut().zip(words) {
        *slot = number(word)?;
        found += 1;
    }
    if found < 3 { Err(LineFlaw::TooFewNumbers { statement, found, needed: 3 }) } else { Ok(out) }
}

/// One or two numbers: v is 0 where it is not given.
#[inline]
fn uv(mut words: Words) -> Result<Vec2, LineFlaw> {
    let u = words.next().ok_or(LineFlaw::TooFewNumbers { statement: "vt", found: 0, needed: 1 })?;
    Ok(Vec2::new(number(u)?, words.next().map_or(Ok(0.0), number)?))
}
