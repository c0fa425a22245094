#include "curve.h"

double curve_clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

static double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

static double with_sign(double magnitude, double sign)
{
    return sign < 0.0 ? -magnitude : magnitude;
}

double curve_dead_zone(double x, double dead)
{
    double beyond = magnitude(x) - dead;
    if (!(beyond > 0.0))
        return 0.0;
    double out = beyond < dead ? 0.5 * beyond * beyond / dead : beyond - 0.5 * dead;
    return with_sign(out, x);
}

static double limited(double x, double limit)
{
    if (!(x > 0.0) || !(limit > 0.0))
        return 0.0;
    double bend = x - 0.5 * limit;
    if (bend <= 0.0)
        return x;
    return bend >= limit ? limit : x - 0.5 * bend * bend / limit;
}

double curve_limit(double x, double up, double down)
{
    return x < 0.0 ? -limited(-x, down) : limited(x, up);
}

/* Cubic Hermite from (0, from) to (width, to). */
static double hermite(double x, double width, double from, double slope_from, double to,
                      double slope_to)
{
    double t = x / width, t2 = t * t, t3 = t2 * t;
    return from * (2.0 * t3 - 3.0 * t2 + 1.0) + to * (3.0 * t2 - 2.0 * t3) +
           width * (slope_from * (t3 - 2.0 * t2 + t) + slope_to * (t3 - t2));
}

double curve_knee(double x, double knee_x, double knee_y)
{
    double u = magnitude(x);
    if (u >= 1.0)
        return with_sign(1.0, x);
    double before = knee_y / knee_x, behind = (1.0 - knee_y) / (1.0 - knee_x);
    double slope = 2.0 * before * behind / (before + behind); /* Fritsch and Carlson: monotone */
    double out = u < knee_x ? hermite(u, knee_x, 0.0, before, knee_y, slope)
                            : hermite(u - knee_x, 1.0 - knee_x, knee_y, slope, 1.0, 0.0);
    return with_sign(out, x);
}

double curve_ease(double t)
{
    if (!(t > 0.0))
        return 0.0;
    return t >= 1.0 ? 1.0 : t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
}
