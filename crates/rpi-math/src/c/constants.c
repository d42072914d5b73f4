/*# rpi_step_high */
/* Part of pi / 32 = STEP_HIGH + STEP_MIDDLE + STEP_LOW; the first two have 32 bits. */
static const double rpi_step_high = 0.09817477042088285;
/*# rpi_step_middle */
/* Part of pi / 32 = STEP_HIGH + STEP_MIDDLE + STEP_LOW; the first two have 32 bits. */
static const double rpi_step_middle = 3.798187816439979e-12;
/*# rpi_step_low */
/* Part of pi / 32 = STEP_HIGH + STEP_MIDDLE + STEP_LOW; the first two have 32 bits. */
static const double rpi_step_low = 1.2639164054974691e-22;
/*# rpi_steps_per_unit */
/* 32 / pi. */
static const double rpi_steps_per_unit = 10.185916357881302;
/*# rpi_turn_high */
/* Part of 2 pi = TURN_HIGH + TURN_LOW. */
static const double rpi_turn_high = 6.283185307179586;
/*# rpi_turn_low */
/* Part of 2 pi = TURN_HIGH + TURN_LOW. */
static const double rpi_turn_low = 2.4492935982947064e-16;
/*# rpi_quarter_high */
/* Part of pi / 2 = QUARTER_HIGH + QUARTER_LOW. */
static const double rpi_quarter_high = 1.5707963267948966;
/*# rpi_quarter_low */
/* Part of pi / 2 = QUARTER_HIGH + QUARTER_LOW. */
static const double rpi_quarter_low = 6.123233995736766e-17;
/*# rpi_power_steps_per_unit */
/* 128 / log 2. */
static const double rpi_power_steps_per_unit = 184.6649652337873;
/*# rpi_power_step_high */
/* Part of log 2 / 128 = POWER_STEP_HIGH + POWER_STEP_LOW; 35 bits. */
static const double rpi_power_step_high = 0.0054152123482253955;
/*# rpi_power_step_low */
/* Part of log 2 / 128 = POWER_STEP_HIGH + POWER_STEP_LOW. */
static const double rpi_power_step_low = -1.0082281460997769e-13;
/*# rpi_ln_two_high */
/* Part of log 2 = LN_TWO_HIGH + LN_TWO_LOW; a multiple of 2^-42. */
static const double rpi_ln_two_high = 0.6931471805598903;
/*# rpi_ln_two_low */
/* Part of log 2 = LN_TWO_HIGH + LN_TWO_LOW. */
static const double rpi_ln_two_low = 5.497923018708371e-14;
/*# rpi_sin_terms */
/* Coefficients of (sin r - r) / r^3 of r^2, for |r| up to pi / 64. Error of the approximation: 8.5e-19. */
static const double rpi_sin_terms[1][3] = {
  {-0.16666666666665958, 0.00833333331548281, -0.00019839993119491326},
};
/*# rpi_cos_terms */
/* Coefficients of (cos r - 1 + r^2 / 2) / r^4 of r^2, for |r| up to pi / 64. Error of the approximation: 8.8e-23. */
static const double rpi_cos_terms[1][3] = {
  {0.04166666666666547, -0.0013888888865416225, 2.4800157603364993e-05},
};
/*# rpi_exp_terms */
/* Coefficients of (exp r - 1 - r - r^2 / 2) / r^3 of r, for |r| up to log 2 / 256. Error of the approximation: 1.3e-15. */
static const double rpi_exp_terms[1][4] = {
  {0.16666666666666533, 0.041666666666666, 0.008333334790833638, 0.0013888891621701943},
};
/*# rpi_expm1_terms */
/* Coefficients of (exp x - 1 - x - x^2 / 2) / x^3 of x, for |x| up to 1 / 8. Error of the approximation: 1.2e-17. */
static const double rpi_expm1_terms[2][4] = {
  {0.16666666666666666, 0.04166666666666666, 0.00833333333335723, 0.0013888888888943652},
  {0.00019841269076590828, 2.48015862183012e-05, 2.7565149135153285e-06, 2.7565475362483915e-07},
};
/*# rpi_log_terms */
/* Coefficients of (log (1 + r) - r + r^2 / 2) / r^3 of r, for |r| up to 0.0042. Error of the approximation: 1.9e-17. */
static const double rpi_log_terms[2][3] = {
  {0.33333333333333337, -0.2500000000000001, 0.19999999998055143},
  {-0.16666666662971427, 0.14286008290841598, -0.12500352807293172},
};
/*# rpi_asin_terms */
/* Coefficients of (asin x - x) / x^3 of x^2, for |x| up to 1 / 2. Error of the approximation: 3.7e-21. */
static const double rpi_asin_terms[4][4] = {
  {0.16666666666666666, 0.07500000000000001, 0.04464285714285466, 0.030381944444773233},
  {0.022372159068098276, 0.017352765378636996, 0.01396481752912966, 0.011552296628886126},
  {0.009754945520961133, 0.008455187161693594, 0.006852555869095573, 0.008814323053779863},
  {-0.0029379030904765993, 0.026933270094412178, -0.029812225491092758, 0.032353674603471126},
};
/*# rpi_tanh_terms */
/* Coefficients of (tanh x - x) / x^3 of x^2, for |x| up to 1 / 4. Error of the approximation: 1.5e-18. */
static const double rpi_tanh_terms[2][4] = {
  {-0.3333333333333333, 0.13333333333333022, -0.05396825396720279, 0.021869488401092946},
  {-0.008863226999616476, 0.003591834919505126, -0.0014502326071092536, 0.0005337220464403301},
};
/*# rpi_cbrt_terms */
/* Coefficients of m^(-1/3) of m - 1, for m from 1 to 2. Error of the approximation: 0.00025. */
static const double rpi_cbrt_terms[1][4] = {
  {0.9997469296117447, -0.3242567999635603, 0.16794625453176357, -0.049936720296117454},
};
