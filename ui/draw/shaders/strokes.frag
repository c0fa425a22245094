// Within half a width of the line between its ends.
in vec2 v_place;
flat in vec4 v_ends, v_ink;
flat in float v_half_width;
out vec4 colour;

void main()
{
    vec2 along = v_ends.zw - v_ends.xy, from = v_place - v_ends.xy;
    float share = clamp(dot(from, along) / max(dot(along, along), 1e-6), 0.0, 1.0);
    float cover = clamp((v_half_width - length(from - share * along)) / shaded_px + 0.5, 0.0, 1.0);
    colour = vec4(v_ink.rgb, v_ink.a * cover);
}
