//! Budgets for input that nobody vouches for: how much a shader, a batch, a scene or a file may take, each in one place.
//!
//! A budget is far beyond what people write, and what exceeds it is told of with the number. All of them together keep a render of hostile
//! input below a gigabyte a thread, whatever it says; `--memory` bounds the whole command, see `cli`. What the text of a shader
//! may take (nesting, includes, macros) stands in `velour_grammar::limits`.
//!
//! Decision (2026-11-29): constants, instead of settings that each caller hands through: a limit that differs from host to host makes
//! shaders that run here and not there, and a host that wants less has `--memory`, `--time` and `Machine::budget`.

/// Work of a batch, in simple instructions over all of it: a second or two.
pub const WORK: u64 = 20_000_000;

/// Bytes of all strings that a batch makes together, 64 MB.
pub const TEXT_BYTES: usize = 1 << 26;

/// Texts that a batch says (`printf`, `warning`, `error`, mistakes): so many are kept, the others counted.
pub const SAID_TEXTS: usize = 1 << 16;

/// Bytes of the texts that a batch says, 16 MB.
pub const SAID_BYTES: usize = 1 << 24;

/// Bytes of one text that a shader says; what is longer is cut.
pub const SAID_LENGTH: usize = 1 << 20;

/// Messages that a command prints of one kind of trouble, such as what shaders say in a render; then "and N more".
pub const PRINTED: usize = 1000;

/// Bytes of the messages that a command prints.
pub const PRINTED_BYTES: usize = 1 << 22;

/// Numbers in all variables of a shader at one point, arrays and structs with all that is in them. A batch has 512 points, which
/// makes half a gigabyte.
pub const NUMBERS: u64 = 1 << 18;

/// Instructions of a program before it is optimised: a group of shaders with all functions expanded in place.
pub const INSTRUCTIONS: usize = 1 << 20;

/// Statements and expressions of a shader with all functions expanded in place.
pub const EXPANDED: u64 = 4_000_000;

/// Elements of one array.
pub const ELEMENTS: i32 = 16_384;

/// Messages (`setmessage`) of different names or types in a batch.
pub const LEFT_MESSAGES: usize = 1024;

/// Numbers in those messages at one point.
pub const LEFT_NUMBERS: u32 = 1 << 16;

/// Dictionaries that a batch reads.
pub const DICTIONARIES: usize = 1024;

/// Nodes of dictionaries that a shader holds at one point.
pub const FOUND_NODES: usize = 10_000;

/// Nodes of the closure tree of a batch.
pub const CLOSURE_NODES: usize = 1 << 18;

/// Numbers in the columns of the closure tree of a batch, 64 MB.
pub const CLOSURE_NUMBERS: usize = 1 << 24;

/// Lobes of a batch of so many points, and as many layers over them, and weights on their way: all together take some 300 MB.
pub fn lobes(points: usize) -> usize {
    ((1 << 21) / points.max(1)).min(1 << 16)
}

/// Steps that a regular expression may go back in one text.
pub const PATTERN_STEPS: usize = 100_000;

/// Triangles, spheres and quads of a scene, some 6 GB with their hierarchy.
pub const PRIMITIVES: u64 = 40_000_000;

/// Triangles of one element that makes them by itself, and of all that displacement makes.
pub const MADE_TRIANGLES: u64 = 8_000_000;

/// Numbers or texts in the values that a scene gives to parameters, all together: 64 MB as it keeps them.
pub const SCENE_VALUES: usize = 1 << 24;

/// Bytes of a scene's text.
pub const SCENE_BYTES: u64 = 1 << 28;

/// Elements, texts and attributes' values of a scene, some 400 MB as the parser keeps them.
pub const SCENE_NODES: u32 = 4_000_000;

/// Attributes of an element: the parser of XML compares each with all others.
pub const ATTRIBUTES: usize = 1024;

/// Bytes of a mesh: some twenty million triangles.
pub const MESH_BYTES: u64 = 2 << 30;

/// Corners of a face.
pub const CORNERS: usize = 10_000;

/// Steps for cutting the polygons of a mesh into triangles, some seconds.
pub const CUTTING_STEPS: u64 = 1_000_000_000;

/// Bytes of an MTL file.
pub const LIBRARY_BYTES: u64 = 16 << 20;

/// Bytes of a shader, or of a text that a shader reads.
pub const SHADER_BYTES: u64 = velour_grammar::limits::FILE_BYTES;

/// Bytes of a file that says how a shader is compiled.
pub const RECIPE_BYTES: u64 = 1 << 16;

/// Bytes of the texts that a texture's file says of its picture; what is beyond is left out.
pub const ABOUT_BYTES: usize = 1 << 16;

/// Bytes of a texture's file; decoded it must fit into the memory of textures.
pub const TEXTURE_BYTES: u64 = 16 << 30;

/// Pixels of a picture.
pub const PIXELS: u64 = 1 << 27;

/// Pixels along a side of a frame that a picture is cut out of: beyond, its places are no longer whole in a single.
pub const FRAME_SIDE: u32 = 1 << 23;

/// Cells of a contact sheet along a sweep.
pub const CELLS: usize = 256;

/// Channels of the file of a part: ten tiers and two for carries, of five numbers of a word each, and of two in the last.
pub const PART_CHANNELS: usize = 65;

/// Times that the file of a part may be smaller than its numbers: runs of equal bytes are packed 64 to one.
pub const PART_PACKED: u64 = 80;

/// Bounces of a path: more make no difference, as roulette ends paths from [`ROULETTE`] on.
pub const BOUNCES: u32 = 1_000_000;

/// The bounce from which on roulette ends even paths that lose nothing, or a white closed room would never be done. What an albedo
/// of .999 has left by then is less than 1e-4; sooner, the few paths that survive would weigh more and more.
pub const ROULETTE: u32 = 10_000;

/// Threads for each processor.
pub const THREADS_A_CORE: usize = 4;
