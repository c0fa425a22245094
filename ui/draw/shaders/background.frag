// A wall, a little light on it behind the head, or a picture before it. Mixed as on the screen
// (sRGB): it is scenery.
in vec2 v_place;
uniform ivec2 origin; // of the rectangle, pixels of the framebuffer
uniform int side;     // of a pixel of the picture, in those
uniform vec3 wall_edge, wall_light;
#ifdef PICTURE
uniform sampler2D picture;  // first row at the top
uniform vec2 picture_scale; // how many of it the rectangle spans
#endif
out vec4 colour;

void main()
{
    vec2 from_light = (v_place - vec2(0.5, 0.56)) * vec2(1.0, 0.9);
    float light = 1.0 / (1.0 + 3.6 * dot(from_light, from_light));
    vec3 wall = mix(wall_edge, wall_light, light * light);
#ifdef PICTURE
    vec2 at = vec2(0.5) + (v_place - vec2(0.5)) * picture_scale * vec2(1.0, -1.0);
    vec4 seen = texture(picture, at);
    float is_there = all(lessThanEqual(abs(at - vec2(0.5)), vec2(0.5))) ? seen.a : 0.0;
    wall = mix(wall, seen.rgb, is_there);
#endif
    colour = vec4(wall + dither((ivec2(gl_FragCoord.xy) - origin) >> (side - 1)), 1.0);
}
