//! A closure in one piece: its declaration, and the function that makes lobes of a call.

use super::arguments::{Arguments, ReadArguments, Text, declared};
use super::leaf::LeafMaker;
use crate::lang::closures::{ClosureSpec, ParamSpec, TopAlbedo, Waiver};
use std::sync::Arc;

/// Makes the lobes of one leaf.
pub(super) type Prepare = dyn Fn(&Arguments<'_>, &mut LeafMaker<'_>) + Send + Sync;

/// A closure: what it is called and takes, and what it scatters.
///
/// ```
/// use velour::bsdf::lambert::Lambert;
/// use velour::closure::{ClosureDef, Color, Library, LobeKind, Normal};
/// use velour::lang::closures::ParamSpec;
///
/// velour::arguments! {
///     struct Matte {
///         N: Normal = ParamSpec::about("shading normal, unit length"),
///         albedo: Color = ParamSpec::about("color of the reflection, 0..1"),
///     }
/// }
/// let matte = ClosureDef::new("my_matte", "Lambert's reflection of a color", |a: Matte, leaf| {
///     leaf.tint(a.albedo);
///     let frame = leaf.frame(a.N, None);
///     leaf.lobe(LobeKind::of::<Lambert>(), frame, &[]);
/// });
/// let mut library = Library::standard();
/// library.register(matte)?;
/// assert!(library.named("my_matte").next().is_some());
/// # Ok::<(), velour::closure::RegisterError>(())
/// ```
#[derive(Clone)]
pub struct ClosureDef {
    pub(super) spec: ClosureSpec,
    pub(super) prepare: Arc<Prepare>,
}

const LABEL: ParamSpec = ParamSpec::about("a name for the host; velour carries it and gives it no meaning");

impl ClosureDef {
    /// A closure of a name and a line of documentation, whose arguments are `A` and whose calls `prepare` makes lobes of.
    pub fn new<A: ReadArguments>(
        name: &'static str,
        doc: &'static str,
        prepare: impl Fn(A, &mut LeafMaker<'_>) + Send + Sync + 'static,
    ) -> Self {
        // Every closure takes a label, after the keywords that it reads.
        let label = declared::<Text>("label", LABEL);
        let keywords = A::keywords().into_iter().chain([label]).collect();
        let prepare = move |arguments: &Arguments<'_>, leaf: &mut LeafMaker<'_>| prepare(A::read(arguments), leaf);
        ClosureDef { spec: ClosureSpec::new(name, doc, A::params(), keywords), prepare: Arc::new(prepare) }
    }

    /// The declaration.
    pub fn spec(&self) -> &ClosureSpec {
        &self.spec
    }

    /// The same closure with its formula, in lines of plain text, and where that is from: author, year, equation.
    pub fn formula(mut self, formula: &'static str, source: &'static str) -> Self {
        (self.spec.formula, self.spec.source) = (formula, source);
        self
    }

    /// The same closure without some promises.
    pub fn without(mut self, waivers: &'static [Waiver]) -> Self {
        self.spec.waivers = waivers;
        self
    }

    /// The same closure, promising to lose nothing where its parameters are white.
    pub fn lossless(mut self) -> Self {
        self.spec.lossless = true;
        self
    }

    /// The same closure as a light: its weight is radiance, and it has no lobes.
    pub fn emitting(mut self) -> Self {
        (self.spec.emits, self.spec.scatters) = (true, false);
        self
    }

    /// The same closure as a hole in the alpha channel: its weight says how much of one, and it has no lobes.
    pub fn holding_out(mut self) -> Self {
        (self.spec.holds_out, self.spec.scatters) = (true, false);
        self
    }

    /// The same closure, which may let light pass straight on ([`LeafMaker::straight`]): shadow rays then go through its surfaces
    /// with the color that it has there. Without this they end there, and light is found behind by scattering alone.
    pub fn passing(mut self) -> Self {
        self.spec.passes = true;
        self
    }

    /// The same closure, without lobes.
    pub fn inert(mut self) -> Self {
        self.spec.scatters = false;
        self
    }

    /// The same closure with another way to find its albedo as the top of a layer than by a formula.
    pub fn top_albedo(mut self, by: TopAlbedo) -> Self {
        self.spec.top_albedo = by;
        self
    }
}

impl std::fmt::Debug for ClosureDef {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ClosureDef").field("spec", &self.spec).finish_non_exhaustive()
    }
}
