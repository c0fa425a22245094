// The samples of a pixel into one, averaged as light: squares are near enough to the sRGB curve for
// the edges, and cheap. A pixel of equal samples keeps its bytes. Where alpha is kept, the colour is
// that of the samples that are there.
uniform sampler2DMS samples;
uniform int sample_count;
uniform bool keeps_alpha;
out vec4 colour;

vec4 straight(ivec2 pixel)
{
    vec3 sum = vec3(0.0);
    float there = 0.0;
    for (int i = 0; i < sample_count; ++i) {
        vec4 one = texelFetch(samples, pixel, i);
        sum += one.rgb * one.rgb * one.a;
        there += one.a;
    }
    return there > 0.0 ? vec4(sqrt(sum / there), there / float(sample_count)) : vec4(0.0);
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (keeps_alpha) {
        colour = straight(pixel);
        return;
    }
    vec3 first = texelFetch(samples, pixel, 0).rgb;
    vec3 sum = first * first, spread = vec3(0.0);
    for (int i = 1; i < sample_count; ++i) {
        vec3 other = texelFetch(samples, pixel, i).rgb;
        sum += other * other;
        spread += abs(other - first);
    }
    bool is_even = spread.r + spread.g + spread.b == 0.0;
    colour = vec4(is_even ? first : sqrt(sum / float(sample_count)), 1.0);
}
