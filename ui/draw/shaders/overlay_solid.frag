// A dull solid under the studio's key light; or a soap bubble of which one sees the edge.
in vec3 v_position, v_normal;
flat in vec4 v_ink;
flat in float v_is_skin;
uniform vec3 eye; // mm
uniform vec3 to_light;
uniform float strength;
out vec4 colour;

void main()
{
    vec3 normal = normalize(v_normal), to_eye = normalize(eye - v_position);
    float facing = abs(dot(normal, to_eye)), away = 1.0 - facing;
    if (v_is_skin > 0.5) {
        colour = vec4(v_ink.rgb, v_ink.a * strength * (0.06 + 0.5 * away * away * away));
        return;
    }
    float lit = 0.5 + 0.5 * dot(normal, to_light);
    colour = vec4(v_ink.rgb * mix(0.30, 1.08, lit * lit) + 0.10 * away * away, v_ink.a * strength);
}
