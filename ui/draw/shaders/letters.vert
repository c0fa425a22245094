layout(location = 0) in vec2 place;   // pixels from the top left
layout(location = 1) in vec2 texture_place; // texels
uniform vec2 target_size;
out vec2 v_texel;

void main()
{
    v_texel = texture_place;
    gl_Position = vec4(place / target_size * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.0, 1.0);
}
