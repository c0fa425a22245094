// A wall, a little light on it behind the head. Mixed as on the screen (sRGB): it is scenery.
in vec2 v_place;
uniform ivec2 origin; // of the rectangle, pixels of the framebuffer
uniform int side;     // of a pixel of the picture, in those
uniform vec3 wall_edge, wall_light;
out vec4 colour;

void main()
{
    vec2 from_light = (v_place - vec2(0.5, 0.56)) * vec2(1.0, 0.9);
    float light = 1.0 / (1.0 + 3.6 * dot(from_light, from_light));
    vec3 wall = mix(wall_edge, wall_light, light * light);
    colour = vec4(wall + dither((ivec2(gl_FragCoord.xy) - origin) >> (side - 1)), 1.0);
}
