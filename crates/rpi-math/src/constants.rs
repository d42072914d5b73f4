//! Constants and coefficients of polynomials. Written by tools/generate.py: do not edit.

/// Part of pi / 32 = STEP_HIGH + STEP_MIDDLE + STEP_LOW; the first two have 32 bits.
pub(crate) const STEP_HIGH: f64 = 0.09817477042088285;
/// Part of pi / 32 = STEP_HIGH + STEP_MIDDLE + STEP_LOW; the first two have 32 bits.
pub(crate) const STEP_MIDDLE: f64 = 3.798187816439979e-12;
/// Part of pi / 32 = STEP_HIGH + STEP_MIDDLE + STEP_LOW; the first two have 32 bits.
pub(crate) const STEP_LOW: f64 = 1.2639164054974691e-22;
/// 32 / pi.
pub(crate) const STEPS_PER_UNIT: f64 = 10.185916357881302;
/// Part of 2 pi = TURN_HIGH + TURN_LOW.
pub(crate) const TURN_HIGH: f64 = 6.283185307179586;
/// Part of 2 pi = TURN_HIGH + TURN_LOW.
pub(crate) const TURN_LOW: f64 = 2.4492935982947064e-16;
/// Part of pi / 2 = QUARTER_HIGH + QUARTER_LOW.
pub(crate) const QUARTER_HIGH: f64 = 1.5707963267948966;
/// Part of pi / 2 = QUARTER_HIGH + QUARTER_LOW.
pub(crate) const QUARTER_LOW: f64 = 6.123233995736766e-17;
/// 128 / log 2.
pub(crate) const POWER_STEPS_PER_UNIT: f64 = 184.6649652337873;
/// Part of log 2 / 128 = POWER_STEP_HIGH + POWER_STEP_LOW; 35 bits.
pub(crate) const POWER_STEP_HIGH: f64 = 0.0054152123482253955;
/// Part of log 2 / 128 = POWER_STEP_HIGH + POWER_STEP_LOW.
pub(crate) const POWER_STEP_LOW: f64 = -1.0082281460997769e-13;
/// Part of log 2 = LN_TWO_HIGH + LN_TWO_LOW; a multiple of 2^-42.
pub(crate) const LN_TWO_HIGH: f64 = 0.6931471805598903;
/// Part of log 2 = LN_TWO_HIGH + LN_TWO_LOW.
pub(crate) const LN_TWO_LOW: f64 = 5.497923018708371e-14;
/// Coefficients of (sin r - r) / r^3 of r^2, for |r| up to pi / 64. Error of the approximation: 8.5e-19.
pub(crate) const SIN_TERMS: [[f64; 3]; 1] = [
    [-0.16666666666665958, 0.00833333331548281, -0.00019839993119491326],
];
/// Coefficients of (cos r - 1 + r^2 / 2) / r^4 of r^2, for |r| up to pi / 64. Error of the approximation: 8.8e-23.
pub(crate) const COS_TERMS: [[f64; 3]; 1] = [
    [0.04166666666666547, -0.0013888888865416225, 2.4800157603364993e-05],
];
/// Coefficients of (exp r - 1 - r - r^2 / 2) / r^3 of r, for |r| up to log 2 / 256. Error of the approximation: 1.3e-15.
pub(crate) const EXP_TERMS: [[f64; 4]; 1] = [
    [0.16666666666666533, 0.041666666666666, 0.008333334790833638, 0.0013888891621701943],
];
/// Coefficients of (exp x - 1 - x - x^2 / 2) / x^3 of x, for |x| up to 1 / 8. Error of the approximation: 1.2e-17.
pub(crate) const EXPM1_TERMS: [[f64; 4]; 2] = [
    [0.16666666666666666, 0.04166666666666666, 0.00833333333335723, 0.0013888888888943652],
    [0.00019841269076590828, 2.48015862183012e-05, 2.7565149135153285e-06, 2.7565475362483915e-07],
];
/// Coefficients of (log (1 + r) - r + r^2 / 2) / r^3 of r, for |r| up to 0.0042. Error of the approximation: 1.9e-17.
pub(crate) const LOG_TERMS: [[f64; 3]; 2] = [
    [0.33333333333333337, -0.2500000000000001, 0.19999999998055143],
    [-0.16666666662971427, 0.14286008290841598, -0.12500352807293172],
];
/// Coefficients of (asin x - x) / x^3 of x^2, for |x| up to 1 / 2. Error of the approximation: 3.7e-21.
pub(crate) const ASIN_TERMS: [[f64; 4]; 4] = [
    [0.16666666666666666, 0.07500000000000001, 0.04464285714285466, 0.030381944444773233],
    [0.022372159068098276, 0.017352765378636996, 0.01396481752912966, 0.011552296628886126],
    [0.009754945520961133, 0.008455187161693594, 0.006852555869095573, 0.008814323053779863],
    [-0.0029379030904765993, 0.026933270094412178, -0.029812225491092758, 0.032353674603471126],
];
/// Coefficients of (tanh x - x) / x^3 of x^2, for |x| up to 1 / 4. Error of the approximation: 1.5e-18.
pub(crate) const TANH_TERMS: [[f64; 4]; 2] = [
    [-0.3333333333333333, 0.13333333333333022, -0.05396825396720279, 0.021869488401092946],
    [-0.008863226999616476, 0.003591834919505126, -0.0014502326071092536, 0.0005337220464403301],
];
/// Coefficients of m^(-1/3) of m - 1, for m from 1 to 2. Error of the approximation: 0.00025.
pub(crate) const CBRT_TERMS: [[f64; 4]; 1] = [
    [0.9997469296117447, -0.3242567999635603, 0.16794625453176357, -0.049936720296117454],
];
