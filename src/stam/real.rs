//! The two number types of the evaluator, and vectors of them as wide as the processor has.

use pulp::{Arch, Scalar128b, Simd, WithSimd};
use std::fmt::Debug;

/// Number type of an [`Evaluator`](super::Evaluator): `f32` or `f64`.
pub trait Real: sealed::Lanes {
    /// The nearest number.
    fn of(x: f64) -> Self;

    /// The same number.
    fn to_f64(self) -> f64;
}

pub(super) use sealed::Lanes;

mod sealed {
    use super::*;

    /// Vectors of a number type: lanes of one instruction.
    pub trait Lanes: Copy + PartialOrd + Default + Debug + bytemuck::Pod + Send + Sync + 'static {
        type Vector<S: Simd>: Copy;
        /// Numbers in a vector.
        fn count<S: Simd>() -> usize;
        fn splat<S: Simd>(simd: S, x: Self) -> Self::Vector<S>;
        fn add<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
        fn sub<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
        fn mul<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
        fn div<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
        fn sqrt<S: Simd>(simd: S, a: Self::Vector<S>) -> Self::Vector<S>;
        /// a b + c, rounded once where the processor does so.
        fn mul_add<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>, c: Self::Vector<S>) -> Self::Vector<S>;
        /// Zeros beyond the end of the slice.
        fn load<S: Simd>(simd: S, from: &[Self]) -> Self::Vector<S>;
        /// As many as the slice takes.
        fn store<S: Simd>(simd: S, to: &mut [Self], x: Self::Vector<S>);
        /// a b + c of single numbers, rounded once where vectors do so.
        fn fused<S: Simd>(a: Self, b: Self, c: Self) -> Self;
    }
}

macro_rules! real {
    ($type:ty, $vector:ident, $lanes:ident, $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $sqrt:ident,
     $mul_add:ident, $load:ident, $store:ident, $whole:ident, $whole_mut:ident) => {
        impl Real for $type {
            #[inline(always)]
            fn of(x: f64) -> Self {
                x as $type
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        }

        impl Lanes for $type {
            type Vector<S: Simd> = S::$vector;

            #[inline(always)]
            fn count<S: Simd>() -> usize {
                S::$lanes
            }
            #[inline(always)]
            fn splat<S: Simd>(simd: S, x: Self) -> S::$vector {
                simd.$splat(x)
            }
            #[inline(always)]
            fn add<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$add(a, b)
            }
            #[inline(always)]
            fn sub<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$sub(a, b)
            }
            #[inline(always)]
            fn mul<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$mul(a, b)
            }
            #[inline(always)]
            fn div<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$div(a, b)
            }
            #[inline(always)]
            fn sqrt<S: Simd>(simd: S, a: S::$vector) -> S::$vector {
                simd.$sqrt(a)
            }
            #[inline(always)]
            fn mul_add<S: Simd>(simd: S, a: S::$vector, b: S::$vector, c: S::$vector) -> S::$vector {
                simd.$mul_add(a, b, c)
            }
            #[inline(always)]
            fn load<S: Simd>(simd: S, from: &[Self]) -> S::$vector {
                // Whole vectors need no mask.
                match S::$whole(from) {
                    ([vector, ..], _) => *vector,
                    _ => simd.$load(from),
                }
            }
            #[inline(always)]
            fn store<S: Simd>(simd: S, to: &mut [Self], x: S::$vector) {
                if to.len() < S::$lanes {
                    return simd.$store(to, x);
                }
                if let ([vector, ..], _) = S::$whole_mut(to) {
                    *vector = x;
                }
            }
            #[inline(always)]
            fn fused<S: Simd>(a: Self, b: Self, c: Self) -> Self {
                // Vectors of more than 128 bits come with instructions for it; elsewhere it would be a call.
                if S::F32_LANES > 4 { a.mul_add(b, c) } else { a * b + c }
            }
        }
    };
}

real!(
    f32,
    f32s,
    F32_LANES,
    splat_f32s,
    add_f32s,
    sub_f32s,
    mul_f32s,
    div_f32s,
    sqrt_f32s,
    mul_add_e_f32s,
    partial_load_f32s,
    partial_store_f32s,
    as_simd_f32s,
    as_mut_simd_f32s
);
real!(
    f64,
    f64s,
    F64_LANES,
    splat_f64s,
    add_f64s,
    sub_f64s,
    mul_f64s,
    div_f64s,
    sqrt_f64s,
    mul_add_e_f64s,
    partial_load_f64s,
    partial_store_f64s,
    as_simd_f64s,
    as_mut_simd_f64s
);

/// Does it with the widest vectors that this processor has: AVX-512, AVX2 with FMA, or those of 128 bits that every one has.
pub(super) fn vectorized<O: WithSimd>(work: O) -> O::Output {
    match Arch::new() {
        Arch::Scalar => Scalar128b.vectorize(work),
        arch => arch.dispatch(work),
    }
}
