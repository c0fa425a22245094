// One stroke per instance: a quad around it, with round ends.
layout(location = 0) in vec4 ends; // pixels from the top left: from, to
layout(location = 1) in float width;
layout(location = 2) in vec4 ink;
uniform vec2 target_size;
out vec2 v_place; // pixels
flat out vec4 v_ends, v_ink;
flat out float v_half_width;

void main()
{
    vec2 along = ends.zw - ends.xy;
    float distance = length(along);
    along = distance > 1e-3 ? along / distance : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x);
    float reach = 0.5 * width + 1.0; // the edge is soft
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    v_place = mix(ends.xy - along * reach, ends.zw + along * reach, corner.x) +
              across * reach * (2.0 * corner.y - 1.0);
    v_ends = ends;
    v_ink = ink;
    v_half_width = 0.5 * width;
    gl_Position = vec4(v_place / target_size * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.0, 1.0);
}
