// The samples of a pixel into one, averaged as light: squares are near enough to the sRGB curve for
// the edges, and cheap. A pixel of equal samples keeps its bytes.
uniform sampler2DMS samples;
uniform int sample_count;
out vec4 colour;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
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
