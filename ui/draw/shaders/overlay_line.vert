// One line per instance, as wide as its pixels say, between two points in space.
layout(location = 0) in vec3 from; // mm
layout(location = 1) in vec3 to;
layout(location = 2) in vec2 width; // pixels, at either end
layout(location = 3) in vec4 ink;
layout(location = 4) in float is_cut; // the ends are straight: a piece of a curve
uniform mat4 projection;
uniform vec3 eye;      // mm
uniform float lift_mm; // towards the eye: what lies on the skin is not half sunk in it
uniform vec2 size;     // of the rectangle, pixels
noperspective out vec2 v_place; // pixels
flat out vec4 v_ends, v_ink;
flat out vec2 v_half_width;
flat out float v_is_cut;

vec4 project(vec3 place)
{
    return projection * vec4(place + lift_mm * normalize(eye - place), 1.0);
}

void main()
{
    const float nearest = 1e-2;
    vec4 a = project(from), b = project(to);
    if (a.w < nearest)
        a = mix(a, b, clamp((nearest - a.w) / max(b.w - a.w, 1e-6), 0.0, 1.0));
    if (b.w < nearest)
        b = mix(b, a, clamp((nearest - b.w) / max(a.w - b.w, 1e-6), 0.0, 1.0));
    v_ends = vec4(a.xy / a.w, b.xy / b.w) * 0.5 * size.xyxy;
    v_half_width = 0.5 * width;
    v_ink = ink;
    v_is_cut = is_cut;
    vec2 along = v_ends.zw - v_ends.xy;
    float distance = length(along);
    along = distance > 1e-3 ? along / distance : vec2(1.0, 0.0);
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    float reach = max(v_half_width.x, v_half_width.y) + 1.0; // the edge is soft
    vec2 from_end = reach * (along * corner.x + vec2(-along.y, along.x) * corner.y);
    vec4 end = corner.x > 0.0 ? b : a;
    v_place = (corner.x > 0.0 ? v_ends.zw : v_ends.xy) + from_end;
    gl_Position = end + vec4(from_end / size * 2.0 * end.w, 0.0, 0.0);
}
