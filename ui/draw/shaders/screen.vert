// One triangle over the whole viewport, behind everything.
out vec2 v_place; // 0..1, from the bottom left

void main()
{
    v_place = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(v_place * 2.0 - 1.0, 1.0, 1.0);
}
