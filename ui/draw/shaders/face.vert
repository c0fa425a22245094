layout(location = 0) in vec3 position; // mm
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 rest; // mm: where the grain of the stone is fixed
layout(location = 3) in float openness;
#ifdef OWN_COLOURS
layout(location = 4) in vec3 own_colour; // linear
out vec3 v_colour;
#endif
#ifdef PAINTED
layout(location = 5) in vec4 tint; // linear
layout(location = 6) in vec2 uv;
uniform bool has_tint;
out vec4 v_tint;
out vec2 v_uv;
#endif
#ifdef FUZZ
uniform float nap_mm; // length of the fibres
uniform float nap_layers;
out float v_layer; // 0..1, up the fibres
#endif
uniform mat4 projection;
out vec3 v_position, v_normal, v_rest;
out float v_openness;

void main()
{
    vec3 place = position;
#ifdef FUZZ
    v_layer = (float(gl_InstanceID) + 1.0) / (nap_layers + 1.0);
    place += normal * nap_mm * v_layer;
#endif
    v_position = place;
    v_normal = normal;
    v_rest = rest;
    v_openness = openness;
#ifdef OWN_COLOURS
    v_colour = own_colour;
#endif
#ifdef PAINTED
    v_tint = has_tint ? tint : vec4(1.0);
    v_uv = uv;
#endif
    gl_Position = projection * vec4(place, 1.0);
}
