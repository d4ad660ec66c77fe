//! A compiled shader group: what a host makes once and shades with for ever.

use super::report::ReportPlace;
use crate::closure::Library;
use crate::ir::op::{AttributeOf, Input, PrintTo, Reach, Routine};
use crate::ir::program::*;
use crate::ir::verify::{VerifyError, verify};
use crate::lang::closures::{ClosureId, ClosureSpec, ClosureTable};
use crate::lang::globals::Global;
use crate::lang::symbols::Symbol;
use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use velour_grammar::Span;

static NEXT_ID: AtomicU64 = AtomicU64::new(1);

/// Turns a span of the program into the place where it was written.
pub type Locate = Arc<dyn Fn(Span) -> ReportPlace + Send + Sync>;

/// A compiled, optimised shader group.
#[derive(Clone)]
pub struct Group {
    pub(super) id: u64,
    pub(super) program: Arc<Program>,
    pub(super) library: Arc<Library>,
    pub(super) locate: Locate,
    inputs: Arc<Vec<(Reg, Input)>>,
    /// See [`Group::spent`].
    spent: Arc<Vec<bool>>,
    /// The closures that can occur.
    closures: Arc<Vec<ClosureId>>,
}

impl std::fmt::Debug for Group {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Group").field("id", &self.id).field("program", &self.program).finish_non_exhaustive()
    }
}

impl Group {
    /// A group of an optimised program.
    ///
    /// # Errors
    /// The first promise of [`crate::ir::verify`] that the program breaks.
    pub fn new(program: Program, library: Arc<Library>, locate: Locate) -> Result<Self, VerifyError> {
        verify(&program, library.table())?;
        let mut read = vec![0u32; program.regs.len()];
        let mut closures = Vec::new();
        visit_instrs(&program.body, &mut |instr| {
            instr.reads(|reg| read[reg.0 as usize] += 1);
            if let Instr::Leaf { closure, .. } = instr
                && !closures.contains(closure)
            {
                closures.push(*closure);
            }
        });
        mark_conditions(&program.body, &mut read);
        for output in &program.outputs {
            if let OutputValue::Regs(regs) = &output.value {
                regs.iter().for_each(|reg| read[reg.0 as usize] += 1);
            }
        }
        let inputs = program.regs.iter().enumerate().filter_map(|(i, info)| match info.source {
            Source::Input(input) if read[i] > 0 => Some((Reg(i as u32), input)),
            Source::Input(_) | Source::Const(_) | Source::Code => None,
        });
        let inputs = Arc::new(inputs.collect());
        let mut spent = vec![false; program.regs.len()];
        mark_spent(&program, &program.body, &read, &mut spent);
        let id = NEXT_ID.fetch_add(1, Ordering::Relaxed);
        Ok(Group {
            id,
            program: Arc::new(program),
            library,
            locate,
            inputs,
            spent: Arc::new(spent),
            closures: Arc::new(closures),
        })
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The closures it was compiled with.
    pub fn library(&self) -> &Library {
        &self.library
    }

    /// Their declarations.
    pub fn table(&self) -> &ClosureTable {
        self.library.table()
    }

    /// The inputs it reads and the registers they go to.
    pub fn inputs(&self) -> &[(Reg, Input)] {
        &self.inputs
    }

    /// How many numbers an output has and whether they are ints; nothing for one that the group does not keep, for strings and
    /// for closures. Names are those of [`super::Machine::output`].
    pub fn output_shape(&self, name: &str) -> Option<(usize, bool)> {
        let output = self.program.output(name)?;
        let (kind, count) = match &output.value {
            OutputValue::Regs(regs) => (self.program.kind(*regs.first()?), regs.len()),
            OutputValue::Array(array) => {
                let info = &self.program.arrays[array.0 as usize];
                (info.kind, (info.len * info.components) as usize)
            }
        };
        matches!(kind, Kind::Float | Kind::Int).then_some((count, kind == Kind::Int))
    }

    /// Where the program, as it is after optimising, calls `error`, in the order of the text.
    pub fn error_calls(&self) -> Vec<ReportPlace> {
        let mut places = Vec::new();
        visit_instrs(&self.program.body, &mut |instr| {
            if let Instr::Call { routine: Routine::Print(PrintTo::Error, _), span, .. } = instr {
                places.push((self.locate)(*span));
            }
        });
        places
    }

    /// May the group ask for one of these attributes of what is shaded, or for its derivatives where `slopes` is true? A name that is
    /// computed may be any.
    pub fn asks_for(&self, names: &[&str], slopes: bool) -> bool {
        let mut found = false;
        visit_instrs(&self.program.body, &mut |instr| {
            if let Instr::Call { routine: Routine::Attribute(query), src, .. } = instr {
                let named = match self.program.constant(src[1]) {
                    Some(Const::String(symbol)) => names.contains(&Symbol(symbol).text()),
                    _ => true,
                };
                found |= query.of == AttributeOf::Attribute && named && (query.slopes || !slopes);
            }
        });
        found
    }

    /// Does the group draw random numbers, which are of the point's place?
    pub fn draws(&self) -> bool {
        let mut found = false;
        visit_instrs(&self.program.body, &mut |instr| {
            found |= matches!(instr, Instr::Call { routine: Routine::Random(_), .. });
        });
        found
    }

    /// Is the register read by nothing but a move of floats that follows it in its block? The move may take its column, which the
    /// next run of the block writes anew before it is read.
    pub(super) fn spent(&self, reg: Reg) -> bool {
        self.spent[reg.0 as usize]
    }

    /// The closures that can occur, each once, in the order of the program.
    pub fn closures(&self) -> impl Iterator<Item = &ClosureSpec> {
        self.closures.iter().map(|&id| self.library.get(id))
    }

    /// Can a closure occur that nests others, so that what it lets through depends on the direction?
    pub fn nests(&self) -> bool {
        self.closures().any(ClosureSpec::nests)
    }

    /// Does it read a shader global?
    pub fn reads(&self, global: Global) -> bool {
        self.inputs.iter().any(|(_, input)| matches!(input, Input::Global(g, _) if *g == global))
    }

    /// Does it read the derivatives of a shader global?
    pub fn reads_derivative(&self, global: Global) -> bool {
        let derived = |input: &Input| matches!(input, Input::GlobalDx(g, _) | Input::GlobalDy(g, _) if *g == global);
        self.inputs.iter().any(|(_, input)| derived(input))
    }

    /// Can it emit light?
    pub fn can_emit(&self) -> bool {
        self.closures().any(|spec| spec.emits)
    }

    /// Can it scatter light?
    pub fn can_scatter(&self) -> bool {
        self.closures().any(|spec| spec.scatters)
    }

    /// Can light pass it straight on?
    pub fn can_pass(&self) -> bool {
        self.closures().any(|spec| spec.passes)
    }

    /// Can it be a hole in the alpha channel?
    pub fn can_hold_out(&self) -> bool {
        self.closures().any(|spec| spec.holds_out)
    }

    /// Does what it computes differ from point to point of one object?
    pub fn varies_on_object(&self) -> bool {
        let mut rays = false;
        visit_instrs(&self.program.body, &mut |instr| {
            rays |= matches!(instr, Instr::Call { routine, .. } if routine.declaration().reach == Reach::Lane);
        });
        rays || self.inputs.iter().any(|(_, input)| *input != Input::SurfaceArea)
    }

    /// A place noted in a closure tree.
    pub fn place(&self, site: u32) -> ReportPlace {
        (self.locate)(Span { first: site, last: site })
    }
}

fn mark_conditions(block: &Block, read: &mut [u32]) {
    for node in block {
        match node {
            Node::If(condition, a, b) => {
                read[condition.0 as usize] += 1;
                mark_conditions(a, read);
                mark_conditions(b, read);
            }
            Node::Loop { head, condition, body, .. } => {
                read[condition.0 as usize] += 1;
                mark_conditions(head, read);
                mark_conditions(body, read);
            }
            Node::Scope(_, body) => mark_conditions(body, read),
            Node::Instr(_) | Node::Leave(_) => {}
        }
    }
}

/// Marks the registers that [`Group::spent`] tells of.
fn mark_spent(program: &Program, block: &Block, read: &[u32], spent: &mut [bool]) {
    let mut written = HashSet::new();
    for node in block {
        match node {
            Node::Instr(instr) => {
                if let Instr::Move { dst, src, .. } = instr {
                    let (to, from) = (program.regs[dst.0 as usize], program.regs[src.0 as usize]);
                    let columns = to.kind == Kind::Float && from.kind == Kind::Float && to.uniform == from.uniform;
                    let own = from.source == Source::Code && !from.mutable && written.contains(src);
                    spent[src.0 as usize] = columns && own && read[src.0 as usize] == 1;
                }
                instr.writes(|reg| {
                    written.insert(reg);
                });
            }
            Node::If(_, a, b) => [a, b].into_iter().for_each(|block| mark_spent(program, block, read, spent)),
            Node::Loop { head, body, .. } => {
                [head, body].into_iter().for_each(|block| mark_spent(program, block, read, spent));
            }
            Node::Scope(_, body) => mark_spent(program, body, read, spent),
            Node::Leave(_) => {}
        }
    }
}
