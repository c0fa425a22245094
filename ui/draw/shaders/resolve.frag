// The samples of a pixel into one, averaged as light: squares are near enough to the sRGB curve for
// the edges, and cheap. A pixel of equal samples keeps its bytes. Where alpha is kept, the colour is
// that of the samples that are there.
#ifdef PIXELS // in the place of samples: two by two
uniform sampler2D samples;
const int sample_count = 4;
vec4 sample_of(ivec2 pixel, int i)
{
    return texelFetch(samples, pixel * 2 + ivec2(i & 1, i >> 1), 0);
}
#else
uniform sampler2DMS samples;
uniform int sample_count;
vec4 sample_of(ivec2 pixel, int i)
{
    return texelFetch(samples, pixel, i);
}
#endif
uniform bool keeps_alpha;
out vec4 colour;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 sum = vec3(0.0);
    float there = 0.0;
    for (int i = 0; i < sample_count; ++i) {
        vec4 one = sample_of(pixel, i);
        float share = keeps_alpha ? one.a : 1.0;
        sum += share * one.rgb * one.rgb;
        there += share;
    }
    colour = vec4(sqrt(sum / max(there, 1e-6)), there / float(sample_count));
}
