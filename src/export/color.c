/* SPDX-License-Identifier: Apache-2.0 */
/* A sequence of colours that stay easy to distinguish, however long.
 *
 * The hue advances by the golden angle, which keeps any first n hues apart (no two closer than
 * about 1 / (sqrt(5) n) turns); lightness cycles through three values and chroma through two, so
 * that neighbours in hue differ in those as well. Colours are chosen in Oklab's polar form, where
 * equal steps look equal, and desaturated until they fit sRGB. */
#include <math.h>

#include "starguard/picture.h"

static const double GOLDEN_ANGLE = 2.39996322972865332;
static const double FIRST_HUE = 0.45; /* a warm red */

static const double LIGHTNESS[3] = {0.63, 0.74, 0.52};
static const double CHROMA[2] = {0.185, 0.145};

static double srgb_gamma(double linear) {
    if (linear <= 0.0031308)
        return 12.92 * linear;
    return 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

/* Oklab to linear sRGB; true when all three lie in [0, 1]. */
static bool to_linear(double lightness, double a, double b, double linear[3]) {
    double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
    double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
    double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
    l = l * l * l;
    m = m * m * m;
    s = s * s * s;
    linear[0] = 4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s;
    linear[1] = -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s;
    linear[2] = -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s;
    for (int k = 0; k < 3; k++)
        if (!(linear[k] >= 0 && linear[k] <= 1))
            return false;
    return true;
}

void starg_distinct_color(size_t index, uint8_t rgb[3]) {
    double turns = fmod((double)index * (GOLDEN_ANGLE / 6.28318530717958648), 1);
    double hue = FIRST_HUE + 6.28318530717958648 * turns;
    double lightness = LIGHTNESS[index % 3], chroma = CHROMA[index / 3 % 2];
    double linear[3];
    while (!to_linear(lightness, chroma * cos(hue), chroma * sin(hue), linear))
        chroma *= 0.96;
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)(255 * srgb_gamma(linear[k]) + 0.5);
}
