
/* The results are those of the core, bit by bit, with IEEE 754 arithmetic in which each operation rounds once. */
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0) || \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "this program needs IEEE 754 arithmetic: compile it without -ffast-math"
#endif
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16
#error "this program needs arithmetic without excess precision: compile it with -msse2 -mfpmath=sse"
#endif
#if DBL_MANT_DIG != 53 || DBL_MAX_EXP != 1024
#error "this program needs a double of 64 bits"
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#if !defined(__x86_64__) || defined(__FMA__) || defined(__FMA4__)
/* The vectoriser of GCC 12 and later contracts alternating sums of products in spite of this option. */
#pragma GCC optimize("no-tree-slp-vectorize")
#endif
#elif defined(_MSC_VER)
#pragma fp_contract(off)
#elif defined(__STDC_VERSION__)
#pragma STDC FP_CONTRACT OFF
#endif

typedef struct rpi_context {
  int32_t fault;
  int32_t place;
} rpi_context;

