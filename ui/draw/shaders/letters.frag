// Glyphs are placed on whole pixels: each pixel takes exactly one texel.
in vec2 v_texel;
uniform sampler2D atlas;
uniform vec4 ink;
out vec4 colour;

void main()
{
    colour = vec4(ink.rgb, ink.a * texelFetch(atlas, ivec2(floor(v_texel)), 0).r);
}
