// One capsule per instance: around each end a half of a ball, of a radius of its own.
layout(location = 0) in vec4 shape; // direction from the middle of its end; which end
layout(location = 1) in vec3 from;  // mm
layout(location = 2) in vec3 to;
layout(location = 3) in vec2 radius; // mm, at either end
layout(location = 4) in vec4 ink;
layout(location = 5) in float is_skin;
uniform mat4 projection;
out vec3 v_position, v_normal;
flat out vec4 v_ink;
flat out float v_is_skin;

void main()
{
    vec3 along = to - from;
    float distance = length(along);
    along = distance > 1e-6 ? along / distance : vec3(0.0, 0.0, 1.0);
    vec3 side = normalize(cross(abs(along.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), along));
    v_normal = shape.x * side + shape.y * cross(along, side) + shape.z * along;
    v_position = mix(from, to, shape.w) + v_normal * mix(radius.x, radius.y, shape.w);
    v_ink = ink;
    v_is_skin = is_skin;
    gl_Position = projection * vec4(v_position, 1.0);
}
