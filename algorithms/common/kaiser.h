/* The Kaiser-Bessel kernel of Stolt interpolations: values of a spectrum between its bins, from `taps` bins. The
   samples are first divided by its smooth weight (kaiser_transform). */
#ifndef SASBENCH_COMMON_KAISER_H
#define SASBENCH_COMMON_KAISER_H

/* The parameter of least error when the samples fill 1/oversampling of the transform. */
double kaiser_shape(int taps, double oversampling);

/* The kernel `distance` bins from its middle: 1 there, 0 from taps/2 on. */
double kaiser_value(int taps, double shape, double distance);

/* The kernel's weight of a sample that lies `place` (a fraction of the transform) from its middle. */
double kaiser_transform(int taps, double shape, double place);

/* Relative error of an interpolation whose samples fill 1/oversampling of the transform and are divided by their
   weights: exp(-pi taps sqrt(1 - 1/oversampling)), as of any such kernel, but for a factor of about 1. */
double kaiser_error(int taps, double oversampling);

#endif
