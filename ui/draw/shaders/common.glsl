// Before every shader: colour coding and the dither that keeps dark gradients free of bands.

// A side of what is shaded at once, pixels of the picture: target.h.
#ifdef LLVMPIPE
const float shaded_px = 0.5;
#else
const float shaded_px = 1.0;
#endif

vec3 encode_srgb(vec3 linear)
{
    vec3 c = clamp(linear, 0.0, 1.0);
    return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThan(c, vec3(0.0031308))));
}

uint scramble(uint h)
{
    h ^= h >> 16;
    h *= 0x7feb352du;
    h ^= h >> 15;
    h *= 0x846ca68bu;
    return h ^ (h >> 16);
}

// Half a step of 8-bit colour to either side, fixed per pixel of the rectangle drawn.
vec3 dither(ivec2 pixel)
{
    uint h = scramble(uint(pixel.x) * 0x9e3779b9u + scramble(uint(pixel.y)));
    return (vec3(float(h & 1023u), float((h >> 10) & 1023u), float((h >> 20) & 1023u)) / 1023.0 - 0.5) / 255.0;
}
