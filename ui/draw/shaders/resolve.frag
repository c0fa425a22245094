// The samples of a pixel into one, averaged as light.
uniform sampler2DMS samples;
uniform int sample_count;
out vec4 colour;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 first = texelFetch(samples, pixel, 0);
    vec3 sum = decode_srgb(first.rgb);
    bool flat_pixel = true;
    for (int i = 1; i < sample_count; ++i) {
        vec4 other = texelFetch(samples, pixel, i);
        flat_pixel = flat_pixel && other == first;
        sum += decode_srgb(other.rgb);
    }
    colour = vec4(flat_pixel ? first.rgb : encode_srgb(sum / float(sample_count)), 1.0);
}
