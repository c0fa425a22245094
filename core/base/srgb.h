/* base/srgb.h - the transfer function of sRGB (IEC 61966-2-1). Pure. */
#ifndef MAROTTE_BASE_SRGB_H
#define MAROTTE_BASE_SRGB_H

/* One component of a colour, 0 to 1; values are not clamped. */
double srgb_to_linear(double coded);
double srgb_from_linear(double linear);

#endif
