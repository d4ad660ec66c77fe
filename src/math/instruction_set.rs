//! Which SIMD instructions the lane loops use: [`lanes!`](crate::lanes) compiles a function once for each set, and the machine picks.
//!
//! A set never changes a bit of a result, since plain float expressions are neither contracted nor reassociated; tests
//! run the same work under every set that the machine has, by [`InstructionSet::most`].
//!
//! Decision (2026-11-29): one macro of our own instead of the crate `multiversion`, because its targets are literals (57
//! in six spellings, of which the first that the machine has is taken, so the AVX-512 versions behind AVX2 never ran) and
//! its choice cannot be turned down for a test.

use std::sync::atomic::{AtomicU8, Ordering};

/// A set of SIMD instructions, each with all that the ones before it have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum InstructionSet {
    /// What every machine of the target has: SSE2 on x86-64.
    Baseline = 1,
    /// AVX2 with BMI1, BMI2, LZCNT and POPCNT: x86-64-v3, eight floats at a time.
    Avx2 = 2,
    /// AVX-512 F, BW, CD, DQ and VL: x86-64-v4, sixteen floats at a time.
    Avx512 = 3,
}

/// The set in use, as a number; 0 before the first question. Only ever a set that the machine has.
static CURRENT: AtomicU8 = AtomicU8::new(0);

impl InstructionSet {
    /// All sets, the widest last.
    pub const ALL: [InstructionSet; 3] = [InstructionSet::Baseline, InstructionSet::Avx2, InstructionSet::Avx512];

    /// The widest set of this machine.
    pub fn detected() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            macro_rules! has {
                ($($feature:tt)*) => { $(is_x86_feature_detected!($feature))&&* };
            }
            let v3 = has!("avx" "avx2" "bmi1" "bmi2" "lzcnt" "popcnt" "fma");
            if v3 && has!("avx512f" "avx512bw" "avx512cd" "avx512dq" "avx512vl") {
                return InstructionSet::Avx512;
            }
            if v3 {
                return InstructionSet::Avx2;
            }
        }
        InstructionSet::Baseline
    }

    /// The set that lane loops use: the widest of the machine, or less after [`InstructionSet::most`].
    #[inline(always)]
    pub fn current() -> Self {
        match CURRENT.load(Ordering::Relaxed) {
            3 => InstructionSet::Avx512,
            2 => InstructionSet::Avx2,
            1 => InstructionSet::Baseline,
            _ => Self::most(InstructionSet::Avx512),
        }
    }

    /// Uses no wider set than `limit` from now on, in the whole process, and returns the one in use. Results are the
    /// same bits under each; this is for tests of that and for measuring what a set brings.
    #[cold]
    pub fn most(limit: Self) -> Self {
        let set = limit.min(Self::detected());
        CURRENT.store(set as u8, Ordering::Relaxed);
        set
    }
}

/// Compiles a function of lane loops once for each [`InstructionSet`]; a call runs the one in use.
///
/// ```
/// velour::lanes! {
///     /// Adds columns.
///     pub fn add(a: &[f32], b: &mut [f32]) {
///         b.iter_mut().zip(a).for_each(|(b, a)| *b += a);
///     }
/// }
/// let mut b = [1.0, 2.0];
/// add(&[0.5, 0.25], &mut b);
/// assert_eq!(b, [1.5, 2.25]);
/// ```
///
/// It takes generics as `<M: Bound, …>` or as `<const N: T, …>`, and plain names as arguments. What the function calls has to be
/// `#[inline(always)]` or small, so that it is compiled for the set as well.
#[macro_export]
macro_rules! lanes {
    // With and without generics: the same expansion, with the generics in their two spellings.
    ($(#[$meta:meta])* $vis:vis fn $name:ident <$(const $constant:ident : $of:ty),+> ($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)? $body:block) => {
        $crate::lanes!(@ [$(#[$meta])*] [$vis] $name [<$(const $constant: $of),+>] [::<$($constant),+>] [$($arg: $ty),*] [$($ret)?] $body);
    };
    ($(#[$meta:meta])* $vis:vis fn $name:ident <$($model:ident : $bound:path),+> ($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)? $body:block) => {
        $crate::lanes!(@ [$(#[$meta])*] [$vis] $name [<$($model: $bound),+>] [::<$($model),+>] [$($arg: $ty),*] [$($ret)?] $body);
    };
    ($(#[$meta:meta])* $vis:vis fn $name:ident ($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)? $body:block) => {
        $crate::lanes!(@ [$(#[$meta])*] [$vis] $name [] [] [$($arg: $ty),*] [$($ret)?] $body);
    };
    (@ [$($meta:tt)*] [$vis:vis] $name:ident $generics:tt $given:tt $args:tt [] $body:block) => {
        $crate::lanes!(@ [$($meta)*] [$vis] $name $generics $given $args [()] $body);
    };
    (@ [$($meta:tt)*] [$vis:vis] $name:ident $generics:tt $given:tt $args:tt [$ret:ty] $body:block) => {
        $crate::each_instruction_set!([$($meta)*] [$vis] $name $generics $given $args [$ret] $body);
    };
}

/// The function of [`lanes!`](crate::lanes), with a version for each set.
#[cfg(not(one_instruction_set))]
#[doc(hidden)]
#[macro_export]
macro_rules! each_instruction_set {
    ([$($meta:tt)*] [$vis:vis] $name:ident [$($generics:tt)*] [$($given:tt)*] [$($arg:ident: $ty:ty),*] [$ret:ty] $body:block) => {
        $($meta)*
        #[allow(clippy::too_many_arguments, unsafe_code)]
        #[inline]
        $vis fn $name $($generics)* ($($arg: $ty),*) -> $ret {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt,fma")]
            fn avx512 $($generics)* ($($arg: $ty),*) -> $ret $body
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,fma")]
            fn avx2 $($generics)* ($($arg: $ty),*) -> $ret $body
            #[inline(always)]
            fn baseline $($generics)* ($($arg: $ty),*) -> $ret $body
            match $crate::math::instruction_set::InstructionSet::current() {
                // SAFETY: `current` is never wider than `detected`, which has asked the machine for every feature that
                // the two functions are compiled for. Measured: AVX-512 takes half the time of SSE2 or less, see `benches`.
                #[cfg(target_arch = "x86_64")]
                $crate::math::instruction_set::InstructionSet::Avx512 => unsafe { avx512 $($given)* ($($arg),*) },
                #[cfg(target_arch = "x86_64")]
                $crate::math::instruction_set::InstructionSet::Avx2 => unsafe { avx2 $($given)* ($($arg),*) },
                #[cfg(not(target_arch = "x86_64"))]
                $crate::math::instruction_set::InstructionSet::Avx512
                | $crate::math::instruction_set::InstructionSet::Avx2 => baseline $($given)* ($($arg),*),
                $crate::math::instruction_set::InstructionSet::Baseline => baseline $($given)* ($($arg),*),
            }
        }
    };
}

/// The function of [`lanes!`](crate::lanes) as it stands: without optimisation a set brings nothing and costs as much
/// compiling as the function itself.
#[cfg(one_instruction_set)]
#[doc(hidden)]
#[macro_export]
macro_rules! each_instruction_set {
    ([$($meta:tt)*] [$vis:vis] $name:ident [$($generics:tt)*] $given:tt [$($arg:ident: $ty:ty),*] [$ret:ty] $body:block) => {
        $($meta)*
        #[allow(clippy::too_many_arguments)]
        $vis fn $name $($generics)* ($($arg: $ty),*) -> $ret $body
    };
}
