// A dark studio wall, a little light behind the head.
in vec2 v_place;
uniform ivec2 origin; // of the rectangle, pixels of the framebuffer
out vec4 colour;

void main()
{
    vec2 from_light = (v_place - vec2(0.5, 0.56)) * vec2(1.0, 0.9);
    float light = exp(-3.2 * dot(from_light, from_light));
    vec3 wall = mix(vec3(0.0075, 0.0080, 0.0095), vec3(0.033, 0.036, 0.042), light);
    colour = vec4(encode_srgb(wall) + dither(ivec2(gl_FragCoord.xy) - origin), 1.0);
}
