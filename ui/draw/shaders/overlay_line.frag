// Within half a width of the line between its ends; the width goes over from one to the other.
noperspective in vec2 v_place;
flat in vec4 v_ends, v_ink;
flat in vec2 v_half_width;
flat in float v_is_cut;
uniform float strength;
out vec4 colour;

void main()
{
    vec2 along = v_ends.zw - v_ends.xy, from = v_place - v_ends.xy;
    float place = dot(from, along) / max(dot(along, along), 1e-6), share = clamp(place, 0.0, 1.0);
    if (v_is_cut > 0.5 && place != share)
        discard;
    float half_width = mix(v_half_width.x, v_half_width.y, share);
    float cover = clamp((half_width - length(from - share * along)) / shaded_px + 0.5, 0.0, 1.0);
    colour = vec4(v_ink.rgb, v_ink.a * cover * strength);
}
