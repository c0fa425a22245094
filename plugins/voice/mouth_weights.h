/* voice/mouth_weights.h - weights of the features of a hop for each channel of a mouth. Written by
 * tests/bench/voice_truth --fit: least squares over six sentences of seven voices of espeak-ng.
 * Only for mouth.c. */
#ifndef PLUGINS_VOICE_MOUTH_WEIGHTS_H
#define PLUGINS_VOICE_MOUTH_WEIGHTS_H
#include "mouth.h"

static const double mouth_weight[MOUTH_CHANNELS][MOUTH_FEATURES] = {
    {-0.1998, -0.0019, -0.0573, 0.1486, 0.0295, 0.0251, 0.0256, 0.0247, 0.1248, -0.0677, -0.1876,
     0.3450, 0.0383, 0.1874, -0.2050},
    {0.0542, 0.0662, -0.1614, -0.0171, -0.0745, -0.0837, -0.0127, 0.1044, 0.2605, 0.0689, -0.1650,
     0.1661, -0.0458, 0.1133, -0.0579},
    {-0.2914, 0.2564, 0.2356, 0.0048, 0.0479, -0.0270, -0.0993, -0.0839, -0.0432, -0.0782, 0.1593,
     0.3515, 0.0643, 0.0263, -0.1547},
    {0.5141, -0.3322, 0.0381, -0.2071, 0.2021, 0.0616, -0.0108, 0.1248, -0.0939, 0.0561, -0.1540,
     -0.5322, -0.1357, -0.1910, 0.8193},
    {-0.1269, -0.0786, -0.0942, -0.0283, -0.0288, -0.0253, -0.0006, -0.0761, -0.0900, 0.0387,
     0.2730, 0.2993, 0.0686, 0.0941, -0.1399},
};

#endif
